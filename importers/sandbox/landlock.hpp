// Landlock: a process gives up the right to open files, but for those on a list, and with newer kernels to use TCP and to send signals.
// Used by the launcher, once. Pipeline: scan → **sandbox** → importer process.
// The kernel's Documentation/userspace-api/landlock.rst says what each version adds.
#pragma once

#include <string>

#include "importers/sandbox/allowed_files.hpp"
#include "protocol/error.hpp"

namespace scancast::sandbox {

/// 0: this kernel has none, or it is switched off. From 4 on for TCP, from 6 on for signals.
int landlockVersion();

/// From now on this process, and what it becomes, opens what `files` lists, to read and to execute, /dev/null to write, and `scan`, what is open there.
/// Privileges have to be given up before. Error: Unsupported without Landlock, Io when the kernel refuses.
Expected<void> shutByLandlock(const AllowedFiles& files, int scan);

}  // namespace scancast::sandbox
