// The body of POST /clouds/{id}/measure: what is to be measured, and at which points. Pure functions; any thread.
// Pipeline: client → **request** → vertices (arithmetic), or renderer/measure (from the scan's points).
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

enum class MeasureKind : std::uint8_t {
    Distance,  ///< along a polyline
    Angle,     ///< at its vertices
    Area,      ///< of a polygon
    Volume,    ///< between the scan's surface and a base, over a polygon
    Plane,     ///< fitted, as those that follow
    Circle,
    Sphere,
    Cylinder,
};
inline constexpr std::array<std::string_view, 8> measureNames{"distance", "angle",  "area",   "volume",
                                                              "plane",    "circle", "sphere", "cylinder"};
constexpr std::string_view name(MeasureKind kind) {
    return measureNames[std::size_t(kind)];
}

/// What a volume is measured from.
enum class VolumeBase : std::uint8_t {
    Lowest,  ///< the polygon's lowest corner
    Mean,    ///< the mean height of its corners
    Fit,     ///< the plane through its corners that is best in height
    Height,  ///< a number
};
inline constexpr std::array<std::string_view, 3> volumeBaseNames{"lowest", "mean", "fit"};

/// Which of a raster cell's points are its height.
enum class VolumeSurface : std::uint8_t {
    Top,      ///< the mean of those that are less than a cell's side below its highest
    Highest,  ///< the highest
    Mean,     ///< the mean of all
    Lowest,   ///< the lowest
};
inline constexpr std::array<std::string_view, 4> volumeSurfaceNames{"top", "highest", "mean", "lowest"};

inline constexpr std::size_t mostMeasuredPoints = 1000;

struct MeasureRequest {
    MeasureKind kind = MeasureKind::Distance;
    /// Any subset of a view, of which what decides which points are drawn counts; checked when it is applied.
    nlohmann::json view = nlohmann::json::object();
    std::vector<glm::dvec3> points;  ///< vertices, corners, or picked points; file coordinates
    VolumeBase base = VolumeBase::Lowest;
    double height = 0;  ///< of VolumeBase::Height
    VolumeSurface surface = VolumeSurface::Top;
    std::optional<double> cell;      ///< side of the volume's raster; nullopt: by the scan's spacing
    std::optional<double> within;    ///< the scan's points that are so near to any of `points` are fitted
    std::optional<glm::dvec3> axis;  ///< of a circle; not 0

    /// From the vertices alone.
    bool isArithmetic() const { return kind <= MeasureKind::Area; }
};

/// Malformed when the text is no JSON; InvalidArgument, with the path as field, for everything else.
Expected<MeasureRequest> parseMeasureRequest(std::string_view text);
/// What parseMeasureRequest() reads.
nlohmann::json toJson(const MeasureRequest& request);

}  // namespace scancast
