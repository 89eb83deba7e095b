// Picks against what is known otherwise: the pixel that a point was drawn into, and brute force over all
// points.
#include "renderer/pick/pick.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <set>
#include <tuple>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/render.hpp"
#include "renderer/select/viewpoint.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast::test {
namespace {

const glm::dvec3 corner(389400, 5819700, 34);

/// Rolling ground in UTM coordinates to the centimetre, in three classes: stripes of 20 units.
std::shared_ptr<Cloud> town(std::uint64_t points = 60000) {
    SyntheticSource source(
        points,
        [](std::uint64_t i, std::uint64_t n) {
            ScanPoint p = ground(i, n);
            p.classification = std::uint8_t(std::uint64_t(p.position.x / 20) % 3);
            p.intensity = std::uint16_t(i % 1000);
            p.position += corner;
            return p;
        },
        {true, true, true, false}, 0.01);
    BuildOptions options;
    options.title = "town";
    options.shape.leafPoints = 2000;
    return std::make_shared<Cloud>(**buildCloud(source, options));
}

View viewOf(const Cloud& cloud) {
    View view = defaultView(cloud, 320, 200);
    view.style.method = "point";
    view.quality.samples = 1;
    view.quality.detail = 0;
    return view;
}

Frame drawn(const Cloud& cloud, const View& view) {
    DeviceOptions options;
    options.backend = "cpu";
    const auto device = createDevice(options);
    auto frame = render(**device, cloud, view);
    EXPECT_TRUE(frame) << frame.error().message;
    return std::move(*frame);
}

double depthAt(const Frame& frame, int x, int y) {
    return frame.depth[std::size_t(y) * std::size_t(frame.width) + std::size_t(x)];
}

/// Calls `use(x, y, depth)` for pixels all over the picture that show something.
template <class Use>
int overSurface(const Frame& frame, Use use) {
    int count = 0;
    for (int y = 3; y < frame.height; y += 7) {
        for (int x = 2; x < frame.width; x += 11) {
            if (!std::isfinite(depthAt(frame, x, y))) continue;
            use(x, y, depthAt(frame, x, y));
            ++count;
        }
    }
    return count;
}

// Drawn to the leaves, one pixel a point: the picture itself says which point is in a pixel - one that
// projects into it, at the depth that it has there. Nothing of the pick's own search is used to check that.
TEST(Pick, FindsAPointOfThatPixelAndDepth) {
    const auto cloud = town();
    for (const Projection projection : {Projection::Perspective, Projection::Orthographic}) {
        View view = viewOf(*cloud);
        view.camera.projection = projection;
        view.camera.viewHeight = 150;
        const Frame frame = drawn(*cloud, view);
        const auto viewpoint = Viewpoint::create(view, cloud->origin, cloud->bounds);
        const int count = overSurface(frame, [&](int x, int y, double depth) {
            const auto picked = pick(*cloud, view, {x, y}, depth);
            ASSERT_TRUE(picked && *picked);
            const glm::dvec3 relative = (*picked)->point.position - cloud->origin;
            const glm::dvec3 seen =
                viewpoint->project(glm::dvec3(viewpoint->cloudToView * glm::dvec4(relative, 1)));
            const double pixel = 1 / viewpoint->q(depth);
            EXPECT_LE((*picked)->distance, pixel * 0.71 + 1e-5 * depth) << "as far as a pixel's corner";
            EXPECT_NEAR(seen.z, depth, pixel);
            EXPECT_NEAR(seen.x, x + 0.5, 1.5);
            EXPECT_NEAR(seen.y, y + 0.5, 1.5);
        });
        EXPECT_GT(count, 100);
    }
}

/// All points of the leaves that the test lets through: the obvious way.
template <class Allowed>
double nearestByHand(const Cloud& cloud, const glm::dvec3& place, Allowed allowed) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < cloud.octree.nodes().size(); ++i) {
        const Node& node = cloud.octree.node(i);
        if (!node.isLeaf()) continue;
        const auto run = cloud.octree.run(i);
        for (const Sample& sample : run->samples) {
            const glm::dvec3 p = position(node, sample);
            if (allowed(p, sample)) nearest = std::min(nearest, glm::distance(p, place));
        }
    }
    return nearest;
}

TEST(Pick, IsTheNearestThatTheViewDrawsByBruteForce) {
    const auto cloud = town(20000);
    View view = viewOf(*cloud);
    view.style.method = "paraboloid";
    view.quality.detail.reset();
    view.style.classes = std::vector<std::uint8_t>{1, 2};
    view.style.clip = ClipBox{corner + glm::dvec3(30, 10, -10), corner + glm::dvec3(170, 120, 20)};
    const Frame frame = drawn(*cloud, view);
    const glm::dvec3 low = view.style.clip->min - cloud->origin, high = view.style.clip->max - cloud->origin;
    const auto allowed = [&](const glm::dvec3& p, const Sample& sample) {
        return sample.classification > 0 && glm::all(glm::greaterThanEqual(p, low)) &&
               glm::all(glm::lessThanEqual(p, high));
    };
    const int count = overSurface(frame, [&](int x, int y, double depth) {
        const auto picked = pick(*cloud, view, {x, y}, depth);
        ASSERT_TRUE(picked && *picked);
        const glm::dvec3 place = *placeUnder(*cloud, view, {x, y}, depth);
        EXPECT_EQ((*picked)->distance, nearestByHand(*cloud, place, allowed));
        EXPECT_GT((*picked)->sample.classification, 0);
    });
    EXPECT_GT(count, 20);
}

