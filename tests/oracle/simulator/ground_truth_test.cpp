// The ray caster against analytic shapes and against the generator's own points; the picture against areas.
#include "tests/ground_truth/ground_truth.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <numbers>

#include "tests/support/clouds/scene_points.hpp"
#include "tests/support/pictures/analytic_cut.hpp"

namespace scancast {
namespace {

RayCaster casterOf(const char* scene) {
    return RayCaster::create({.scene = scene, .origin = glm::dvec3(0)}).value();
}

// Along the axis a sphere of radius 1 is met at distance - 1; off it, by Pythagoras. Its silhouette is a disc
// of angle asin(1 / distance), whose area on the picture plane is known.
TEST(GroundTruth, OfASphereIsAnalytic) {
    const RayCaster caster = casterOf("sphere");
    const double distance = 4;
    const Viewpoint view = test::lookAt({0, -distance, 0}, {0, 0, 0}, 161, 121, 40);
    const GroundTruth truth = castRays(caster, view, {.supersampling = 4}).value();
    double covered = 0;
    for (int y = 0; y < truth.height; ++y) {
        for (int x = 0; x < truth.width; ++x) {
            covered += truth.coverage[truth.at(x, y)];
            const glm::dvec3 way((x + 0.5 - 80.5) / view.pixelsPerUnit, 1,
                                 (60.5 - y - 0.5) / view.pixelsPerUnit);
            const double a = glm::dot(way, way), b = -distance, c = distance * distance - 1,
                         inside = b * b - a * c;
            const float depth = truth.depth[truth.at(x, y)];
            if (inside < 0) {
                ASSERT_TRUE(std::isinf(depth));
                continue;
            }
            const double t = (-b - std::sqrt(inside)) / a;
            ASSERT_NEAR(depth, t, 1e-6);
            const glm::dvec3 on = glm::dvec3(0, -distance, 0) + way * t;
            ASSERT_LT(glm::distance(glm::dvec3(truth.normal[truth.at(x, y)]), on), 1e-5);
        }
    }
    const double radius = view.pixelsPerUnit / std::sqrt(distance * distance - 1);
    EXPECT_NEAR(covered, std::numbers::pi * radius * radius, covered * 2e-3);
}

// A plane seen without perspective has the same depth wherever the view direction is its normal, and covers a
// rectangle of known size; the mean of an area twice the checkers' period is the mean of its rays.
TEST(GroundTruth, OfAPlaneIsAnalytic) {
    const RayCaster caster = casterOf("plane");
    const Viewpoint view = test::lookAtOrthographic({0, 0, 5}, {0, 0, 0}, 120, 120, 3);
    const GroundTruth truth = castRays(caster, view, {.supersampling = 2}).value();
    double covered = 0;
    for (std::size_t i = 0; i < truth.depth.size(); ++i) {
        covered += truth.coverage[i];
        if (truth.coverage[i] == 1) {
            ASSERT_NEAR(truth.depth[i], 5, 1e-6);
        }
    }
    EXPECT_NEAR(covered, 80 * 80, 1e-6);  // 2 m of 3 m in 120 px
}

TEST(GroundTruth, IsTheSameOnAnyNumberOfThreads) {
    for (const char* scene : {"town", "statue"}) {
        const RayCaster caster = casterOf(scene);
        const SceneView& at = sceneViews(scene)[0];
        const Viewpoint view = test::lookAt(at.eye, at.target, 120, 80, at.fov);
        const GroundTruth one = castRays(caster, view, {.supersampling = 2, .threads = 1}).value();
        const GroundTruth two = castRays(caster, view, {.supersampling = 2, .threads = 2}).value();
        ASSERT_EQ(std::memcmp(one.color.data(), two.color.data(), one.color.size() * sizeof(glm::vec3)), 0);
        EXPECT_EQ(one.depth, two.depth);
        EXPECT_EQ(one.coverage, two.coverage);
    }
}

// A cloud's coordinates are relative to its own origin: the same view of the same scene elsewhere is the
// same.
TEST(GroundTruth, FollowsTheOrigins) {
    const RayCaster here = casterOf("cube");
    const RayCaster there =
        RayCaster::create({.scene = "cube", .origin = glm::dvec3(389500, 5819800, 34)}).value();
    const Viewpoint view = test::lookAt({4, -5, 3}, {0, 0, 0}, 60, 60);
    // The cloud's origin is (-1, -1, -1) of the scene, so its coordinates are larger by 1.
    const Viewpoint moved = test::lookAt({5, -4, 4}, {1, 1, 1}, 60, 60);
    const GroundTruth a = castRays(here, view, {.supersampling = 1}).value();
    const GroundTruth b =
        castRays(there, moved, {.supersampling = 1, .cloudOrigin = {389499, 5819799, 33}}).value();
    for (std::size_t i = 0; i < a.depth.size(); ++i)
        if (std::isfinite(a.depth[i])) {
            ASSERT_NEAR(a.depth[i], b.depth[i], 1e-5);
        }
    EXPECT_TRUE(std::isfinite(b.depth[b.at(30, 30)]));
}

TEST(GroundTruth, RefusesWhatIsNotPossible) {
    const RayCaster caster = casterOf("cube");
    const Viewpoint view = test::lookAt({4, -5, 3}, {0, 0, 0}, 6, 6);
    EXPECT_FALSE(castRays(caster, view, {.supersampling = 0}));
    EXPECT_FALSE(castRays(caster, view, {.supersampling = 65}));
    EXPECT_FALSE(castRays(caster, Viewpoint{}, {}));
    EXPECT_EQ(RayCaster::create({.scene = "moon"}).error().code, ErrorCode::NotFound);
}

struct Agreement {
    std::size_t tried = 0, missed = 0, seen = 0, wrongColor = 0, wrongNormal = 0;
    double brighter = 0;  ///< sum of differences of the seen points' channels, of 255
};

/// Rays from the eye through noise-free points: each must meet a surface there or before; where it is the
/// point's own surface, with the point's colour and normal.
Agreement agreement(const char* scene, glm::dvec3 eye, double tolerance, std::uint64_t points) {
    const RayCaster caster = casterOf(scene);
    const PointBatch cloud =
        test::scenePoints({.scene = scene, .points = points, .noise = 0, .origin = glm::dvec3(0)});
    Agreement result;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        if (cloud.normal[i] == glm::vec3(0)) continue;  // leaves
        ++result.tried;
        const glm::dvec3 way = cloud.position[i] - eye;
        const double length = glm::length(way), slack = tolerance / length;
        // A grazing ray meets the surface a little before or behind the point that it is aimed at.
        const double grazing = std::abs(glm::dot(glm::dvec3(cloud.normal[i]), way)) / length;
        if (grazing < 0.05) continue;
        const auto hit = caster.cast({eye, way}, 0, 1 + slack / grazing, i, Glass::Reflects);
        if (!hit) {
            ++result.missed;
            continue;
        }
        if (hit->t < 1 - slack / grazing) continue;
        ++result.seen;
        const auto normal = std::abs(glm::dot(hit->normal, cloud.normal[i]));
        result.wrongNormal += normal < 0.999F;
        float worst = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const float off = hit->color[int(c)] * 255 - float(cloud.color[i][c]);
            result.brighter += off;
            worst = std::max(worst, std::abs(off));
        }
        result.wrongColor += worst > 40;  // beyond the grain of any material
    }
    return result;
}

