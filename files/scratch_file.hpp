// An unnamed temporary file, which vanishes with the process, whatever ends it: room for what does not fit into memory, or
// is not worth any. Places in it are handed out one behind the other and given back as holes.
//
// *Thread safety*: any thread; writes to one place must not overlap.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "files/unique_fd.hpp"
#include "protocol/error.hpp"

namespace scancast {

class ScratchFile {
  public:
    /// `chosenWith` names what a user chooses the folder with, for messages: "--scratch". Errors, of all members: Io; ResourceLimit
    /// for a full disk.
    static Expected<std::unique_ptr<ScratchFile>> create(const std::filesystem::path& folder,
                                                         std::string chosenWith);

    /// A place for so many bytes: its offset.
    std::uint64_t reserve(std::uint64_t bytes);
    Expected<void> write(std::uint64_t at, std::span<const std::byte> from) const;
    Expected<void> read(std::uint64_t at, std::span<std::byte> into) const;
    /// Best effort: a file system without holes keeps the room until the end.
    void release(std::uint64_t at, std::uint64_t bytes) const;

    /// What bytes take: as places of a file of which each can become a hole, they are whole pages.
    static std::uint64_t wholePages(std::uint64_t bytes);

  private:
    ScratchFile(UniqueFd fd, std::filesystem::path folder, std::string chosenWith);
    Error error(int number, const char* what) const;

    UniqueFd fd_;
    std::filesystem::path folder_;
    std::string chosenWith_;
    std::atomic<std::uint64_t> end_{0};
};

}  // namespace scancast
