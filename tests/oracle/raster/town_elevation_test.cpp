// Elevations of a scan of the generated town against the town itself, as rays from above meet it. Right because they know no point of the
// scan.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/raster/raster_plan.hpp"
#include "simulator/scene.hpp"
#include "tests/ground_truth/ray_caster.hpp"
#include "tests/support/sized.hpp"

namespace scancast::test {
namespace {

constexpr int rays = 5;  ///< on a cell's side

struct TrueCell {
    double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
    bool known = true;  ///< every ray meets something that has a surface: leaves have none
};

TrueCell trueCell(const RayCaster& town, double left, double top, double cell) {
    TrueCell truth;
    for (int i = 0; i < rays * rays && truth.known; ++i) {
        const glm::dvec3 from(left + (i % rays + 0.5) / rays * cell, top - (i / rays + 0.5) / rays * cell,
                              town.origin().z + 300);
        const auto hit = town.cast({from, glm::dvec3(0, 0, -1)}, 0, 600);
        truth.known = hit && (hit->classification < 3 || hit->classification > 5);
        if (!hit) break;
        truth.low = std::min(truth.low, hit->position.z);
        truth.high = std::max(truth.high, hit->position.z);
    }
    return truth;
}

struct Errors {
    std::vector<double> sizes{};
    void add(double error) { sizes.push_back(std::abs(error)); }
    /// That so large a share of the cells stay within.
    double within(double share) {
        std::ranges::sort(sizes);
        return sizes.empty() ? 0 : sizes[std::size_t(share * double(sizes.size() - 1))];
    }
};

TEST(TownElevation, IsTrueToCentimetresWhereTheTownIsFlat) {
    const SceneOptions scene{.scene = "town", .points = sized(1'500'000, 200'000)};
    const RayCaster town = RayCaster::create(scene).value();
    auto source = simulate(scene).value();
    const std::shared_ptr<const Cloud> cloud = *buildCloud(*source, BuildOptions{});
    const glm::dvec2 middle(town.origin());
    const std::string box = std::to_string(middle.x - 60) + "," + std::to_string(middle.y - 60) + "," +
                            std::to_string(middle.x + 60) + "," + std::to_string(middle.y + 60);
    const auto raster = planRaster(
        *cloud,
        *rasterRequestOf(RasterKind::Elevation, {{"bbox", box}, {"cell", "0.5"}, {"value", "highest"}}));
    ASSERT_TRUE(raster) << raster.error().message;
    const RasterGrid& grid = raster->layout.grid;
    ASSERT_EQ(grid.blocks(), 1);
    const auto cells = elevationOf(*cloud, raster->filter, grid, grid.blockAt(0), raster->elevation);
    ASSERT_TRUE(cells) << cells.error().message;
    Errors flat, sloping;
    const auto step = std::size_t(sized(1, 7));
    for (std::size_t i = 0; i < cells->size(); i += step) {
        if ((*cells)[i] == noElevation) continue;
        const double left = grid.left + double(i % std::size_t(grid.columns)) * grid.cell;
        const double top = grid.top - double(i / std::size_t(grid.columns)) * grid.cell;
        const TrueCell truth = trueCell(town, left, top, grid.cell);
        if (!truth.known || truth.high - truth.low > grid.cell) continue;
        // Beside walls and beneath crowns a cell has points of what stands there.
        const TrueCell around = trueCell(town, left - grid.cell, top + grid.cell, 3 * grid.cell);
        if (!around.known || around.high - around.low > 3 * grid.cell) continue;
        const double error = double((*cells)[i]) - truth.high;
        (around.high - around.low < 0.03 ? flat : sloping).add(error);
    }
    std::printf(
        "flat: %zu cells, half within %.2f cm, 95 %% within %.2f cm; sloping: %zu, half within %.1f cm, 95 "
        "%% within %.1f cm\n",
        flat.sizes.size(), 100 * flat.within(0.5), 100 * flat.within(0.95), sloping.sizes.size(),
        100 * sloping.within(0.5), 100 * sloping.within(0.95));
    ASSERT_GT(flat.sizes.size(), sized(2000U, 50U));
    EXPECT_LT(flat.within(0.5), 0.02);
    EXPECT_LT(flat.within(0.95), 0.06);
    ASSERT_GT(sloping.sizes.size(), sized(500U, 10U));
    EXPECT_LT(sloping.within(0.5), 0.2);
}

}  // namespace
}  // namespace scancast::test
