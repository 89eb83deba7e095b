// Blocks of cloud files that could not be read, on their way from the threads that read them to whoever looks
// after the files. Made before both; keeps what comes while nobody listens.
//
// Owned by both ends together. *Thread safety*: every function may be called from any thread. Place: block
// cache → **damage reports** → cloud watch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/cloud/file/cloud_file.hpp"

namespace scancast {

struct DamageReport {
    std::shared_ptr<const CloudFile> file;
    Error error;
};

/// What cannot be read, as half a sentence that names the file.
std::string damageText(const CloudFile& file, const Error& error);

class DamageReports {
  public:
    static constexpr std::size_t mostKept = 1024;  ///< while nobody listens; the rest is counted
    using Listener = std::function<void(DamageReport)>;

    void add(std::shared_ptr<const CloudFile> file, Error error);
    /// Tells what has been kept, and from now on everything; an empty one = nobody listens. When this returns,
    /// the one of before is not called any more. A listener must not call back.
    void listenWith(Listener listener);
    /// How many there was no room for.
    std::uint64_t leftOut() const;

  private:
    mutable std::mutex mutex_;
    Listener listener_;
    std::vector<DamageReport> kept_;
    std::uint64_t leftOut_ = 0;
};

}  // namespace scancast
