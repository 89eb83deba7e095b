// What the operating system refused, in words. Pure functions.
#pragma once

#include <string>

namespace scancast {

/// "No space left on device" for ENOSPC.
std::string systemReason(int error);

/// Whether it means that no more can be written: the disk, a quota, or how large files may become (ulimit -f,
/// or the file system) is used up.
bool isFull(int error);

/// What helps then, as the end of a sentence: "free some space or choose another place".
std::string wayOutOfFull(int error);

}  // namespace scancast
