// A folder from outside, opened once; what is asked of it lies beneath it, whatever its names and links say.
// *Thread safety*: const functions from any thread. Place: outside → **files** → scans, octrees of other
// programs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <variant>

#include "files/input_file.hpp"

namespace scancast {

class InputFolder;
/// What a name led to.
using Input = std::variant<InputFile, InputFolder>;

class InputFolder {
  public:
    /// Follows symbolic links. Errors: as InputFile::open(); Unsupported for what is no folder.
    static Expected<InputFolder> open(const std::filesystem::path& path);
    static Expected<InputFolder> adopt(UniqueFd fd, std::filesystem::path name);

    /// Opens what lies beneath. Errors, which name the whole path: InvalidArgument for a name or a link that
    /// leads out of this folder, NotFound, Io, Unsupported for what is neither file nor folder.
    Expected<Input> at(const std::filesystem::path& name) const;
    /// The same for a file; Unsupported for a folder.
    Expected<InputFile> file(const std::filesystem::path& name) const;

    const std::filesystem::path& name() const { return name_; }
    int descriptor() const { return fd_.get(); }
    /// Of all files in it, however deep, and of those that links lead to; links to folders are not followed.
    std::uint64_t bytes() const;

  private:
    InputFolder(UniqueFd fd, std::filesystem::path name) : fd_(std::move(fd)), name_(std::move(name)) {}

    UniqueFd fd_;
    std::filesystem::path name_;
};

/// A file or a folder, links followed. Errors: as InputFile::open().
Expected<Input> openInput(const std::filesystem::path& path);

}  // namespace scancast
