// Which system calls an importer may make, as a filter of seccomp: a list of those that no reader of files needs. Used by the launcher, once, last of all.
// Pipeline: scan → **sandbox** → importer process.
#pragma once

#include "protocol/error.hpp"

namespace scancast::sandbox {

/// Whether this kernel has filters.
bool filtersSystemCalls();

/// From now on this process, and what it becomes, is refused (EPERM) sockets, processes besides itself, signals to others, tracing, mounts, namespaces, keys and
/// what administers the machine; what would take the machine over ends it (SIGSYS). Threads, and becoming another program, are allowed.
/// Privileges have to be given up before. Error: Unsupported, Io.
Expected<void> refuseSystemCalls();

}  // namespace scancast::sandbox
