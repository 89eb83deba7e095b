// Words of rasters from outside: whatever is accepted prints to words that mean the same, and comes to cells that there is room for.
#include <cmath>

#include "renderer/raster/raster_grid.hpp"
#include "tests/fuzz/require.hpp"

namespace {

constexpr std::uint64_t most = 1'000'000;

/// A box of 100 x 80, of which nothing but bounds and spacing is looked at.
const scancast::Cloud& cloud() {
    static const scancast::Cloud made = [] {
        scancast::Cloud cloud;
        cloud.bounds = {glm::dvec3(0), glm::dvec3(100, 80, 10)};
        cloud.spacing = 0.1;
        scancast::Node root{};
        root.step = glm::dvec3(1);
        root.boxMax = cloud.bounds[1];
        root.sampleCount = 1;
        cloud.octree = scancast::Octree({root}, {scancast::Sample{}});
        return cloud;
    }();
    return made;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const auto words = parseQuery({reinterpret_cast<const char*>(data), size});
    if (!words) return 0;
    for (const RasterKind kind : {RasterKind::Elevation, RasterKind::Orthophoto}) {
        const auto request = rasterRequestOf(kind, *words);
        if (!request) continue;
        const auto again = rasterRequestOf(kind, wordsOf(*request));
        require(again && wordsOf(*again) == wordsOf(*request));
        const auto grid = rasterGrid(cloud(), *request, {.mostCells = most});
        if (!grid) continue;
        require(grid->columns >= 1 && grid->rows >= 1 && grid->cells() <= most && std::isfinite(grid->left) &&
                std::isfinite(grid->bottom()) && grid->blocks() >= 1);
        for (const std::int64_t index : {std::int64_t(0), grid->blocks() - 1}) {
            const CellWindow block = grid->blockAt(index);
            require(block.columns >= 1 && block.rows >= 1 && block.column + block.columns <= grid->columns &&
                    block.row + block.rows <= grid->rows);
        }
    }
    return 0;
}
