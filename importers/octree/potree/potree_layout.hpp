// What a point of a Potree octree is made of, from the attributes in its JSON file: names with a fixed size in Potree 1,
// objects that tell type and size in 1.8 and 2. Pure functions on JSON. Pipeline: description → **layout** → nodes → points.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "renderer/cloud/import/octree/point_layout.hpp"

namespace scancast::import_octree {

/// How an attribute of all points of a node is stored where the encoding is BROTLI.
enum class PotreeCode : std::uint8_t {
    Plain,     ///< as in a record
    Position,  ///< 16 bytes: a Morton code of three times 32 bits
    Color,     ///< 8 bytes: of three times 16
};

/// An attribute as the file has it: the bytes of a record that it is.
struct PotreeAttribute {
    PotreeCode code = PotreeCode::Plain;
    std::uint32_t at = 0, bytes = 0;

    /// Of one point where the encoding is BROTLI.
    std::uint32_t codeBytes() const {
        return code == PotreeCode::Position ? 16 : code == PotreeCode::Color ? 8 : bytes;
    }
};

struct PotreeLayout {
    PointLayout points;
    std::vector<PotreeAttribute> attributes;
};

/// `floats`: positions are numbers of type float, as before version 1.4. Errors: Malformed, Unsupported for a name that is
/// not known and comes without a size.
Expected<PotreeLayout> layOutPotree(const nlohmann::json& list, bool floats);

}  // namespace scancast::import_octree
