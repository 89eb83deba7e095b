#include "renderer/measure/volume.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "protocol/measure/vertices.hpp"
#include "renderer/measure/plan_raster.hpp"

namespace scancast {
namespace {

/// Neighbouring points are a spacing apart on the whole: so many spacings square hold nine on average, and hardly any cell none.
constexpr double spacingsPerCell = 3;

std::vector<glm::dvec2> inPlan(std::span<const glm::dvec3> points) {
    std::vector<glm::dvec2> flat;
    for (const glm::dvec3& p : points) flat.emplace_back(p.x, p.y);
    return flat;
}

double cellsOf(std::span<const glm::dvec2> corners, double cell) {
    const glm::dvec2 size = PlanRaster::sizeOf(corners, cell);
    return size.x * size.y;
}

/// Rows and columns that edges go through, all together: a raster one cell wide may be as long as it has cells.
constexpr double mostEdgeSteps = 5e7;

/// How many times too many cells; above 1 it is refused, or made coarser.
double excessOf(std::span<const glm::dvec2> corners, double cell, double most) {
    const glm::dvec2 size = PlanRaster::sizeOf(corners, cell);
    const double longer = (size.x + size.y) * double(corners.size()) / mostEdgeSteps;
    return std::max(size.x * size.y / most, longer > 1 ? longer * longer : 0);
}

/// The finest that stays within the limits.
double coarseEnough(std::span<const glm::dvec2> corners, double cell, double most) {
    while (excessOf(corners, cell, most) > 1)
        cell *= std::max(1.01, std::sqrt(excessOf(corners, cell, most)));
    return cell;
}

struct CellHeights {
    double sum = 0;  ///< relative to the base's middle
    std::uint32_t count = 0;
    double high = -std::numeric_limits<double>::infinity(), low = std::numeric_limits<double>::infinity();
};

class VolumeRaster {
  public:
    VolumeRaster(const Cloud& cloud, const SampleFilter& filter, const MeasureRequest& request,
                 const BasePlane& base, double cell, const VolumeLimits& limits)
        : cloud_(cloud),
          filter_(filter),
          surface_(request.surface),
          base_(base),
          heightScale_(limits.heightScale),
          raster_(inPlan(request.points), cell),
          heights_(raster_.cells()) {
        const double least = std::numeric_limits<double>::lowest();
        box_ = {glm::dvec3(request.points[0].x, request.points[0].y, least),
                glm::dvec3(request.points[0].x, request.points[0].y, -least)};
        for (const glm::dvec3& p : request.points) {
            box_.low = glm::min(box_.low, glm::dvec3(p.x, p.y, least));
            box_.high = glm::max(box_.high, glm::dvec3(p.x, p.y, -least));
        }
    }

    Expected<void> gather(const std::stop_token& stop) {
        auto all = overPoints(stop, [](CellHeights& cell, double z) {
            cell.sum += z;
            ++cell.count;
            cell.high = std::max(cell.high, z);
            cell.low = std::min(cell.low, z);
        });
        for (const CellHeights& cell : heights_) points_ += cell.count;
        if (!all || surface_ != VolumeSurface::Top) return all;
        for (CellHeights& cell : heights_) cell.sum = 0, cell.count = 0;
        // Slopes of up to 45° lie within a cell's side of its highest point; feet of walls do not.
        const double depth = raster_.cell() / heightScale_;
        return overPoints(stop, [depth](CellHeights& cell, double z) {
            if (z < cell.high - depth) return;
            cell.sum += z;
            ++cell.count;
        });
    }

    VolumeMeasure measured(double area) const {
        VolumeMeasure result;
        result.area = area;
        result.cell = raster_.cell();
        result.points = points_;
        result.base = base_;
        double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
        const double side = raster_.cell();
        for (std::size_t i = 0; i < raster_.cells(); ++i) {
            const double share = raster_.share(i);
            if (share <= 0) continue;
            ++result.cells;
            const CellHeights& cell = heights_[i];
            if (cell.count == 0) {
                ++result.holes;
                continue;
            }
            const double z = base_.height + heightOf(cell), part = share * side * side;
            lowest = std::min(lowest, z), highest = std::max(highest, z);
            const double over = (z - base_.at(raster_.middle(i))) * heightScale_;
            (over > 0 ? result.above : result.below) += part * std::abs(over);
            result.covered += part;
        }
        if (result.holes < result.cells) result.lowest = lowest, result.highest = highest;
        result.covered = std::min(result.covered, area);
        return result;
    }