// Generator and caster share the patches but not the way to them: one goes from parameters to places, the
// other from rays to parameters. Colours may differ where a pattern's edge or a shadow lies within the
// tolerance.
TEST(RayCaster, MeetsThePointsOfTheGenerator) {
    struct Case {
        const char* scene;
        glm::dvec3 eye;
    };
    for (const Case& one :
         {Case{"sphere", {2, -3, 1}}, Case{"plane", {0.3, -2, 1.5}}, Case{"cube", {3, -4, 2.5}},
          Case{"torus", {1.5, -3, 1.2}}, Case{"sign", {-1, -2, 1}}, Case{"statue", {-1.2, -4, 2.2}},
          Case{"bridge", {-13.2, -2.2, 3.4}}, Case{"room", {-1.7, -1.8, 1.6}}}) {
        const Agreement found = agreement(one.scene, one.eye, 1e-5, 60007);
        EXPECT_LE(found.missed, found.tried / 20000) << one.scene;
        EXPECT_GT(found.seen, found.tried / 50) << one.scene;
        EXPECT_LE(found.wrongNormal, found.seen / 500) << one.scene;
        EXPECT_LE(found.wrongColor, found.seen / 100) << one.scene;
        EXPECT_LT(std::abs(found.brighter) / (3.0 * double(found.seen)), 0.5) << one.scene;
    }
}

