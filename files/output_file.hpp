// Where a scan or a picture is written: a file that appears under its name only when it is complete, or
// standard output, or whoever takes it. Owner: a point writer, a command; one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "files/unfinished_file.hpp"
#include "files/unique_fd.hpp"
#include "protocol/error.hpp"

namespace scancast {

class OutputFile {
  public:
    /// "-" is standard output. A regular file is written beside its final name and renamed by finish(); what
    /// is not finished is removed again. Devices and pipes are written in place. Errors: Io, with the
    /// system's reason; ResourceLimit where there is no more room.
    static Expected<OutputFile> create(const std::string& path, Readers readers = Readers::AsUsual);
    /// No file: everything is handed to `take`, in its order, about a megabyte at a time, and ends with the last of it. Not
    /// seekable. `take` may refuse.
    using Take = std::function<Expected<void>(std::span<const std::byte>)>;
    static OutputFile to(Take take);
    OutputFile(OutputFile&&) = default;
    OutputFile& operator=(OutputFile&&) = delete;

    Expected<void> write(std::span<const std::byte> bytes);
    /// Replaces bytes written before. Only where seekable() is true.
    Expected<void> overwrite(std::uint64_t offset, std::span<const std::byte> bytes);
    Expected<void> finish();
    /// Whoever reads what is written in place has all of it when this returns.
    Expected<void> flush();

    bool seekable() const { return seekable_; }
    std::uint64_t bytesWritten() const { return written_; }

  private:
    OutputFile() = default;
    Expected<void> writeAll(std::span<const std::byte> bytes);
    tl::unexpected<Error> failure(const char* what) const;

    std::string path_;
    UnfinishedName temporary_;  ///< none for what is written in place
    UniqueFd owned_;            ///< none for standard output
    int file_ = -1;
    Take take_;  ///< in place of a file
    bool seekable_ = false;
    std::vector<std::byte> buffer_;
    std::uint64_t written_ = 0;
};

/// The same for what is in memory already.
Expected<void> writeWholeFile(const std::string& path, std::span<const std::byte> bytes,
                              Readers readers = Readers::AsUsual);

}  // namespace scancast