  private:
    template <class Add>
    Expected<void> overPoints(const std::stop_token& stop, Add add) {
        return forLeafPoints(cloud_, filter_, box_, stop, [&](std::span<const glm::dvec3> places) {
            for (const glm::dvec3& place : places)
                if (const auto cell = raster_.cellOf({place.x, place.y}))
                    add(heights_[*cell], place.z - base_.height);
        });
    }

    double heightOf(const CellHeights& cell) const {
        switch (surface_) {
            case VolumeSurface::Highest:
                return cell.high;
            case VolumeSurface::Lowest:
                return cell.low;
            case VolumeSurface::Top:
            case VolumeSurface::Mean:
                break;
        }
        return cell.sum / cell.count;
    }

    const Cloud& cloud_;
    const SampleFilter& filter_;
    const VolumeSurface surface_;
    const BasePlane base_;
    const double heightScale_;
    PlanRaster raster_;
    MeasuredBox box_;
    std::vector<CellHeights> heights_;
    std::uint64_t points_ = 0;
};
static_assert(sizeof(CellHeights) + sizeof(float) <= bytesPerVolumeCell);

}  // namespace

Expected<BasePlane> basePlane(const MeasureRequest& request) {
    BasePlane base;
    const double count = double(request.points.size());
    double sum = 0, lowest = request.points[0].z;
    glm::dvec2 middle(0);
    for (const glm::dvec3& p : request.points) {
        middle += glm::dvec2(p.x, p.y) - glm::dvec2(request.points[0].x, request.points[0].y);
        sum += p.z - request.points[0].z;
        lowest = std::min(lowest, p.z);
    }
    base.middle = glm::dvec2(request.points[0].x, request.points[0].y) + middle / count;
    const double mean = request.points[0].z + sum / count;
    base.height = request.base == VolumeBase::Height   ? request.height
                  : request.base == VolumeBase::Lowest ? lowest
                                                       : mean;
    if (request.base != VolumeBase::Fit) return base;
    // Least squares of the heights: two normal equations about the middle.
    double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
    for (const glm::dvec3& p : request.points) {
        const double x = p.x - base.middle.x, y = p.y - base.middle.y, z = p.z - mean;
        xx += x * x, xy += x * y, yy += y * y, xz += x * z, yz += y * z;
    }
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 1e-12 * (xx + yy) * (xx + yy)))
        return fail(ErrorCode::InvalidArgument, "points: the corners lie on one line", "points");
    base.slope = {(xz * yy - yz * xy) / determinant, (yz * xx - xz * xy) / determinant};
    return base;
}

Expected<double> cellSide(const Cloud& cloud, const MeasureRequest& request, const VolumeLimits& limits) {
    const auto corners = inPlan(request.points);
    const double most = double(limits.mostCells);
    if (!request.cell) {
        const double side = cloud.spacing > 0 ? spacingsPerCell * cloud.spacing : 1;
        return coarseEnough(corners, side, most);
    }
    const double cells = cellsOf(corners, *request.cell);
    if (excessOf(corners, *request.cell, most) <= 1) return *request.cell;
    return fail(ErrorCode::InvalidArgument,
                fmt::format("cell: the raster would have {:.0f} cells along {} edges, and there is room for "
                            "{:.0f}, less where "
                            "they are in few rows; with cell={:.3g} there is",
                            cells, corners.size(), most, coarseEnough(corners, *request.cell, most) * 1.01),
                "cell");
}

Expected<VolumeMeasure> measureVolume(const Cloud& cloud, const SampleFilter& filter,
                                      const MeasureRequest& request, const VolumeLimits& limits,
                                      const std::stop_token& stop) {
    const auto corners = inPlan(request.points);
    if (const auto crossing = crossingEdges(corners))
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("points: the edges from corner {} and from corner {} meet in plan view; "
                                "a volume needs a polygon whose edges do not",
                                (*crossing)[0], (*crossing)[1]),
                    "points");
    const double area = std::abs(signedArea(corners));
    if (!(area > 0))
        return fail(ErrorCode::InvalidArgument, "points: the corners enclose no area in plan view", "points");
    const auto base = basePlane(request);
    if (!base) return passOn(base);
    const auto cell = cellSide(cloud, request, limits);
    if (!cell) return passOn(cell);
    VolumeRaster raster(cloud, filter, request, *base, *cell, limits);
    if (auto ok = raster.gather(stop); !ok) return passOn(ok);
    return raster.measured(area);
}

}  // namespace scancast
