// The subcommands of `scancast`. Each file in this folder adds one, with its help and its example.
#pragma once

#include <CLI/CLI.hpp>

namespace scancast {

/// Each adds its subcommand to `app`; when it is the one called, its callback runs it and sets `exitCode`
/// (0 = done, 1 = failed with an error on standard error).
void addServe(CLI::App& app, int& exitCode);
void addRender(CLI::App& app, int& exitCode);
void addIngest(CLI::App& app, int& exitCode);
void addInfo(CLI::App& app, int& exitCode);
void addLook(CLI::App& app, int& exitCode);
void addLabel(CLI::App& app, int& exitCode);
void addGenerate(CLI::App& app, int& exitCode);

}  // namespace scancast
