// A file that is being written under the name that it has until it is complete (unfinished_name.hpp), locked for as long
// as somebody writes it: what has such a name and no lock was left by a process that ended, and is swept. The lock says
// so, not a number in the name: numbers of processes come again, and differ between containers. Where the file system
// knows no locks, nothing is swept. Free functions; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string_view>

#include "files/unfinished_name.hpp"
#include "files/unique_fd.hpp"
#include "protocol/error.hpp"

namespace scancast {

/// Who may read what is written: whoever the user's umask lets, or nobody but the user.
enum class Readers : std::uint8_t { AsUsual, OwnerAlone };

struct UnfinishedFile {
    UniqueFd fd;  ///< to read and write; has the lock
    UnfinishedName name;
};

/// The end of every unfinished name.
inline constexpr std::string_view unfinishedEnd = ".partial";

/// `<path>.partial`, empty. What somebody left there is overwritten, unless he still writes: InvalidArgument. Errors:
/// Io, NotFound (no such folder), ResourceLimit; nothing is left then.
Expected<UnfinishedFile> takeUnfinished(const std::filesystem::path& path, Readers readers);
/// `<path>.NUMBER.partial`, a name that nobody else has: several may write the same file, and the last one to finish
/// it has written it. Errors as above.
Expected<UnfinishedFile> makeUnfinished(const std::filesystem::path& path, Readers readers);

/// Removes the unfinished files of a folder that nobody writes any more, of those whose names `isOurs` accepts; returns
/// how many.
std::size_t sweepUnfinished(const std::filesystem::path& folder,
                            const std::function<bool(std::string_view name)>& isOurs);

}  // namespace scancast
