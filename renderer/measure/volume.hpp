// Volume between the scan's surface and a base, over a polygon in plan view (docs/measure.md). Out of core: a raster is all that is
// kept. Pipeline: leaf points → raster → **volume**. Any thread, which waits for blocks. Deterministic.
//
// The surface has one height in each cell of a raster, out of the points that lie in the cell and in the polygon. A cell without any is
// a hole: its area is counted apart and adds nothing, for nobody knows what is there.
#pragma once

#include <cstdint>
#include <stop_token>

#include "protocol/measure/measure_request.hpp"
#include "renderer/measure/leaf_points.hpp"

namespace scancast {

struct VolumeLimits {
    std::uint64_t mostCells = 2'000'000;  ///< of the raster
    double heightScale = 1;               ///< units of x and y that one of z is
};
inline constexpr std::uint64_t bytesPerVolumeCell = 40;

/// Heights of the base: height + slope · (place - middle).
struct BasePlane {
    glm::dvec2 middle{0}, slope{0};
    double height = 0;
    double at(const glm::dvec2& place) const {
        return height + slope.x * (place.x - middle.x) + slope.y * (place.y - middle.y);
    }
};

struct VolumeMeasure {
    double above = 0, below = 0;     ///< cubes of the unit of x and y; ≥ 0
    double area = 0;                 ///< of the polygon
    double covered = 0;              ///< of it, where there are points
    double cell = 0;                 ///< side of a cell
    std::uint64_t cells = 0;         ///< that have a part in the polygon
    std::uint64_t holes = 0;         ///< of them, without a point
    std::uint64_t points = 0;        ///< that lie in the polygon
    double lowest = 0, highest = 0;  ///< of the cells' heights, unit of z; 0 where there are none
    BasePlane base;
};

/// The base of a request for a volume. InvalidArgument (`points`) where the corners are on a line.
Expected<BasePlane> basePlane(const MeasureRequest& request);

/// The side of the raster's cells: the request's, or three times the scan's spacing, or what the limit leaves. InvalidArgument (`cell`)
/// for one that asks for too many, with one that does not.
Expected<double> cellSide(const Cloud& cloud, const MeasureRequest& request, const VolumeLimits& limits);

/// Errors: those of basePlane(), cellSide() and forLeafPoints(); InvalidArgument (`points`) for edges that cross each other, or corners that
/// enclose nothing.
Expected<VolumeMeasure> measureVolume(const Cloud& cloud, const SampleFilter& filter,
                                      const MeasureRequest& request, const VolumeLimits& limits = {},
                                      const std::stop_token& stop = {});

}  // namespace scancast
