// Cameras fitted to points. Oracle: the points are projected by the definition of a camera, and where they land
// says whether all of them are in the picture, and whether they fill it.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>
#include <random>

#include "tests/unit/protocol/sample_looks.hpp"

namespace scancast {
namespace {

/// Of the picture's width or height, at each end.
constexpr double margin = 0.06;

class Dice {
  public:
    explicit Dice(unsigned seed) : engine_(seed) {}
    double between(double low, double high) { return low + (high - low) * double(engine_()) / 4294967296.0; }
    glm::dvec3 direction() {
        for (;;) {
            const glm::dvec3 v(between(-1, 1), between(-1, 1), between(-1, 1));
            if (glm::length(v) > 0.1 && glm::length(v) < 1) return glm::normalize(v);
        }
    }
    std::vector<glm::dvec3> points(std::size_t count, double size, const glm::dvec3& around) {
        const glm::dvec3 shape(between(0.05, 1), between(0.05, 1), between(0.05, 1));
        std::vector<glm::dvec3> all(count);
        for (auto& p : all)
            p = around + size * shape * glm::dvec3(between(-1, 1), between(-1, 1), between(-1, 1));
        return all;
    }
    Camera camera(const glm::dvec3& target, bool perspective) {
        Camera camera;
        camera.projection = perspective ? Projection::Perspective : Projection::Orthographic;
        camera.target = target;
        camera.eye = target + direction() * between(0.1, 10);
        camera.fov = between(20, 100);
        do camera.up = direction();
        while (std::abs(glm::dot(camera.up, glm::normalize(camera.eye - camera.target))) > 0.98);
        return camera;
    }

