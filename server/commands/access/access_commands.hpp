// The subcommands of `scancast` that make secrets for `serve`. A file each, as in server/commands/ (command.hpp).
#pragma once

#include <CLI/CLI.hpp>

namespace scancast {

void addToken(CLI::App& app, int& exitCode);
void addGuestLink(CLI::App& app, int& exitCode);

}  // namespace scancast
