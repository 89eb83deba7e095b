// `scancast export`, as command.hpp says it of the others.
#pragma once

#include <CLI/CLI.hpp>

namespace scancast {

void addExport(CLI::App& app, int& exitCode);

}  // namespace scancast
