// `--config FILE`: a JSON object whose keys are names of flags, `files` for what stands without one. Works on
// any CLI::App whose flags have long names. Free functions; the thread that parses the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "protocol/error.hpp"

namespace scancast {

/// The key of positional arguments.
inline constexpr const char* filesKey = "files";

/// Sets what neither the command line nor the environment has set. After the parse. Errors name the file and
/// the key: Io, Malformed, InvalidArgument for unknown keys (with the nearest known one) and values that the
/// flag would not take.
Expected<void> applyConfigFile(CLI::App& app, const std::filesystem::path& file);

/// What holds, in the form of such a file; what is empty is left out. Secrets are never in it, because flags
/// only name the files that hold them.
nlohmann::json effectiveConfig(const CLI::App& app);

}  // namespace scancast
