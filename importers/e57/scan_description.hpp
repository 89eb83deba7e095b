// What an E57 file says of one scan before its points: its pose, its fields, their limits, where its points lie. Nothing in
// it is believed. Pure functions. Pipeline: XML records → **scan descriptions** → points.
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "importers/e57/fields.hpp"
#include "importers/e57/xml_records.hpp"
#include "protocol/error.hpp"

namespace scancast::import_e57 {

/// From the scan's coordinates to the file's: rotated, then moved.
struct Pose {
    glm::dmat3 rotation{1};
    glm::dvec3 translation{0};
    bool rotates = false;
    bool wasZero = false;  ///< the quaternion; it is taken for no rotation
    bool wasLong = false;  ///< its length was not 1; it was divided by it
};

struct ScanDescription {
    std::string name;
    std::string guid;  ///< what photos call it; may be empty
    std::uint64_t records = 0;
    std::uint64_t section = 0;  ///< physical offset of its points
    std::vector<Field> fields;  ///< in the order of their bytestreams
    RoleIndices fieldOf;
    std::optional<Pose> pose;
    std::optional<Limits> intensity;             ///< of the whole scale, where declared: finite, with a width
    std::array<std::optional<Limits>, 3> color;  ///< the same
    std::optional<std::array<glm::dvec3, 2>> bounds;  ///< declared ones, in the scan's coordinates; finite
    bool besideTurned = false;        ///< other scans of the file have poses that turn, as scanners' do
    bool hasSphericalBounds = false;  ///< with a least range above 0

    bool hasCoordinates() const { return fieldOf.cartesian() || fieldOf.spherical(); }
    glm::dvec3 inFile(const glm::dvec3& p) const { return pose ? pose->rotation * p + pose->translation : p; }
    /// Whether its coordinates' origin is surely where the scanner was: it is spherical or a grid of rows and columns seen
    /// from there, or somebody turned it, or others of its file, into place. Clouds that are merged or merely moved have poses, too.
    bool standsAtOrigin() const;
};

/// Of a scan or a photo. `called`: as below. Errors: Malformed.
Expected<Pose> describePose(const XmlElement& element, const std::string& called);

/// `scan`: an entry of data3D. `called`: such as "scan 3", to begin sentences. Errors: Malformed.
Expected<ScanDescription> describeScan(const XmlElement& scan, const std::string& called);

}  // namespace scancast::import_e57
