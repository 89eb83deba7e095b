// The part of a cloud whose points are wanted: what is exported, on the command line as over HTTP, and what a profile is cut
// out of. Plain values and their JSON; file coordinates throughout. Pure functions; any thread.
#pragma once

#include <array>
#include <bitset>
#include <glm/vec2.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"
#include "protocol/view/view.hpp"

namespace scancast {

class FieldReader;

/// Corners in plan, in turn; the last one is joined to the first. Even-odd: what its edges go round twice is outside. Of
/// points on an edge those belong to it that have the inside on their right (+x) or, on a horizontal edge, above (+y): of
/// polygons that share an edge each point is in exactly one.
using PlanPolygon = std::vector<glm::dvec2>;
inline constexpr std::size_t mostPolygonCorners = 2000;

/// Everything that is given has to hold.
struct PointsRegion {
    std::optional<ClipBox> clip{};              ///< its faces included
    ClipShapes clips{};                         ///< what these leave (clip_shapes.hpp); none: everything
    std::optional<std::bitset<256>> classes{};  ///< points without a class have 0
    ColumnRanges filter{};                      ///< of columns' values; none: everything
    std::optional<PlanPolygon> polygon{};
    std::optional<std::array<double, 2>> z{};  ///< lowest and highest, both included

    bool isEverything() const {
        return !clip && clips.empty() && !classes && filter.empty() && !polygon && !z;
    }
};

/// Whether it is one: 3 to mostPolygonCorners corners, numbers. InvalidArgument.
Expected<void> checkPolygon(const PlanPolygon& polygon);
/// Whether numbers are ones that a scan may lie at: finite, and at most 1e12 in size.
bool isPlanPlace(const glm::dvec2& place);

/// "X,Y;X,Y;…", as flags have it. InvalidArgument, of this flag or field.
Expected<std::vector<glm::dvec2>> parsePlanPlaces(std::string_view text, std::string_view field);
/// "LOW,HIGH". InvalidArgument.
Expected<std::array<double, 2>> parseHeights(std::string_view text);
/// The words of a view that a region is made of - clip, clips, classes, filter - from their text. InvalidArgument, with the word as field.
Expected<void> applyRegionWord(PointsRegion& region, std::string_view word, std::string_view text);

/// The fields of a region's object; errors are the reader's.
void readRegion(FieldReader& fields, PointsRegion& region);
/// [[x, y], …] of least to most places; errors are the reader's.
bool readPlanPlaces(FieldReader& fields, std::string_view key, std::size_t least, std::size_t most,
                    std::vector<glm::dvec2>& out);
nlohmann::json toJson(const PointsRegion& region);
nlohmann::json planPlacesJson(const std::vector<glm::dvec2>& places);

}  // namespace scancast
