// Pictures cut by shapes, in every method, against the brute force of another filter: of a copy of the cloud, each sample
// that the shapes take away - by their definition, in double precision - has a class of its own, and the picture without
// that class, which knows nothing of shapes and leaves no node out, must be the same, byte for byte. What single precision
// may see on either side of a face is left out of both.
#include <gtest/gtest.h>

#include <map>

#include "renderer/method/automatic.hpp"
#include "renderer/method/method.hpp"
#include "tests/support/clouds/scene_clouds.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/random_shapes.hpp"
#include "tests/support/sized.hpp"

namespace scancast::test {
namespace {

constexpr std::uint8_t left = 1, taken = 2, unclear = 3;
constexpr std::uint64_t clipPoints = 40'000;

const Cloud& sceneOf(const std::string& scene) {
    static std::map<std::string, std::shared_ptr<const Cloud>> clouds;
    auto& cloud = clouds[scene];
    if (!cloud) cloud = sceneCloud(scene, clipPoints, 600).value();
    return *cloud;
}

struct Told {
    std::shared_ptr<Cloud> cloud;
    std::array<std::size_t, 4> samples{};  ///< by class
};

/// Every sample's class says what the shapes make of it.
Told toldByClass(const Cloud& cloud, const ClipShapes& shapes) {
    const Octree& octree = cloud.octree;
    const ClipRegions regions = clipRegions(shapes, cloud.origin);
    Told told{std::make_shared<Cloud>(cloud), {}};
    std::vector<Sample> samples(octree.sampleCount());
    std::vector<BesideWord> beside;
    for (std::uint32_t i = 0; i < octree.nodes().size(); ++i) {
        const Node& node = octree.node(i);
        const auto run = octree.run(i).value();
        if (!run.beside.empty()) beside.resize(samples.size());
        std::ranges::copy(run.beside,
                          beside.begin() + std::ptrdiff_t(run.beside.empty() ? 0 : node.firstSample));
        for (std::size_t s = 0; s < run.samples.size(); ++s) {
            Sample& sample = samples[node.firstSample + s] = run.samples[s];
            const glm::dvec3 p = position(node, sample);
            // Of a node's extent, what four roundings of single precision may come to.
            const double tolerance = 4 * 0x1p-24 * 65535 * (node.step.x + node.step.y + node.step.z);
            sample.classification = nearAFace(regions, p, tolerance)     ? unclear
                                    : contains(shapes, p + cloud.origin) ? left
                                                                         : taken;
            ++told.samples[sample.classification];
        }
    }
    told.cloud->octree =
        Octree({octree.nodes().begin(), octree.nodes().end()}, std::move(samples), std::move(beside));
    return told;
}

class Clip : public OnDevice {
  protected:
    Frame mustRender(const Cloud& cloud, const View& view) {
        auto frame = render(*device_, cloud, view);
        EXPECT_TRUE(frame) << frame.error().message;
        return frame ? std::move(*frame) : Frame{};
    }

