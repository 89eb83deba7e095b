// Whether scans may be put together into one cloud, by what they say of their coordinate reference systems: told, not
// guessed. Pure functions of what headers say; no point is needed. Pipeline: scan headers → **merged CRS** → many scans.
//
//   provably different             refused
//   the same                       put together
//   missing, or nobody can tell    put together with a note where the scans lie near each other, refused where they are far apart
//
// Far apart: by more than 100 km and by more than ten times the larger one's extent. Scans that are near one that is near …
// are near. None of them says anything: then they are put together without a note, if they are near.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

/// What is known of one of the scans.
struct ScanCrs {
    std::string name;  ///< what messages call it
    std::string wkt{};
    std::optional<int> epsg{};
    std::optional<std::array<glm::dvec3, 2>>
        bounds{};  ///< min, max; nullopt = not known, which is near to all
};

/// What is taken for all of them.
struct MergedCrs {
    std::string wkt;  ///< empty = nothing is known
    std::optional<int> epsg;
    std::vector<std::string> notes;  ///< one sentence each, without an end
    bool boundsMatter = false;       ///< with bounds of those that have none, the answer could be another
};

/// Whether its bounds say where it lies: headers may have none, or nonsense.
bool hasPlace(const ScanCrs& scan);

/// At least one scan. InvalidArgument with the files, their systems, and the ways out.
Expected<MergedCrs> mergeCrs(std::span<const ScanCrs> scans);

}  // namespace scancast
