// What is known of a file as text for people and as JSON (docs/info.md). Pure functions.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "server/commands/file_info.hpp"

namespace scancast {

/// Several lines, the last one ended.
std::string infoText(const FileInfo& info);
/// One member of "files".
nlohmann::ordered_json infoJson(const FileInfo& info);

}  // namespace scancast
