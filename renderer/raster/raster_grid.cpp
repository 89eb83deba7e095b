#include "renderer/raster/raster_grid.hpp"

#include <fmt/format.h>

#include "protocol/text/grouped.hpp"
#include "renderer/cloud/import/crs_units.hpp"

namespace scancast {
namespace {

/// TIFF's numbers of rows and columns have 32 bits; nobody has a raster of nearly so many.
constexpr double mostSide = 1e9;

/// The next of …, 1, 2, 5, 10, 20 … from there on.
double roundSide(double side) {
    const double power = std::pow(10.0, std::floor(std::log10(side)));
    for (const double step : {1.0, 2.0, 5.0})
        if (side <= step * power * (1 + 1e-9)) return step * power;
    return 10 * power;
}

struct Extent {
    glm::dvec2 low{0}, high{0};
};

/// Whole cells around a cloud, at multiples of their side, so that rasters of neighbours fit together; what lies on their last edge is in,
/// too.
RasterGrid aroundAll(const Extent& extent, double cell) {
    RasterGrid grid;
    grid.cell = cell;
    grid.left = std::floor(extent.low.x / cell) * cell;
    grid.top = std::ceil(extent.high.y / cell) * cell;
    // A multiple may come out a rounding beyond the edge itself.
    if (grid.columnOf(extent.low.x) < 0) grid.left = (std::floor(extent.low.x / cell) - 1) * cell;
    if (grid.rowOf(extent.high.y) < 0) grid.top = (std::ceil(extent.high.y / cell) + 1) * cell;
    const auto last = [](double index) {
        return index >= 0 && index < mostSide * 2 ? std::int64_t(index) : std::int64_t(mostSide * 2);
    };
    grid.columns = last(grid.columnOf(extent.high.x)) + 1;
    grid.rows = last(grid.rowOf(extent.low.y)) + 1;
    return grid;
}

RasterGrid ofBounds(const std::array<double, 4>& bbox, double cell) {
    const auto count = [&](double length) {
        return std::int64_t(std::clamp(std::ceil(length / cell - 1e-6), 1.0, mostSide * 2));
    };
    RasterGrid grid;
    grid.cell = cell;
    grid.left = bbox[0];
    grid.top = bbox[3];
    grid.columns = count(bbox[2] - bbox[0]);
    grid.rows = count(bbox[3] - bbox[1]);
    return grid;
}

RasterGrid gridWith(const Extent& extent, const RasterRequest& request, double cell) {
    RasterGrid grid = request.bbox ? ofBounds(*request.bbox, cell) : aroundAll(extent, cell);
    grid.tile = request.tile;
    return grid;
}

/// A raster of one row is as long as it has cells, and its tiles are as high as wide: what fills them counts, too.
bool fits(const RasterGrid& grid, std::uint64_t most) {
    if (double(grid.columns) > mostSide || double(grid.rows) > mostSide) return false;
    const double tile = double(grid.tile) * grid.tile,
                 tiles = double(grid.tileColumns()) * double(grid.tileRows());
    return double(grid.columns) * double(grid.rows) <= double(most) &&
           tiles * tile <= 2 * double(most) + 16 * tile;
}

/// The finest that fits; what no number of steps makes fit is as it comes out.
double coarseEnough(const Extent& extent, const RasterRequest& request, double cell, std::uint64_t most) {
    for (int step = 0; step < 400 && std::isfinite(cell) && !fits(gridWith(extent, request, cell), most);
         ++step)
        cell = roundSide(cell * 1.01);
    return cell;
}

double automaticSide(const Cloud& cloud, const RasterRequest& request) {
    const double times = request.kind == RasterKind::Elevation ? spacingsPerElevationCell : spacingsPerPixel;
    return cloud.spacing > 0 && std::isfinite(cloud.spacing) ? roundSide(times * cloud.spacing) : 1;
}

}  // namespace

CellWindow RasterGrid::blockAt(std::int64_t index) const {
    CellWindow window{index % blockColumns() * block, index / blockColumns() * block, block, block};
    window.columns = std::min(window.columns, columns - window.column);
    window.rows = std::min(window.rows, rows - window.row);
    return window;
}

CellWindow RasterGrid::grown(const CellWindow& window, std::int64_t by) const {
    CellWindow all;
    all.column = std::max<std::int64_t>(0, window.column - by);
    all.row = std::max<std::int64_t>(0, window.row - by);
    all.columns = std::min(columns, window.column + window.columns + by) - all.column;
    all.rows = std::min(rows, window.row + window.rows + by) - all.row;
    return all;
}

Expected<RasterGrid> rasterGrid(const Cloud& cloud, const RasterRequest& request,
                                const RasterLimits& limits) {
    if (cloud.octree.nodes().empty()) return fail(ErrorCode::Empty, "This cloud has no points.");
    if (crsUnits(cloud.crsWkt, cloud.crsEpsg).kind == CrsUnits::Kind::Geocentric)
        return fail(
            ErrorCode::Unsupported,
            "The coordinates of this cloud count from the middle of the earth, so that z is not up; bring "
            "the scan into a projected system, such as its UTM zone, and make rasters of that.");
    const Extent extent{{cloud.bounds[0].x, cloud.bounds[0].y}, {cloud.bounds[1].x, cloud.bounds[1].y}};
    if (const auto& box = request.bbox; box && ((*box)[0] > extent.high.x || (*box)[2] < extent.low.x ||
                                                (*box)[1] > extent.high.y || (*box)[3] < extent.low.y))
        return fail(
            ErrorCode::InvalidArgument,
            fmt::format(
                "bbox: lies beside the cloud, whose x are {:.12g} to {:.12g} and y {:.12g} to {:.12g}",
                extent.low.x, extent.high.x, extent.low.y, extent.high.y),
            "bbox");
    const double wanted = request.cell.value_or(automaticSide(cloud, request));
    const std::uint64_t most = limits.mostCells;
    const double cell =
        request.cell ? wanted : coarseEnough(extent, request, wanted, std::min(most, mostAutomaticCells));
    RasterGrid grid = gridWith(extent, request, cell);
    if (!fits(grid, most))
        return fail(
            ErrorCode::InvalidArgument,
            fmt::format(
                "cell: with cells of {:.6g} the raster has {:.0f} x {:.0f}, and there is room for {} cells; "
                "with cell={:.6g} they fit, or with a smaller bbox",
                cell, double(grid.columns), double(grid.rows), grouped(most),
                coarseEnough(extent, request, cell, most)),
            "cell");
    // Neighbouring cells must have different places.
    const double farthest =
        std::max({std::abs(grid.left), std::abs(grid.top), std::abs(grid.right()), std::abs(grid.bottom())});
    if (!std::isfinite(farthest) || farthest + cell / 8 == farthest)
        return fail(
            ErrorCode::InvalidArgument,
            fmt::format("cell: {:.6g} is less than coordinates of {:.6g} can tell apart", cell, farthest),
            "cell");
    return grid;
}

}  // namespace scancast
