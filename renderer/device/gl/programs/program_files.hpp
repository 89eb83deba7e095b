// Compiled programs on disk, so that the next start need not compile them again: one file per program and
// driver, `KEY.program`. Whatever is wrong with a file, or with the folder, costs a compilation and never a
// picture: it is told at debug level, and the file is written anew.
//
// A file: magic and version, XXH3 of all that follows, the binary's format, the program's key, the driver's
// name and the binary, each length before its bytes; little-endian, for this machine only. Owned by
// `Programs`, on its thread; several processes may share a folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"

namespace scancast::gl {

/// What glGetProgramBinary gives and glProgramBinary takes.
struct ProgramBinary {
    std::uint32_t format = 0;
    std::vector<std::byte> bytes;
};

/// A program by its source and the driver that compiled it.
struct ProgramKey {
    std::string driver;  ///< as it names itself
    std::string digest;  ///< 32 hexadecimal digits of source and driver; the file's name

    static ProgramKey of(std::string_view source, std::string driver);
};

std::vector<std::byte> printProgramFile(const ProgramKey& key, const ProgramBinary& binary);
/// Malformed or Truncated when the file is damaged; Unsupported when it is another version's, program's or
/// driver's.
Expected<ProgramBinary> parseProgramFile(std::span<const std::byte> file, const ProgramKey& key);

class ProgramFiles {
  public:
    static constexpr std::uint64_t usualLimit = std::uint64_t{64} << 20;

    /// Beyond `mostBytes` the files written longest ago go. The folder is made when it is first needed.
    explicit ProgramFiles(std::filesystem::path folder, std::uint64_t mostBytes = usualLimit)
        : folder_(std::move(folder)), mostBytes_(mostBytes) {}

    /// Nothing when there is no such file, or none to trust.
    std::optional<ProgramBinary> read(const ProgramKey& key) const;
    /// Under another name first: nobody ever reads half a file.
    void write(const ProgramKey& key, const ProgramBinary& binary) const;

  private:
    std::filesystem::path pathOf(const ProgramKey& key) const;
    void removeOldest() const;

    std::filesystem::path folder_;
    std::uint64_t mostBytes_;
};

}  // namespace scancast::gl
