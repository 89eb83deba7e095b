// A temporary folder of this process, for files that nobody else looks for: readable by its user alone, gone with the object,
// and locked while it lives. What a process left behind that ended before its objects did has no lock, and is swept by the
// next one. Move-only; used by one thread at a time.
#pragma once

#include <cstddef>
#include <filesystem>
#include <utility>

#include "files/unique_fd.hpp"
#include "protocol/error.hpp"

namespace scancast {

class OwnedFolder {
  public:
    /// Errors: Io, ResourceLimit.
    static Expected<OwnedFolder> make(const std::filesystem::path& parent);
    OwnedFolder(OwnedFolder&& other) noexcept
        : path_(std::exchange(other.path_, {})), lock_(std::move(other.lock_)) {}
    OwnedFolder& operator=(OwnedFolder&&) = delete;
    ~OwnedFolder();

    const std::filesystem::path& path() const { return path_; }

  private:
    OwnedFolder(std::filesystem::path path, UniqueFd lock) : path_(std::move(path)), lock_(std::move(lock)) {}

    std::filesystem::path path_;
    UniqueFd lock_;
};

/// Removes those of this user in `parent` that nobody has any more; returns how many.
std::size_t sweepOwnedFolders(const std::filesystem::path& parent);

}  // namespace scancast
