// A file from outside, opened once, without waiting, and judged by what was opened, never by its name:
// whoever may write in its folder could put a named pipe, a device or a link there between a look and the
// opening. What is no regular file is an error: nothing else has a size, or ends. Owned by one reader;
// *thread safety*: const functions from any number of threads. Place: outside → **files** → readers.
#pragma once

#include <sys/types.h>

#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "files/unique_fd.hpp"
#include "protocol/error.hpp"

namespace scancast {

/// Which file it is, and in which state it was when it was opened.
struct FileIdentity {
    std::uint64_t device = 0, inode = 0, bytes = 0;
    std::int64_t changed = 0;  ///< its content, in nanoseconds since 1970

    bool operator==(const FileIdentity&) const = default;
};

class InputFile {
  public:
    /// Follows symbolic links. Errors: NotFound, Io, Unsupported for what is no regular file; they start with
    /// the path.
    static Expected<InputFile> open(const std::filesystem::path& path);
    /// Judges what somebody opened with inputFlags. `name` is what messages call it.
    static Expected<InputFile> adopt(UniqueFd fd, std::filesystem::path name);

    const std::filesystem::path& name() const { return name_; }
    const FileIdentity& identity() const { return identity_; }
    std::uint64_t bytes() const { return identity_.bytes; }
    mode_t permissions() const { return permissions_; }
    int descriptor() const { return fd_.get(); }

    /// The descriptor, for who keeps that alone.
    UniqueFd release() && { return std::move(fd_); }
    /// Another handle of the same open file. Error: Io, when this process has too many.
    Expected<InputFile> share() const;
    /// Bytes at an offset; fewer only where the file ends. Errors: Io, naming the byte.
    Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) const;
    /// All of it. Errors: Io; ResourceLimit beyond `most` bytes.
    Expected<std::string> text(std::size_t most) const;

  private:
    InputFile(UniqueFd fd, std::filesystem::path name) : fd_(std::move(fd)), name_(std::move(name)) {}

    UniqueFd fd_;
    std::filesystem::path name_;
    FileIdentity identity_;
    mode_t permissions_ = 0;
};

/// All of a file, opened as above. Errors: InputFile::open()'s and InputFile::text()'s.
Expected<std::string> readTextFile(const std::filesystem::path& path, std::size_t most);

/// How everything from outside is opened: named pipes without a writer and devices do not wait, no terminal
/// becomes this process's own.
extern const int inputFlags;

/// "… cannot be opened", for an errno of open().
tl::unexpected<Error> failedToOpen(const std::filesystem::path& name, int error);

/// All bytes of `fd` from `offset`, as far as there are any. `name` is what messages call it.
Expected<std::size_t> readFullyAt(int fd, std::uint64_t offset, std::span<std::byte> into,
                                  const std::filesystem::path& name);

}  // namespace scancast
