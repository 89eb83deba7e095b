#include "renderer/raster/raster_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <glm/common.hpp>

#include "protocol/json_text.hpp"
#include "protocol/view/view_json.hpp"
#include "protocol/view/view_words.hpp"
#include "renderer/style.hpp"

namespace scancast {
namespace {

/// A block has so many cells on a side: what it takes is little, and leaves along its edges are few of those within.
constexpr int elevationBlock = 1024;

/// Smaller where a block has very many points: whoever waits for it, or wants it stopped, waits for no more than that.
constexpr double mostBlockPoints = 2e7;

int blockSide(const Cloud& cloud, const RasterGrid& grid) {
    const glm::dvec2 size = glm::max(glm::dvec2(cloud.bounds[1] - cloud.bounds[0]), glm::dvec2(grid.cell));
    for (int block = elevationBlock; block > grid.tile; block /= 2) {
        const double area = double(block) * block * grid.cell * grid.cell;
        if (double(cloud.points) * std::min(1.0, area / (size.x * size.y)) <= mostBlockPoints) return block;
    }
    return grid.tile;
}

/// What a file says of the cloud beside its cells.
std::string factsOf(const CloudFacts& cloud) {
    return printJson({{"title", cloud.title},
                      {"attribution", cloud.attribution},
                      {"recorded", cloud.recorded},
                      {"crs", cloud.crsWkt},
                      {"epsg", cloud.crsEpsg.value_or(0)}});
}

std::string identityOf(const RasterLayout& layout, const RasterRequest& request, const View& view) {
    const RasterGrid& grid = layout.grid;
    return fmt::format("{} {} {} {} {} {} {} {} {}\n{}", int(request.kind), grid.left, grid.top, grid.cell,
                       grid.columns, grid.rows, grid.tile, name(request.packing), grid.block,
                       printJson(toJson(view)));
}

}  // namespace

Expected<PlannedRaster> planRaster(const Cloud& cloud, const RasterRequest& request,
                                   const RasterLimits& limits) {
    auto grid = rasterGrid(cloud, request, limits);
    if (!grid) return passOn(grid);
    PlannedRaster raster;
    RasterLayout& layout = raster.layout;
    layout.grid = *grid;
    layout.packing = request.packing;
    layout.title = cloud.title;
    layout.attribution = cloud.attribution;
    layout.recorded = cloud.recorded;
    if (request.kind == RasterKind::Orthophoto) {
        auto ortho = orthoViews(cloud, *grid, request.view, limits.largestPicture);
        if (!ortho) return passOn(ortho);
        layout.kind = CellKind::Color;
        layout.grid = ortho->grid;
        raster.identity =
            factsOf(cloud) + identityOf(layout, request, orthoView(cloud, *ortho, layout.grid.blockAt(0)));
        raster.ortho = std::move(*ortho);
        return raster;
    }
    const auto view = applyWords(defaultView(cloud), request.view);
    if (!view) return passOn(view);
    const auto planned = plan(cloud, *view);
    if (!planned) return passOn(planned);
    raster.filter = sampleFilter(cloud, (*planned)->view.style);
    if ((*planned)->pictured) {
        auto pictured = std::make_shared<Cloud>(cloud);
        pictured->octree = *(*planned)->pictured;
        raster.pictured = std::move(pictured);
    }
    raster.elevation.value = request.value;
    raster.elevation.fill = request.fill;
    layout.grid.block = blockSide(cloud, *grid);
    layout.kind = request.value == CellValue::Count ? CellKind::Count : CellKind::Elevation;
    layout.value = name(request.value);
    layout.unit = heightUnit(cloud);
    raster.identity = factsOf(cloud) + fmt::format("{} {}\n", name(request.value), request.fill) +
                      identityOf(layout, request, *view);
    return raster;
}

Expected<std::unique_ptr<RasterTiff>> openTiff(const Cloud& cloud, const PlannedRaster& raster,
                                               const RasterScratch& scratch) {
    RasterLayout layout = raster.layout;
    layout.keys = geoKeys(cloud);
    return RasterTiff::create(std::move(layout), scratch);
}

Expected<std::vector<std::byte>> elevationCells(const Cloud& cloud, const PlannedRaster& raster,
                                                const CellWindow& block, const std::stop_token& stop) {
    const auto heights = elevationOf(raster.pictured ? *raster.pictured : cloud, raster.filter,
                                     raster.layout.grid, block, raster.elevation, stop);
    if (!heights) return passOn(heights);
    std::vector<std::byte> cells(heights->size() * sizeof(float));
    if (!cells.empty()) std::memcpy(cells.data(), heights->data(), cells.size());
    return cells;
}

}  // namespace scancast
