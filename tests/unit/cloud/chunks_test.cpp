// Building out of core: counting, dividing, setting aside - and that none of it shows in the result.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/build/chunks/chunk_layout.hpp"
#include "renderer/cloud/build/chunks/ordered_cells.hpp"
#include "renderer/cloud/build/workspace.hpp"
#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/surfel_codec.hpp"
#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast {
namespace {

using test::ScanPoint;
using test::SyntheticSource;
using test::uniform;

std::vector<BuildPoint> randomPoints(std::size_t n, std::uint64_t range) {
    std::vector<BuildPoint> points(n);
    for (std::size_t i = 0; i < n; ++i)
        points[i].setPosition({std::uint64_t(uniform(i, 1) * double(range)),
                               std::uint64_t(uniform(i, 2) * double(range)),
                               std::uint64_t(uniform(i, 3) * uniform(i, 4) * 1000)});
    return points;
}

GridBox boxOf(std::span<const BuildPoint> points) {
    GridBox box;
    for (const BuildPoint& p : points) box.add(p.position());
    return box;
}

// Right because a map counts the same cells without hashing, halves or joins.
TEST(CountingGrid, CountsAsAMapDoes) {
    const auto points = randomPoints(50'000, std::uint64_t(1) << 33);
    const GridBox box = boxOf(points);
    CountingGrid whole(box), half(box), other(box);
    whole.add(points);
    half.add(std::span(points).first(20'000));
    other.add(std::span(points).subspan(20'000));
    half.join(other);
    std::map<CellKey, std::uint64_t> expected;
    for (const BuildPoint& p : points) ++expected[whole.frame().key(p.position())];
    for (const CountingGrid* grid : {&whole, &half}) {
        const auto cells = grid->cells();
        EXPECT_EQ(grid->frame().cellLevel, whole.frame().cellLevel);
        ASSERT_EQ(cells.size(), expected.size());
        for (const CountedCell& c : cells) ASSERT_EQ(c.points, expected[c.key]);
    }
}

OrderedCells listOf(const CountingGrid& grid) {
    return {.frame = grid.frame(), .cells = grid.cells()};
}

void expectSameCells(const OrderedCells& a, const OrderedCells& b) {
    EXPECT_EQ(a.frame.cellLevel, b.frame.cellLevel);
    EXPECT_EQ(a.frame.first, b.frame.first);
    ASSERT_EQ(a.cells.size(), b.cells.size());
    for (std::size_t i = 0; i < a.cells.size(); ++i)
        ASSERT_TRUE(a.cells[i].key == b.cells[i].key && a.cells[i].points == b.cells[i].points) << i;
}

// Right because a grid that counted all points itself has put nothing together.
TEST(OrderedCells, JoinedListsAreTheGridOfAll) {
    const auto points = randomPoints(5'000, std::uint64_t(1) << 33);
    const GridBox box = boxOf(points);
    CountingGrid own(box), other(box), whole(box);
    own.add(std::span(points).first(3'000));
    other.add(std::span(points).subspan(3'000));
    whole.add(points);
    expectSameCells(joined(listOf(own), listOf(other), box), listOf(whole));
    const OrderedCells nothing{.frame = frameOf(box, own.frame().cellLevel), .cells = {}};
    expectSameCells(joined(nothing, listOf(whole), box), listOf(whole));
    // One of them coarser than the other.
    const int coarser = own.frame().cellLevel + 3;
    whole.coarsenTo(coarser);
    expectSameCells(joined(listOf(own), coarsened(listOf(other), box, coarser), box), listOf(whole));
}

// A cube full of points has more cells than may be counted: the grid coarsens, to the same cellLevel from any
// order.
TEST(CountingGrid, TheRungDependsOnTheSetAlone) {
    std::vector<BuildPoint> points(1'500'000);
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i].setPosition({std::uint64_t(uniform(i, 1) * 1e6), std::uint64_t(uniform(i, 2) * 1e6),
                               std::uint64_t(uniform(i, 3) * 1e6)});
    const GridBox box = boxOf(points);
    CountingGrid forward(box), backward(box);
    forward.add(points);
    std::reverse(points.begin(), points.end());
    backward.add(std::span(points).first(700'000));
    CountingGrid rest(box);
    rest.add(std::span(points).subspan(700'000));
    backward.join(rest);
    EXPECT_LE(forward.cells().size(), CountingGrid::mostCells);
    expectSameCells(listOf(forward), listOf(backward));
    CountingGrid first(box);
    first.add(std::span(points).first(700'000));
    expectSameCells(joined(listOf(first), listOf(rest), box), listOf(forward));
}

TEST(ChunkLayout, EveryCellGoesToOneChunkAndHalosAreWhatLiesAround) {
    const auto points = randomPoints(40'000, 100'000);
    CountingGrid counts(boxOf(points));
    counts.add(points);
    const auto cells = counts.cells();
    Grid grid;
    const ChunkLayout layout = layOutChunks(counts.frame(), cells, grid, 5000, true);
    ASSERT_GT(layout.chunks.size(), 5u);
    std::vector<std::uint64_t> own(layout.chunks.size()), halo(layout.chunks.size());
    for (const CountedCell& c : cells) {
        const auto& to = layout.destination(c.key);
        own[to.chunk] += c.points;
        std::set<std::uint32_t> seen{to.chunk};
        for (std::uint32_t h = to.firstHalo; h < to.firstHalo + to.halos; ++h) {
            EXPECT_TRUE(seen.insert(layout.haloChunks[h]).second) << "its own chunk, or twice";
            halo[layout.haloChunks[h]] += c.points;
        }
    }
    for (std::size_t i = 0; i < layout.chunks.size(); ++i) {
        EXPECT_EQ(own[i], layout.chunks[i].points);
        EXPECT_LE(own[i], 5000u);
        EXPECT_EQ(halo[i], layout.chunks[i].halo);
    }
    // Brute force: cells that touch, at a distance of one, are in each other's halo.
    std::map<CellKey, std::uint32_t> chunkOf;
    for (const CountedCell& c : cells) chunkOf[c.key] = layout.destination(c.key).chunk;
    for (std::size_t i = 0; i < cells.size(); i += 7)
        for (int dx = -1; dx <= 1; ++dx)
            for (int dy = -1; dy <= 1; ++dy) {
                const auto x = std::int64_t(cellAxis(cells[i].key, 0)) + dx,
                           y = std::int64_t(cellAxis(cells[i].key, 1)) + dy;
                if (x < 0 || y < 0) continue;
                const auto near = chunkOf.find(CellKey(x) | CellKey(y) << 21 | (cells[i].key >> 42) << 42);
                const auto& to = layout.destination(cells[i].key);
                if (near == chunkOf.end() || near->second == to.chunk) continue;
                const auto first = layout.haloChunks.begin() + to.firstHalo;
                EXPECT_NE(std::find(first, first + to.halos, near->second), first + to.halos);
            }
}

TEST(Workspace, WhatDoesNotFitInMemoryWaitsOnTheDisk) {
    Workspace workspace(10'000, std::filesystem::temp_directory_path());
    std::vector<Workspace::Buffer> buffers;
    for (int i = 0; i < 5; ++i) {
        auto buffer = workspace.allocate(4000);
        ASSERT_TRUE(buffer) << buffer.error().message;
        EXPECT_EQ(buffer->memory() != nullptr, i < 2);
        ASSERT_TRUE(buffer->write(0, std::vector<std::byte>(4000, std::byte(i))));
        ASSERT_TRUE(buffer->write(17, std::vector<std::byte>(3, std::byte(100 + i))));
        buffers.push_back(std::move(*buffer));
    }
    EXPECT_EQ(workspace.mostOnDisk(), 12'000u);
    for (int i = 0; i < 5; ++i) {
        std::vector<std::byte> space;
        const auto bytes = buffers[std::size_t(i)].view(space);
        ASSERT_TRUE(bytes);
        EXPECT_EQ((*bytes)[16], std::byte(i));
        EXPECT_EQ((*bytes)[17], std::byte(100 + i));
        EXPECT_EQ((*bytes)[3999], std::byte(i));
    }
    buffers.clear();
    EXPECT_NE(workspace.allocate(8192)->memory(), nullptr);  // room was given back, two pages of it
}

TEST(Workspace, WhatOthersOccupyIsNotLeftForBuffers) {
    Workspace workspace(20'000, std::filesystem::temp_directory_path());
    const auto one = workspace.allocate(1);
    EXPECT_NE(one->memory(), nullptr);
    workspace.occupy(8000);
    EXPECT_EQ(workspace.allocate(8000)->memory(), nullptr) << "one byte takes a page: 7904 are left";
    EXPECT_NE(workspace.allocate(4096)->memory(), nullptr);
    workspace.occupy(100'000);
    EXPECT_EQ(workspace.allocate(1)->memory(), nullptr);
    const auto none = workspace.allocate(0);
    ASSERT_TRUE(none);
    std::vector<std::byte> space;
    EXPECT_TRUE(none->view(space)->empty());
}

TEST(Workspace, AFolderThatIsNotThereIsAnError) {
    Workspace workspace(0, "/nowhere/at/all");
    const auto buffer = workspace.allocate(1);
    ASSERT_FALSE(buffer);
    EXPECT_NE(buffer.error().message.find("/nowhere/at/all"), std::string::npos);
}

std::shared_ptr<const Cloud> buildInChunks(PointSource& source, std::uint32_t chunkPoints, int threads = 0,
                                           bool surfels = false) {
    auto cloud =
        buildCloud(source, {.title = "test",
                            .threads = threads,
                            .shape = {.leafPoints = 256, .chunkPoints = chunkPoints, .surfels = surfels}});
    EXPECT_TRUE(cloud) << cloud.error().message;
    return cloud ? *cloud : nullptr;
}

TEST(Chunks, AnOctreeOfManyChunksIsSound) {
    SyntheticSource source(60'000, test::ground, {.color = true}, 0.001);
    const auto cloud = buildInChunks(source, 4000);
    ASSERT_TRUE(cloud);
    test::checkStructure(*cloud, 256);
    test::checkBounds(cloud->octree);
    std::vector<glm::dvec3> input;
    SyntheticSource again(60'000, test::ground, {.color = true}, 0.001);
    PointBatch batch;
    while (*again.read(batch)) input.insert(input.end(), batch.position.begin(), batch.position.end());
    test::checkEachPointOnce(*cloud, input);
}

TEST(Chunks, NeitherThreadsNorOrderShow) {
    const auto revision = [](std::uint64_t step, int threads, bool surfels) {
        SyntheticSource source(
            30'000, [=](auto i, auto n) { return test::ground(i * step % n, n); }, {.color = true}, 0.001);
        return buildInChunks(source, 3000, threads, surfels)->revision;
    };
    for (const bool surfels : {false, true}) {
        const std::string expected = revision(1, 1, surfels);
        EXPECT_EQ(revision(1, 2, surfels), expected);
        EXPECT_EQ(revision(7919, 2, surfels), expected);  // coprime: every point once, in another order
    }
}

// A far outlier squeezes everything else into one cell of the counting grid: it is divided again.
TEST(Chunks, ACrowdInOneCellIsDividedAgain) {
    const auto make = [](std::uint64_t i, std::uint64_t n) {
        ScanPoint p = test::ground(i, n);
        if (i == 5) p.position = {1e7, 1e7, 1e5};
        return p;
    };
    SyntheticSource source(20'000, make, {.color = true}, 0.001);
    const auto cloud = buildInChunks(source, 2000);
    ASSERT_TRUE(cloud);
    test::checkStructure(*cloud, 256);
    test::checkBounds(cloud->octree);
}

TEST(Chunks, ManyPointsAtOnePlaceAreOneChunk) {
    SyntheticSource source(
        9000,
        [](auto i, auto) {
            return ScanPoint{.position = {i < 8000 ? 1.0 : 2.0 + 0.01 * double(i), 0, 0}};
        },
        {}, 0.001);
    const auto cloud = buildInChunks(source, 500);
    ASSERT_TRUE(cloud);
    test::checkStructure(*cloud, 256);
}

// Right because chunks only decide where the top splits: what is below covers the same points with as many
// leaves, give or take, and all levels close the surface as they do in one chunk.
TEST(Chunks, SurfelsDoNotSeeWhereChunksMeet) {
    const auto radii = [](std::uint32_t chunkPoints) {
        SyntheticSource source(
            40'000,
            [](auto i, auto) {
                return ScanPoint{.position = {double(i % 200), double(i / 200), 0}};
            },
            {}, 0.001);
        const auto cloud = buildInChunks(source, chunkPoints, 0, true);
        std::map<std::pair<int, int>, float> found;
        for (const Node& n : cloud->octree.nodes()) {
            if (!n.isLeaf()) continue;
            for (const Sample& s : test::samples(cloud->octree, n)) {
                const glm::dvec3 p = position(n, s) + cloud->origin;
                found[{int(std::lround(p.x)), int(std::lround(p.y))}] = decodeSurfel(s, n.radiusUnit).radius;
            }
        }
        return found;
    };
    const auto one = radii(100'000), many = radii(3000);
    ASSERT_EQ(one.size(), 40'000u);
    ASSERT_EQ(many.size(), 40'000u);
    for (const auto& [at, radius] : one)
        ASSERT_NEAR(many.at(at), radius, 0.03 * radius) << at.first << ' ' << at.second;
}

}  // namespace
}  // namespace scancast
