// `--config FILE`: a JSON object whose keys are names of flags, `files` for what stands without one. Works on
// any CLI::App whose flags have long names. Free functions; the thread that parses the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

/// The key of positional arguments.
inline constexpr const char* filesKey = "files";

/// Sets what neither the command line nor the environment has set. After the parse. Errors name the file and
/// the key: Io, Malformed, InvalidArgument for unknown keys (with the nearest known one) and values that the
/// flag would not take.
Expected<void> applyConfigFile(CLI::App& app, const std::filesystem::path& file);

/// What the command line and the environment have set, by keys as in such a file.
using GivenFlags = std::map<std::string, std::vector<std::string>>;
/// Of an app that was parsed, before applyConfigFile().
GivenFlags givenFlags(const CLI::App& app);
/// Sets the same on another app of the same flags, which has parsed nothing: a file that is applied then comes behind it, as
/// it did at the start.
Expected<void> applyGivenFlags(CLI::App& app, const GivenFlags& given);

/// What holds, in the form of such a file; what is empty is left out. Secrets are never in it, because flags
/// only name the files that hold them.
nlohmann::json effectiveConfig(const CLI::App& app);

}  // namespace scancast
