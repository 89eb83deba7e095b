// `scancast distance`, as command.hpp says it of the others.
#pragma once

#include <CLI/CLI.hpp>

namespace scancast {

void addDistance(CLI::App& app, int& exitCode);

}  // namespace scancast
