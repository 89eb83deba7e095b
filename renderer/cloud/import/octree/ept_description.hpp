// ept.json: what an Entwine Point Tile folder says of itself (EPT 1.0 and 1.1), checked. Pure functions on JSON.
// Pipeline: **description** → hierarchy → tiles → points.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "renderer/cloud/import/octree/json_values.hpp"
#include "renderer/cloud/import/octree/point_layout.hpp"

namespace scancast::import_octree {

enum class EptData : std::uint8_t { Laszip, Binary, Zstandard };

struct EptDescription {
    EptData data = EptData::Binary;
    std::optional<std::uint64_t> points;  ///< as declared
    /// The cube of the octree, file coordinates; nullopt where it is none.
    std::optional<std::array<glm::dvec3, 2>> cube{};
    /// Of a record; of LASzip tiles a list of what there is, in no particular place.
    PointLayout layout;
    /// Format, bounds, grid and coordinate reference system, as far as it says them.
    ScanHeader header;
};

/// "laszip", "binary", "zstandard".
std::string_view name(EptData data);
/// Of its tiles: "laz", "bin", "zst".
std::string_view extension(EptData data);

/// Errors: Malformed, Unsupported; they begin with "ept.json" where it is at fault.
Expected<EptDescription> parseEptDescription(const nlohmann::json& json);

}  // namespace scancast::import_octree
