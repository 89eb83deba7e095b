// `scancast-ranks serve` and `scancast-ranks render`: pictures by several processes. Rank 0 is the whole server, or the whole of
// `render`, with a device that the other ranks draw for (ranks/draw/ranks_device.hpp).
#pragma once

#include <CLI/CLI.hpp>

namespace scancast {

void addRanksServe(CLI::App& app, int& exitCode);
void addRanksRender(CLI::App& app, int& exitCode);

}  // namespace scancast