// The town's relief is followed, not solved: millimetres, but at the steps of facades and kerbs.
TEST(RayCaster, FollowsTheReliefOfTheTown) {
    const Agreement found = agreement("town", {25.2, -50, 6}, 0.005, 200003);
    EXPECT_LE(found.missed, found.tried / 200);
    EXPECT_GT(found.seen, found.tried / 100);
    EXPECT_LE(found.wrongColor, found.seen / 5);
}

// The same t that a ray to a point needs, and no less: what is seen is not hidden, what lies behind it is.
TEST(RayCaster, SeesWhatNothingHides) {
    const RayCaster caster = casterOf("sphere");
    test::Numbers numbers(5);
    for (int i = 0; i < 1000; ++i) {
        const glm::dvec3 point = numbers.onSphere(), eye = numbers.onSphere() * numbers.uniform(1.5, 9);
        const double facing = glm::dot(point, eye - point);
        if (std::abs(facing) < 0.05) continue;
        EXPECT_EQ(caster.sees(eye, point, 1e-3), facing > 0);
    }
}

// What is seen in a mirror is the room reflected: the places where its image is met are those of the real
// room.
TEST(RayCaster, SeesTheRoomInTheMirror) {
    const RayCaster caster = casterOf("room");
    const Mirror mirror = sceneMirrors({.scene = "room"}).at(0);
    const glm::dvec3 eye(0.8, -1.8, 1.5), eyeBehind = reflected(mirror, eye);
    test::Numbers numbers(6);
    for (int i = 0; i < 500; ++i) {
        const glm::dvec3 through = mirror.center + glm::dvec3(numbers.uniform(-0.49, 0.49) * mirror.width, 0,
                                                              numbers.uniform(-0.49, 0.49) * mirror.height);
        const Ray ray{eye, through - eye};
        const auto glass = caster.cast(ray, 0, 1e9, 0, Glass::Reflects),
                   open = caster.cast(ray, 0, 1e9, 0, Glass::Open);
        if (open) {  // something stands before the glass
            EXPECT_EQ(open->t, glass->t);
            continue;
        }
        ASSERT_TRUE(glass && glass->reflected);
        const auto real = caster.cast({eyeBehind, through - eyeBehind}, 1 + 1e-9, 1e9, 0, Glass::Open);
        ASSERT_TRUE(real);
        EXPECT_NEAR(glass->t, real->t, 1e-9);
        EXPECT_LT(glm::distance(reflected(mirror, real->position), glass->position), 1e-6);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(glass->color[c], real->color[c] * float(mirror.tint[std::size_t(c)]) / 255, 1e-6);
    }
}

// Under the bridge, the nearest and the farthest thing in one view are more than 100 : 1 apart.
TEST(Bridge, HasTheDepthRatioOfThePaper) {
    const SceneView& under = sceneViews("bridge")[1];
    const GroundTruth truth =
        castRays(casterOf("bridge"), test::lookAt(under.eye, under.target, 160, 90, under.fov),
                 {.supersampling = 1})
            .value();
    float near = 1e9F, far = 0;
    for (const float depth : truth.depth)
        if (std::isfinite(depth)) {
            near = std::min(near, depth);
            far = std::max(far, depth);
        }
    EXPECT_GT(far / near, 100);
}

TEST(SceneViews, ShowEveryScene) {
    for (const SceneInfo& scene : scenes()) {
        ASSERT_FALSE(sceneViews(scene.name).empty()) << scene.name;
        const RayCaster caster = casterOf(std::string(scene.name).c_str());
        for (const SceneView& at : sceneViews(scene.name)) {
            const GroundTruth truth =
                castRays(caster, test::lookAt(at.eye, at.target, 48, 32, at.fov), {.supersampling = 1})
                    .value();
            std::size_t covered = 0;
            for (const float part : truth.coverage) covered += part > 0;
            EXPECT_GT(covered, truth.coverage.size() / 10) << scene.name << ' ' << at.name;
        }
    }
    EXPECT_TRUE(sceneViews("moon").empty());
}

}  // namespace
}  // namespace scancast
