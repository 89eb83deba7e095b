// From where a scene may be looked at: every place holds what it should.
#include "renderer/look/candidates.hpp"

#include <gtest/gtest.h>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <set>

#include "tests/unit/look/scenes.hpp"

namespace scancast {
namespace {

TEST(OutlineOf, ReachesAsFarAsThePointsDo) {
    const auto points = test::blob(4000, {100, 200, 300}, 7);
    const auto outline = outlineOf(points);
    EXPECT_LE(outline.size(), Look::mostOutline);
    EXPECT_GE(outline.size(), 50U);
    // In any direction, but for the last few points, nothing lies farther out: the oracle asks all of them.
    for (const SurveyPoint& direction : test::blob(300, {0, 0, 0}, 1)) {
        const auto farthest = [&](const auto& all, const auto& position) {
            double most = -INFINITY;
            for (const auto& p : all) most = std::max(most, glm::dot(position(p), direction.position));
            return most;
        };
        const double all = farthest(points, [](const SurveyPoint& p) { return p.position; });
        EXPECT_GE(farthest(outline, [](const glm::dvec3& p) { return p; }), all - 0.1 * 7);
    }
    for (const glm::dvec3& p : outline)
        EXPECT_TRUE(std::ranges::any_of(points, [&](const SurveyPoint& q) { return q.position == p; }));
    EXPECT_EQ(outlineOf({test::pointAt({1, 2, 3})}), (std::vector<glm::dvec3>{{1, 2, 3}}));
}

TEST(Candidates, AreSoundAndNamed) {
    std::vector<SurveyedScene> scenes;
    const auto add = [&](SceneKind kind, const glm::dvec3& up) {
        SurveyedScene& scene = scenes.emplace_back();
        scene.kind = kind;
        scene.up = up;
        scene.points = test::landscape(3000, {10, 20}, 0, 300);
        scene.box = boxOf(scene.points);
    };
    for (const glm::dvec3 up : {glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0)})
        for (std::size_t kind = 0; kind < 4; ++kind) add(SceneKind(kind), up);
    add(SceneKind::Airborne, {0, 0, 1});
    scenes.back().onlyFromAbove = true;
    add(SceneKind::Street, {0, 0, 1});
    scenes.back().sensor = {500, 500, 200};
    for (const double sign : {1.0, -1.0}) {
        SurveyedScene& frame = scenes.emplace_back();
        frame.kind = SceneKind::DepthFrame;
        frame.up = {0, -sign, 0};
        frame.forward = {0, 0, sign};
        frame.sensor = glm::dvec3(0);
        frame.points = test::depthFrame(3000, sign);
        frame.box = boxOf(frame.points);
    }
    for (const SurveyedScene& scene : scenes) {
        const auto outside = outsideCandidates(scene, outlineOf(scene.points));
        EXPECT_FALSE(outside.empty());
        const auto check = [&](const Candidate& candidate, bool inside) {
            EXPECT_EQ(candidate.view.inside, inside) << candidate.view.name;
            EXPECT_FALSE(candidate.view.name.empty());
            View view;
            view.camera = candidate.view.camera;
            const auto sound = validate(view);
            EXPECT_TRUE(sound) << candidate.view.name << ": " << sound.error().message;
            // Nothing stands on its head, and what looks straight down has north above.
            const glm::dvec3 ahead = glm::normalize(view.camera.target - view.camera.eye);
            EXPECT_TRUE(glm::dot(view.camera.up, scene.up) > 0.99 ||
                        std::abs(glm::dot(ahead, scene.up)) > 0.99);
        };
        for (const Candidate& candidate : outside) check(candidate, false);
        for (const Candidate& candidate : insideCandidates(scene)) check(candidate, true);
        if (!scene.sensor) continue;
        for (const Candidate& candidate : insideCandidates(scene))
            EXPECT_EQ(candidate.view.camera.eye, *scene.sensor);
    }
    EXPECT_EQ(scenes[12].onlyFromAbove, true);
    const auto map = outsideCandidates(scenes[12], outlineOf(scenes[12].points));
    ASSERT_EQ(map.size(), 1U);
    EXPECT_EQ(map[0].view.camera.projection, Projection::Orthographic);
}

// Oracle: the points are projected by the definition of a camera.
TEST(Candidates, TheSensorsOwnViewHoldsWhatItSaw) {
    for (const double sign : {1.0, -1.0}) {
        SurveyedScene scene;
        scene.kind = SceneKind::DepthFrame;
        scene.up = {0, -sign, 0};
        scene.forward = {0, 0, sign};
        scene.sensor = glm::dvec3(0);
        scene.points = test::depthFrame(3000, sign);
        scene.box = boxOf(scene.points);
        const auto inside = insideCandidates(scene);
        ASSERT_EQ(inside.size(), 1U);
        const Camera& camera = inside[0].view.camera;
        EXPECT_EQ(camera.eye, glm::dvec3(0));
        const glm::dvec3 ahead = glm::normalize(camera.target - camera.eye);
        const glm::dvec3 right = glm::normalize(glm::cross(ahead, camera.up)), up = glm::cross(right, ahead);
        const double tan = std::tan(glm::radians(camera.fov) / 2);
        std::size_t seen = 0;
        for (const SurveyPoint& p : scene.points) {
            const double depth = glm::dot(p.position, ahead);
            seen += depth > 0 && std::abs(glm::dot(p.position, right)) <= depth * tan * 16 / 9 &&
                    std::abs(glm::dot(p.position, up)) <= depth * tan;
        }
        EXPECT_GE(double(seen), 0.99 * double(scene.points.size()));
    }
}

}  // namespace
}  // namespace scancast
