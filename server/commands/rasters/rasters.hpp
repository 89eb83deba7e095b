// `scancast dem` and `scancast ortho`.
#pragma once

#include <CLI/CLI.hpp>

namespace scancast {

/// Both, as the subcommands in command.hpp.
void addRasters(CLI::App& app, int& exitCode);

}  // namespace scancast