  private:
    std::mt19937 engine_;
};

struct Extent {
    glm::dvec2 low{INFINITY}, high{-INFINITY};
    double least = INFINITY;  ///< depth
    glm::dvec2 reach() const { return glm::max(glm::abs(low), glm::abs(high)); }
};

/// Where points appear: -1 … 1 in the picture, and how far in front of the eye.
Extent seen(const Camera& camera, const std::vector<glm::dvec3>& points, double aspect) {
    const glm::dvec3 ahead = glm::normalize(camera.target - camera.eye);
    const glm::dvec3 right = glm::normalize(glm::cross(ahead, camera.up)), up = glm::cross(right, ahead);
    Extent extent;
    for (const glm::dvec3& point : points) {
        const glm::dvec3 p = point - camera.eye;
        const double depth = glm::dot(p, ahead);
        const double half = camera.projection == Projection::Perspective
                                ? depth * std::tan(camera.fov * std::numbers::pi / 360)
                                : camera.viewHeight / 2;
        const glm::dvec2 at(glm::dot(p, right) / (half * aspect), glm::dot(p, up) / half);
        extent.low = glm::min(extent.low, at);
        extent.high = glm::max(extent.high, at);
        extent.least = std::min(extent.least, depth);
    }
    return extent;
}

void expectFits(const Camera& camera, const std::vector<glm::dvec3>& points, double aspect) {
    const Extent extent = seen(camera, points, aspect);
    EXPECT_GT(extent.least, 0);
    // The picture is 2 wide and high here.
    EXPECT_LE(extent.reach().x, 1 - 2 * margin + 1e-6);
    EXPECT_LE(extent.reach().y, 1 - 2 * margin + 1e-6);
}

/// Both ends of one pair of sides are as near as the margin allows.
void expectFills(const Camera& camera, const std::vector<glm::dvec3>& points, double aspect) {
    const Extent extent = seen(camera, points, aspect);
    const glm::dvec2 least = glm::min(-extent.low, extent.high);
    EXPECT_GE(std::max(least.x, least.y), 1 - 2 * margin - 0.01) << least.x << ' ' << least.y;
}

TEST(Fitted, AllIsInThePictureAndFillsIt) {
    Dice dice(1);
    for (int i = 0; i < 400; ++i) {
        const double size = std::pow(10, dice.between(-3, 5)), aspect = dice.between(0.5, 3);
        const glm::dvec3 around = dice.direction() * dice.between(0, 1000 * size);
        const auto points = dice.points(8 + std::size_t(dice.between(0, 50)), size, around);
        // Where the camera looks at first, and from how far, may be anything, but for its direction.
        const Camera before =
            dice.camera(around + dice.direction() * size * (i % 3 == 0 ? 20.0 : 0.3), i % 2 == 0);
        const Camera camera = fitted(before, points, aspect);
        SCOPED_TRACE(i);
        expectFits(camera, points, aspect);
        expectFills(camera, points, aspect);
        const glm::dvec3 was = glm::normalize(before.target - before.eye);
        EXPECT_NEAR(glm::distance(glm::normalize(camera.target - camera.eye), was), 0, 1e-6);
        EXPECT_EQ(camera.up, before.up);
        EXPECT_EQ(camera.fov, before.fov);
    }
}

TEST(Fitted, OfOneFittedAlreadyNothingChanges) {
    Dice dice(2);
    for (int i = 0; i < 100; ++i) {
        const auto points = dice.points(20, 3, {5, 6, 7});
        const Camera once = fitted(dice.camera({5, 6, 7}, i % 2 == 0), points, 1.5),
                     twice = fitted(once, points, 1.5);
        EXPECT_NEAR(glm::distance(once.eye, twice.eye), 0, 1e-6);
        EXPECT_NEAR(once.viewHeight, twice.viewHeight, 1e-9);
    }
}

TEST(Fitted, OnePointAndPointsOnALine) {
    Dice dice(3);
    for (int i = 0; i < 100; ++i) {
        const bool perspective = i % 2 == 0;
        const glm::dvec3 at = dice.direction() * dice.between(0, 1e6);
        const Camera before = dice.camera(at, perspective);
        std::vector<glm::dvec3> points{at};
        const auto check = [&] {
            View view;
            view.camera = fitted(before, points, 1.6);
            const auto sound = validate(view);
            EXPECT_TRUE(sound) << sound.error().message;
            if (points.size() > 1) expectFits(view.camera, points, 1.6);
        };
        check();
        const glm::dvec3 along = dice.direction();
        for (int k = -10; k <= 10; ++k) points.push_back(at + along * double(k));
        check();
        // Straight towards the eye.
        points = {at};
        for (int k = -10; k <= 10; ++k) points.push_back(at + glm::normalize(before.eye - at) * double(k));
        check();
    }
}

TEST(Fitted, ForNoPointsAndNoPictureItStaysSound) {
    const Camera camera;
    EXPECT_EQ(fitted(camera, {}, 1), camera);
    for (const double aspect : {0.0, -1.0, double(NAN), double(INFINITY)})
        EXPECT_EQ(fitted(camera, {{0, 0, 0}, {1, 2, 3}}, aspect), fitted(camera, {{0, 0, 0}, {1, 2, 3}}, 1));
}

TEST(CameraFor, StaysInsideAndFitsOutside) {
    Look look = test::plainLook();
    look.outline = Dice(4).points(30, 10, {1, 2, 3});
    LookView view = look.views.front();
    view.camera.eye = {40, -30, 20};
    EXPECT_EQ(cameraFor(look, view, 0.8), fitted(view.camera, look.outline, 0.8));
    view.inside = true;
    EXPECT_EQ(cameraFor(look, view, 16.0 / 9), view.camera);
    EXPECT_EQ(cameraFor(look, view, 3), view.camera);
    // Higher than wide: as much to the left and right, up to 90 degrees, and never less than it said.
    for (const double aspect : {1.7, 1.5, 1.2}) {
        const double fov = cameraFor(look, view, aspect).fov * std::numbers::pi / 360;
        const double wanted = std::tan(60 * std::numbers::pi / 360) * 16 / 9;
        EXPECT_NEAR(std::tan(fov) * aspect, std::min(wanted, aspect), 1e-9);
    }
    view.camera.fov = 110;
    EXPECT_EQ(cameraFor(look, view, 0.5).fov, 110);
    view.camera = test::matrixView().camera;
    for (const bool inside : {true, false}) {
        view.inside = inside;
        EXPECT_EQ(cameraFor(look, view, 0.5), view.camera);
    }
}

}  // namespace
}  // namespace scancast
