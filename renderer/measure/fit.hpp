// Planes, circles, spheres and cylinders fitted to the scan's points near picked places (docs/measure.md). Pipeline: leaf points →
// **fit**. Any thread, which waits for blocks. Deterministic.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "protocol/measure/measure_request.hpp"
#include "renderer/measure/leaf_points.hpp"

namespace scancast {

/// More are thinned out evenly before they are fitted.
inline constexpr std::size_t mostFittedPoints = 200'000;

struct ShapeMeasure {
    MeasureKind kind = MeasureKind::Plane;
    glm::dvec3 center{
        0};  ///< file coordinates: of a plane and a cylinder, the middle of the points that were used
    glm::dvec3 axis{
        0};  ///< a plane's normal, a circle's or cylinder's axis, unit vector upwards; 0 of a sphere
    double radius = 0;         ///< 0 of a plane
    double length = 0;         ///< of a cylinder, of its points that were used, along its axis
    double arc = 0;            ///< of a circle or cylinder: degrees of it that there are points on
    double rms = 0;            ///< of the distances of the used points from the shape
    std::uint64_t points = 0;  ///< near the picked places, or picked
    std::uint64_t fitted = 0;  ///< of them, that were fitted: less where there were too many
    std::uint64_t used = 0;    ///< of those, that were taken for points of the shape
};

/// Lengths are in the unit of x and y, `heightScale` of which make one of z; so are directions.
/// Errors: forLeafPoints()'; Empty where too few points are there for the shape, or nothing that looks like it; InvalidArgument (`points`)
/// where picked points, without `within`, do not tell one.
Expected<ShapeMeasure> measureShape(const Cloud& cloud, const SampleFilter& filter,
                                    const MeasureRequest& request, double heightScale = 1,
                                    const std::stop_token& stop = {});

/// The same of points that are there. `finest`: how finely their coordinates are told apart.
Expected<ShapeMeasure> fitShape(const MeasureRequest& request, std::vector<glm::dvec3> points, double finest);

}  // namespace scancast