    /// Calls work(view) for every method, in one projection or the other.
    template <class Work>
    void inEveryMethod(const Cloud& cloud, const std::string& scene, std::uint64_t number, const Work& work) {
        const auto projection = number % 2 == 0 ? Projection::Perspective : Projection::Orthographic;
        View view = sceneView(cloud, sceneViews(scene)[0], projection, 151, 103);
        for (const Method& method : methods()) {
            if (method.name == automaticName) continue;
            SCOPED_TRACE(method.name);
            view.style.method = method.name;
            work(view);
        }
    }
    std::uint64_t scenes() const { return slow_ ? 1 : sized(12, 4); }
};
SCANCAST_ON_DEVICES(Clip, "egl");

TEST_P(Clip, IsWhatShapesLeaveByBruteForce) {
    std::uint64_t clippedNodes = 0, drawn = 0, all = 0;
    for (std::uint64_t number = 0, compared = 0; compared < scenes(); ++number) {
        const std::string scene = number % 3 == 2 ? "statue" : "town";
        const Cloud& cloud = sceneOf(scene);
        const glm::dvec3 extent = cloud.bounds[1] - cloud.bounds[0];
        const ClipShapes shapes = randomShapes(number + 3, (cloud.bounds[0] + cloud.bounds[1]) * 0.5,
                                               0.5 * std::max(extent.x, extent.y));
        const Told told = toldByClass(cloud, shapes);
        const std::size_t few = cloud.octree.sampleCount() / 10;
        if (told.samples[left] < few || told.samples[taken] < few) continue;
        ++compared;
        SCOPED_TRACE("shapes of " + std::to_string(number) + ", " + std::to_string(told.samples[left]) +
                     " left");
        EXPECT_LT(told.samples[unclear], clipPoints / 1000);
        inEveryMethod(cloud, scene, number, [&](View view) {
            view.style.color = ColorSource::Elevation;
            view.quality.detail = 1.5;
            View byClass = view;
            byClass.style.classes = std::vector<std::uint8_t>{left};
            view.style.classes = std::vector<std::uint8_t>{left, taken};
            view.style.clips = shapes;
            const Frame cut = mustRender(*told.cloud, view), brute = mustRender(*told.cloud, byClass);
            EXPECT_TRUE(cut.rgba == brute.rgba && cut.depth == brute.depth);
            EXPECT_EQ(brute.stats.nodesClipped, 0u);
            EXPECT_LE(cut.stats.samplesDrawn, brute.stats.samplesDrawn);
            clippedNodes += cut.stats.nodesClipped;
            drawn += cut.stats.samplesDrawn;
            all += brute.stats.samplesDrawn;
        });
    }
    EXPECT_GT(clippedNodes, 0u) << "what is cut away as a whole is not visited further";
    EXPECT_LT(drawn, all) << "nor are its samples drawn";
    EXPECT_GT(drawn, 0u);
}

// Right because the glass shows the cloud's own points: what is taken away is in no mirror either, and casts no shadow.
TEST_P(Clip, ReflectionsAndShadowsAreCutToo) {
    const std::string scene = "room";
    const Cloud& cloud = sceneOf(scene);
    if (cloud.mirrors.empty()) GTEST_FAIL() << "the scene has no mirror";
    const glm::dvec3 middle = (cloud.bounds[0] + cloud.bounds[1]) * 0.5;
    const ClipShapes shapes{HalfSpace{middle, {0.3, 0.2, -1}},
                            TurnedBox{middle, {1, 1, 1}, {30, 10, 0}, true}};
    const Told told = toldByClass(cloud, shapes);
    View view = sceneView(cloud, sceneViews(scene)[0], Projection::Perspective, 151, 103);
    view.style.method = "paraboloid";
    view.style.light.sun = {{140, 35}};
    view.style.light.shadow = 0.8;
    View byClass = view;
    byClass.style.classes = std::vector<std::uint8_t>{left};
    view.style.classes = std::vector<std::uint8_t>{left, taken};
    view.style.clips = shapes;
    const Frame cut = mustRender(*told.cloud, view);
    EXPECT_TRUE(cut.rgba == mustRender(*told.cloud, byClass).rgba);
    EXPECT_GE(cut.stats.mirrorsDrawn, 1u);
    byClass.style.classes.reset();
    EXPECT_FALSE(cut.rgba == mustRender(*told.cloud, byClass).rgba);
}

constexpr std::uint64_t side = 40;  ///< points along either axis

/// Every quarter of a unit at coordinates of a map, seen from above each in pixels of its own; heights in five steps.
ScanPoint onSteps(std::uint64_t i, std::uint64_t) {
    const std::uint64_t x = i % side, y = i / side;
    ScanPoint p;
    p.position = {444000 + 0.25 * double(x), 5411000.1 + 0.25 * double(y),
                  100.1 + 0.25 * double((x + y) % 5)};
    return p;
}

// Right because it is counted in whole numbers which points lie in a box, faces included.
TEST_P(Clip, WhatLiesOnALevelFaceIsInside) {
    SyntheticSource source(side * side, onSteps, {.color = true}, 0.05);
    const auto cloud = buildCloud(source, {.title = "steps", .shape = {.leafPoints = 300}}).value();
    View view = defaultView(*cloud, 200, 200);
    view.style.method = "point";
    view.style.outliers = Outliers::Show;
    view.quality.samples = 1;
    view.quality.detail = 0;
    view.camera = {};
    view.camera.projection = Projection::Orthographic;
    view.camera.eye = {444005, 5411005.1, 200};
    view.camera.target = {444005, 5411005.1, 100};
    view.camera.up = {0, 1, 0};
    view.camera.viewHeight = 12;
    // A quarter of a turn: 2.5 along X, 5 along Y, from 100.35 to 100.85.
    const TurnedBox inside{{444005, 5411005.1, 100.6}, {5, 2.5, 0.5}, {90, 0, 0}};
    TurnedBox outside = inside;
    outside.outside = true;
    const auto inBox = [](std::uint64_t x, std::uint64_t y) {
        const std::uint64_t z = (x + y) % 5;
        return x >= 15 && x <= 25 && y >= 10 && y <= 30 && z >= 1 && z <= 3;
    };
    std::int64_t expected = 0;
    for (std::uint64_t i = 0; i < side * side; ++i) expected += inBox(i % side, i / side);
    const auto pixelsOf = [&](const ClipShapes& shapes) {
        view.style.clips = shapes;
        const Frame frame = mustRender(*cloud, view);
        return std::ranges::count_if(frame.depth, [](float d) { return std::isfinite(d); });
    };
    EXPECT_EQ(pixelsOf({}), std::int64_t(side * side));
    EXPECT_EQ(pixelsOf({inside}), expected);
    EXPECT_EQ(pixelsOf({outside}), std::int64_t(side * side) - expected);
    EXPECT_EQ(pixelsOf({HalfSpace{{0, 0, 100.6}, {0, 0, 1}}, HalfSpace{{0, 0, 100.6}, {0, 0, -1}}}),
              std::int64_t(side * side / 5))
        << "two planes that face each other leave the one between them";
    EXPECT_EQ(pixelsOf({inside, outside}), 0) << "what is inside of one and outside of the same";
}

}  // namespace
}  // namespace scancast::test
