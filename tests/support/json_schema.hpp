// Checks JSON against the part of JSON Schema that protocol/openapi.json uses; a keyword that it does not
// know is an error, so that nothing in there goes unchecked unnoticed. Oracle: it shares no code with the
// printers.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace scancast::test {

/// What is wrong with `value`, each with its path; empty = nothing. `document` is where "#/…" leads.
std::vector<std::string> schemaErrors(const nlohmann::json& document, const nlohmann::json& schema,
                                      const nlohmann::json& value, const std::string& path = "$");

/// Follows "$ref", if there is one.
const nlohmann::json& resolved(const nlohmann::json& document, const nlohmann::json& value);

}  // namespace scancast::test
