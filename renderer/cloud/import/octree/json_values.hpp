// Values out of the JSON files that describe octrees, checked. Pure functions; errors are Malformed, or Unsupported where
// they say so, and name the value as `what` says. For importers of octrees, and for EPT that is shown as it is.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

#include "protocol/error.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast::import_octree {

/// Of a description; 16 MiB have a million nodes.
inline constexpr std::uint64_t longestJson = std::uint64_t(16) << 20;

/// The object that a file's bytes are; `name` is what messages call it. Bytes that are no ASCII become '?': nothing that is looked for has any.
Expected<nlohmann::json> parseJsonObject(std::span<const std::byte> bytes, const std::string& name);

/// `object[key]`, or null. `object` may be anything.
const nlohmann::json& valueAt(const nlohmann::json& object, const char* key);
/// Cut to 40 characters, for messages; "undefined" for null.
std::string shown(const nlohmann::json& value);
/// A text as it is, a number as it is written, else "".
std::string wordOf(const nlohmann::json& value);

Expected<double> numberOf(const nlohmann::json& value, const std::string& what);
Expected<glm::dvec3> vectorOf(const nlohmann::json& value, const std::string& what);
Expected<std::uint64_t> countOf(const nlohmann::json& value, const std::string& what, std::uint64_t most);

/// A hint, so a wrong one is none.
std::optional<std::array<glm::dvec3, 2>> boundsOf(const nlohmann::json& low, const nlohmann::json& high);

/// Whatever it is, the coordinate reference system that a text names, if any: "EPSG:25832" or WKT. PROJ's strings are
/// none.
void takeCrs(const std::string& text, ScanHeader& header);

/// Malformed unless the scale is positive, and every number of 32 bits near enough to be a coordinate.
Expected<void> checkGrid(const glm::dvec3& scale, const glm::dvec3& offset, const std::string& file);

}  // namespace scancast::import_octree
