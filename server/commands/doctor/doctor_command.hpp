// `scancast doctor`, which main() adds.
#pragma once

#include <CLI/CLI.hpp>

namespace scancast {

/// As those of server/commands/command.hpp.
void addDoctor(CLI::App& app, int& exitCode);

}  // namespace scancast