// Right because it looks at all points, by the definition of shapes: what is cut away is not picked, though it may be
// nearer.
TEST(Pick, NothingThatShapesCutAway) {
    const auto cloud = town(20000);
    View view = viewOf(*cloud);
    const glm::dvec3 middle = (cloud->bounds[0] + cloud->bounds[1]) * 0.5;
    view.style.clips = {TurnedBox{middle, {150, 90, 60}, {35, 0, 0}},
                        TurnedBox{middle, {30, 30, 60}, {10, 0, 0}, true},
                        HalfSpace{middle - glm::dvec3(40, 0, 0), {1, 0.2, 0}}};
    const Frame whole = drawn(*cloud, viewOf(*cloud));
    const auto allowed = [&](const glm::dvec3& p, const Sample&) {
        return contains(view.style.clips, p + cloud->origin);
    };
    int taken = 0;
    const int count = overSurface(whole, [&](int x, int y, double depth) {
        const auto picked = pick(*cloud, view, {x, y}, depth);
        ASSERT_TRUE(picked && *picked);
        EXPECT_TRUE(contains(view.style.clips, (*picked)->point.position));
        const glm::dvec3 place = *placeUnder(*cloud, view, {x, y}, depth);
        EXPECT_EQ((*picked)->distance, nearestByHand(*cloud, place, allowed));
        taken += (*picked)->distance > 1;
    });
    EXPECT_GT(count, 20);
    EXPECT_GT(taken, 10) << "of the picture without shapes, much has nothing left at its place";
    view.style.clips = {TurnedBox{middle + glm::dvec3(0, 0, 1000), {1, 1, 1}}};
    EXPECT_FALSE(pick(*cloud, view, {160, 100}, 100).value()) << "nothing is left at all";
}

// Bit for bit what a reader of the scan has: origin + step * whole number.
TEST(Pick, TellsTheFilesOwnCoordinates) {
    const auto cloud = town(5000);
    std::set<std::tuple<double, double, double>> scan;
    for (std::uint64_t i = 0; i < 5000; ++i) {
        const glm::dvec3 p = (ground(i, 5000).position + corner);
        const auto onGrid = [](double value) { return 0.01 * std::nearbyint(value / 0.01); };
        scan.emplace(onGrid(p.x), onGrid(p.y), onGrid(p.z));
    }
    const View view = viewOf(*cloud);
    const int count = overSurface(drawn(*cloud, view), [&](int x, int y, double depth) {
        const auto picked = pick(*cloud, view, {x, y}, depth);
        ASSERT_TRUE(picked && *picked);
        const KeptPoint& point = (*picked)->point;
        EXPECT_TRUE(scan.contains({point.position.x, point.position.y, point.position.z}));
        EXPECT_TRUE(point.exact);
        EXPECT_EQ(point.precision, glm::dvec3(0.01));
    });
    EXPECT_GT(count, 30);
}

TEST(Pick, BackgroundAndGlassAreNothing) {
    const auto cloud = town(5000);
    View view = viewOf(*cloud);
    EXPECT_FALSE(pick(*cloud, view, {0, 0}, std::numeric_limits<double>::infinity()).value());
    // A mirror that fills the picture, 40 units before the eye.
    const glm::dvec3 eye = view.camera.eye, ahead = glm::normalize(view.camera.target - eye);
    Mirror mirror;
    mirror.center = eye + ahead * 40.0;
    mirror.normal = -ahead;
    mirror.up = glm::normalize(view.camera.up - ahead * glm::dot(view.camera.up, ahead));
    mirror.width = mirror.height = 200;
    cloud->mirrors.push_back(mirror);
    EXPECT_FALSE(pick(*cloud, view, {160, 100}, float(40)).value()) << "the glass";
    view.style.behindMirrors = true;
    EXPECT_TRUE(pick(*cloud, view, {160, 100}, 60).value()) << "what stands elsewhere";
    view.style.mirrors = false;
    EXPECT_TRUE(pick(*cloud, view, {160, 100}, 40).value()) << "no glass is drawn";
}

TEST(Pick, AViewThatDrawsNothingHasNothingToPick) {
    const auto cloud = town(2000);
    View view = viewOf(*cloud);
    view.style.classes = std::vector<std::uint8_t>{};
    EXPECT_FALSE(pick(*cloud, view, {100, 100}, 100).value());
}

}  // namespace
}  // namespace scancast::test
