// The flags of `serve` and `ingest` that say how importers are limited and shut in, and how scans are taken. One table for both; numbers become ImportOptions.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "renderer/cloud/import/open_scan.hpp"

namespace scancast {

struct ImporterFlags {
    std::string sandbox = "auto";
    std::string memory = "16G";  ///< as written
    std::uint64_t time = 7200;   ///< seconds of processor time
    int silence = 60;            ///< seconds
    std::string assumeCrs;       ///< as written; empty = scans are believed
};

/// --assume-crs alone, for commands that have nothing else to say of importers.
CLI::Option* addAssumeCrs(CLI::App& app, std::string& crs);
/// InvalidArgument for what is no CRS; nullopt for nothing.
Expected<std::optional<AssumedCrs>> assumedCrs(const std::string& crs);

/// `environment`: whether they can come from there, too. `flags` must outlive the parse.
void addImporterFlags(CLI::App& app, ImporterFlags& flags, bool environment);

/// InvalidArgument for what is no CRS, for a size that is none, or too small for any importer.
Expected<ImportOptions> importOptions(const ImporterFlags& flags);

struct SandboxLine {
    bool sound = true;  ///< nothing that was not wished for is missing
    std::string text;   ///< "importers are shut in: …", for the log and for people
};
/// Asks the machine, some milliseconds. Never fails: that it cannot be asked is what the line says then.
SandboxLine sandboxLine(const ImportOptions& options);

}  // namespace scancast
