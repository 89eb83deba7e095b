// A place that a scanner stood at, as the scan says it: what people know their scans by, a place to look from, and the side
// that its points' normals point to. Plain values. Pipeline: import → **stations** → facts → info, API, page.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>

namespace scancast {

/// More are counted in a note and left out of lists; their points are read all the same.
inline constexpr std::size_t mostStations = 4096;
inline constexpr std::size_t longestStationName = 256;  ///< bytes; longer ones are cut

struct Station {
    std::string name{};        ///< for people, printable; may be empty
    glm::dvec3 position{0};    ///< file coordinates
    std::uint64_t points = 0;  ///< recorded from there and read
    /// Where the scanner's own x axis, its forwards, points to: a unit vector, file coordinates. nullopt: not known.
    std::optional<glm::dvec3> forwards{};
    bool operator==(const Station&) const = default;
};

/// Its name, or by its place in the list, from 0: "Scan 3".
inline std::string titleOf(const Station& station, std::size_t index) {
    return station.name.empty() ? "Scan " + std::to_string(index + 1) : station.name;
}

/// nullopt for a vector that is too short or too long to have a direction.
inline std::optional<glm::dvec3> unitVector(const glm::dvec3& v) {
    const double length = glm::length(v);
    if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
    const glm::dvec3 unit = v / length;
    if (!(std::abs(glm::length(unit) - 1) <= 1e-9)) return std::nullopt;
    return unit;
}

}  // namespace scancast
