// Normals that turn across a surfel: docs/spec/surfels.md §12.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "renderer/method/method.hpp"
#include "tests/oracle/device/surfel_scenes.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_surfels.hpp"

namespace scancast::test {
namespace {

constexpr int curvedSide = 160;
constexpr double ballHeight = 2.4;
constexpr std::uint8_t clay = 180;

class CurvedSurfels : public OnDevice {};
SCANCAST_ON_DEVICES(CurvedSurfels, "egl");

/// A ball of radius 1 of so few surfels that each is seen, whose normals point outwards times `side`.
AnalyticCloud coarseBall(double side, bool bent) {
    constexpr int count = 500;
    std::vector<AnalyticPoint> points;
    for (int i = 0; i < count; ++i) {
        const double z = 1 - 2 * (i + 0.5) / count, turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
        const double r = std::sqrt(1 - z * z);
        AnalyticPoint p;
        p.position = {r * std::cos(turn), r * std::sin(turn), z};
        p.rgb = {clay, clay, clay};
        const glm::dvec3 along = glm::cross(p.position, glm::dvec3(0.6, 0.48, 0.64));
        p.surfel = surfelOf(side * p.position, 0.16, glm::normalize(along), 0.8);
        if (bent) p.surfel->bend = glm::vec3(float(side), 0, float(side));
        points.push_back(p);
    }
    return AnalyticCloud(points, 0.16);
}

/// A lamp alone, without its reflection: docs/spec/shading.md §2.
PassList litPasses(const char* name, bool curved) {
    const Method* method = findMethod(name);
    PassList passes =
        method->passes({*method, resolveParameters(*method, {{"curved", curved}}).value(), Shading::Phong});
    for (Pass& pass : passes)
        if (auto* phong = std::get_if<PhongPass>(&pass)) *phong = {.ambient = 0, .headlight = 1, .shine = 0};
    return passes;
}

double litClay(const glm::dvec3& n) {
    const glm::dvec3 lamp = glm::normalize(glm::dvec3(-0.5, 1 / std::sqrt(12.0), 1));
    const double near = std::max(0.0, (glm::dot(n, lamp) + 0.4) / 1.4), b = 1 - (1 - near) * (1 - near);
    return clay * b;
}

/// PSNR of the ball against the formula with the normals of the ball itself, in the middle four fifths.
double psnrOfBall(Device& device, const char* method, const AnalyticCloud& cloud, bool curved,
                  bool oriented) {
    const Viewpoint view = lookAtOrthographic({0, -4, 0}, {0, 0, 0}, curvedSide, curvedSide, ballHeight);
    SurfelScene scene(view, cloud.cut(), litPasses(method, curved));
    scene.drawing.oriented = oriented;
    const Frame frame = mustDraw(device, scene.drawing);
    double squares = 0, pixels = 0;
    for (int y = 0; y < curvedSide; ++y)
        for (int x = 0; x < curvedSide; ++x) {
            const double q = curvedSide / ballHeight;
            glm::dvec3 n((x + 0.5 - curvedSide / 2.0) / q, (curvedSide / 2.0 - y - 0.5) / q, 0);
            const double flat2 = glm::dot(n, n);
            if (flat2 > 0.64) continue;
            n.z = std::sqrt(1 - flat2);
            const double error = pixel(frame, x, y)[0] - litClay(n);
            squares += error * error;
            ++pixels;
        }
    return 10 * std::log10(255 * 255 * pixels / squares);
}

// Right because the ball's normals are known; whichever way the surfels' own point, and whether anybody knows it.
TEST_P(CurvedSurfels, ABallOfFewIsLitAsABall) {
    for (const auto& [method, gain] : {std::pair("disc", 8.0), std::pair("ewa", 0.5)}) {
        for (const double side : {1.0, -1.0}) {
            SCOPED_TRACE(std::string(method) + (side > 0 ? ", outwards" : ", inwards, and nobody knows"));
            const AnalyticCloud cloud = coarseBall(side, true);
            const double bent = psnrOfBall(*device_, method, cloud, true, side > 0);
            const double flat = psnrOfBall(*device_, method, cloud, false, side > 0);
            RecordProperty(std::string(method) + (side > 0 ? "Out" : "In"),
                           std::to_string(flat) + " to " + std::to_string(bent));
            EXPECT_GE(bent, flat + gain) << flat;
            EXPECT_GE(bent, 36) << flat;
        }
    }
}

// Right because nothing bends: the same bytes, whatever was asked for.
TEST_P(CurvedSurfels, WithoutCurvaturesAreAsFlatAsBefore) {
    const AnalyticCloud cloud = coarseBall(1, false);
    const Viewpoint view = lookAt({0.2, -3, 0.5}, {0, 0, 0}, curvedSide, curvedSide, 45);
    for (const char* method : {"disc", "ewa"}) {
        SurfelScene on(view, cloud.cut(), litPasses(method, true)),
            off(view, cloud.cut(), litPasses(method, false));
        EXPECT_EQ(mustDraw(*device_, on.drawing).rgba, mustDraw(*device_, off.drawing).rgba) << method;
    }
}

}  // namespace
}  // namespace scancast::test
