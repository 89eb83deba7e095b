// The subcommands of `scancast-ranks`. Each folder beside this file adds one, with its help and its example.
#pragma once

#include <CLI/CLI.hpp>

namespace scancast {

/// Each adds its subcommand to `app`; when it is the one called, its callback runs it and sets `exitCode`
/// (0 = done, 1 = failed with an error on standard error, told by one rank).
void addRanksIngest(CLI::App& app, int& exitCode);
void addRanksServe(CLI::App& app, int& exitCode);
void addRanksRender(CLI::App& app, int& exitCode);
void addRanksFront(CLI::App& app, int& exitCode);
/// What the front has started; nobody else calls it.
void addRanksDraw(CLI::App& app, int& exitCode);

/// All of them.
inline void addRanksCommands(CLI::App& app, int& exitCode) {
    addRanksIngest(app, exitCode);
    addRanksServe(app, exitCode);
    addRanksRender(app, exitCode);
    addRanksFront(app, exitCode);
    addRanksDraw(app, exitCode);
}

}  // namespace scancast
