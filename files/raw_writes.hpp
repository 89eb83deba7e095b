// Writes in place that are whole and on disk, as a cloud file needs them: written front to back, or changed under a
// lock. What the system refuses comes back as its error number, 0 = nothing; whoever calls says what it was
// about. Free functions; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace scancast {

/// All of the bytes; ENOSPC where the system takes none.
int writeFullyAt(int fd, std::uint64_t offset, std::span<const std::byte> bytes);
/// What was written is on disk.
int syncFile(int fd);
/// Takes the lock of who writes a file, or has a folder, for as long as it is open; EWOULDBLOCK where somebody else has it.
int lockNow(int fd);
/// Whether `fd` still is what the name leads to: it may have been renamed or removed before the lock was ours.
bool isStillNamed(int fd, const std::filesystem::path& name);

}  // namespace scancast
