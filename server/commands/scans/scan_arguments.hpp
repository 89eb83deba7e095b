// The words of a command line that name scans, the same for every command that takes them. `files` and the like must outlive the parse.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace scancast {

/// --verbose, for tellLeftOut().
void addVerbose(CLI::App& app, bool& verbose);
/// A cloud file, or scans that are taken as one: openAny(). With --verbose.
void addFilesAsOne(CLI::App& app, std::vector<std::string>& files, bool& verbose);

}  // namespace scancast
