// What a live source is read from: standard input, a named pipe, or a file of frames. Waiting for bytes ends when a
// stop is requested. Owned and used by one thread. Pipeline: outside → **bytes** → frames.
#pragma once

#include <filesystem>
#include <memory>
#include <stop_token>

#include "renderer/cloud/import/byte_source.hpp"

namespace scancast {

class LiveBytes final : public ByteSource {
  public:
    /// "-" = standard input. A named pipe need not have a writer yet: the first read() waits for one. Errors: NotFound,
    /// Io; InvalidArgument where standard input is a terminal; Unsupported for what is neither pipe nor file.
    static Expected<std::unique_ptr<LiveBytes>> open(const std::filesystem::path& path, std::stop_token stop);

    /// Errors: Io; Cancelled after a stop was requested.
    Expected<std::size_t> read(std::span<std::byte> into) override;
    /// Another writer may come after this one: opened before this is closed, what it writes is not lost.
    bool reopens() const { return reopens_; }

  private:
    LiveBytes(UniqueFd fd, bool reopens, std::stop_token stop)
        : fd_(std::move(fd)), reopens_(reopens), stop_(std::move(stop)) {}

    const UniqueFd fd_;
    const bool reopens_;
    const std::stop_token stop_;
};

}  // namespace scancast
