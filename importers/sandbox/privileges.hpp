// What a process is besides its files: whose it is, whose it dies with, what it may use. Each function is for the launcher, before it
// becomes the importer. Pipeline: scan → **sandbox** → importer process.
#pragma once

#include <sys/types.h>

#include <cstdint>

#include "protocol/error.hpp"

namespace scancast::sandbox {

/// When the thread of `parent` that started this process ends, this process is killed; what it becomes, too. Error: Cancelled when it is gone already.
Expected<void> dieWith(pid_t parent);

/// Nothing that is executed gets more rights, by its owner or by capabilities.
Expected<void> renouncePrivileges();

/// No capability stays. `readsAll`: of the superuser one does, to read scans whose owner is another; for where something else decides
/// what may be opened.
void dropCapabilities(bool readsAll);

/// From the superuser to a user who owns nothing. Error: Unsupported for any other user, Io when the kernel refuses.
Expected<void> becomeNobody();

struct Limits {
    std::uint64_t processorSeconds = 0;  ///< 0 = none, as for all
    std::uint64_t addressKib = 0;
    bool writesNothing = false;  ///< no file grows
};
/// No core dumps, and these. A limit that cannot be set is one that is tighter already.
void setLimits(const Limits& limits);

}  // namespace scancast::sandbox
