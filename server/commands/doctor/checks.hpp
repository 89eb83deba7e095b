// What `scancast doctor` looks at, by the very checks of `serve`: each function adds what it found, and none ends the
// others. Used on one thread.
#pragma once

#include "server/commands/doctor/findings.hpp"
#include "server/commands/serve_options.hpp"

namespace scancast {

/// What draws, memory, processors, files that may be open, the clock. machine_checks.cpp
void lookAtMachine(const ServeOptions& options, Findings& findings);
/// Where it listens, who may come, the certificate. entrance_checks.cpp
void lookAtEntrances(const ServeOptions& options, Findings& findings);
/// Folders that it reads and writes, importers, and the clouds themselves, by what stands before their points. file_checks.cpp
void lookAtFiles(const ServeOptions& options, Findings& findings);

}  // namespace scancast
