// Blinn-Phong lighting, docs/spec/shading.md §2, pixel by pixel against the formula in double.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "renderer/method/light.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"
#include "tests/support/pictures/reference_renderer.hpp"

namespace scancast::test {
namespace {

class Shading : public OnDevice {};
SCANCAST_ON_DEVICES(Shading, "egl");

/// What the light makes of a colour; n, the way to the eye and that to the sun are unit vectors in view space.
double shaded(double color, glm::dvec3 n, glm::dvec3 toEye, const PhongPass& pass, glm::dvec3 toSun) {
    if (glm::dot(n, toEye) < 0) n = -n;
    const glm::dvec3 lamp = glm::normalize(toEye + glm::dvec3(-0.5, std::sqrt(1.0 / 12), 0));
    const double soft = 1 - std::pow(1 - std::max(0.0, (glm::dot(n, lamp) + 0.4) / 1.4), 2);
    const double brightness = std::min(
        2.0, pass.ambient + pass.headlight * soft + pass.sunlight * std::max(0.0, glm::dot(n, toSun)));
    const double shine = pass.shine * std::pow(std::max(0.0, glm::dot(n, glm::normalize(lamp + toEye))), 64);
    const double bright =
        brightness < 1 ? color * brightness : color + (brightness - 1) * color * (1 - color / 255);
    return bright + shine * (255 - bright);
}

/// Two lights: as a view has it that says nothing of light, and a bright one with a low sun.
std::vector<PhongPass> lights() {
    PhongPass sunny{0.2f, 0.3f, 1.2f, 0.5f};
    sunny.sun = {0.36f, -0.48f, 0.8f};
    return {phongPass({}, {0, 0, 1}), sunny};
}

/// Of the picture's pixels that show something, grey.
double meanBrightness(const Frame& frame) {
    double sum = 0;
    int shown = 0;
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            if (!std::isfinite(depth(frame, x, y))) continue;
            sum += pixel(frame, x, y)[1];
            ++shown;
        }
    }
    return sum / std::max(1, shown);
}

TEST_P(Shading, IsTheFormulaAtEveryPixel) {
    // Right because the reference knows which sample each pixel shows, and the formula is a dozen lines.
    Numbers numbers(3);
    std::vector<AnalyticPoint> points(60'000);
    for (AnalyticPoint& p : points) {
        p.position = numbers.onSphere();
        // Half of them inside out: light must not depend on a normal's sign.
        p.normal = encodeNormal(glm::vec3(numbers.uniform() < 0.5 ? p.position : -p.position));
        p.rgb = numbers.color();
    }
    const AnalyticCloud cloud(points, 0.02);
    const std::vector<PhongPass> passes = lights();
    int which = 0;
    for (const Viewpoint& view : {lookAt({0.4, -3, 1}, {0.1, 0, 0}, 331, 247, 50),
                                  lookAtOrthographic({0.4, -3, 1}, {0.1, 0, 0}, 331, 247, 2.3),
                                  lookAt({-0.4, -3, 0}, {0.1, 0, 0}, 331, 247, 50)}) {
        const PhongPass& pass = passes[static_cast<std::size_t>(which++ % 2)];
        const glm::dvec3 toSun =
            glm::dmat3(view.cloudToView) * glm::dvec3(pass.sun[0], pass.sun[1], pass.sun[2]);
        NearestPass nearest = sprite(Footprint::Circle, Profile::Paraboloid, 5);
        nearest.payload = Payload::Sample;
        Scene scene(view, cloud.cut(), nearest);
        scene.drawing.passes = scene.passes = {nearest, ResolvePass{false, true}, pass};
        const Frame frame = mustDraw(*device_, scene.drawing);
        const ReferencePicture reference = referenceNearest(scene.drawing);
        std::vector<const Sample*> samples;
        for (const CutRun& run : cloud.cut().runs) {
            for (const Sample& s : run.samples) samples.push_back(&s);
        }
        int compared = 0, differing = 0;
        for (int y = 0; y < frame.height; ++y) {
            for (int x = 0; x < frame.width; ++x) {
                const ReferenceFragment& f = reference.at(x, y);
                if (!std::isfinite(f.order)) {
                    EXPECT_EQ(pixel(frame, x, y), (Rgb8{0, 0, 0}));
                    continue;
                }
                const Sample& s = *samples[f.sample];
                const glm::dvec3 n =
                    glm::normalize(glm::dmat3(view.cloudToView) * glm::dvec3(decodeNormal(s.normal)));
                const glm::dvec3 ray((x + 0.5 - view.width / 2.0) / view.pixelsPerUnit,
                                     (view.height / 2.0 - y - 0.5) / view.pixelsPerUnit, -1);
                const bool perspective = view.projection == Projection::Perspective;
                const glm::dvec3 toEye = perspective ? -glm::normalize(ray) : glm::dvec3(0, 0, 1);
                const Rgb8 got = pixel(frame, x, y);
                const auto errorOf = [&](int channel, std::uint8_t color) {
                    return std::abs(got[static_cast<std::size_t>(channel)] -
                                    shaded(color, n, toEye, pass, toSun));
                };
                const double error = std::max({errorOf(0, s.r), errorOf(1, s.g), errorOf(2, s.b)});
                ++compared;
                differing += error > 1.1;
            }
        }
        EXPECT_GT(compared, 20'000);
        // Where two paraboloids cross, float and double may choose differently.
        EXPECT_LE(differing, compared / 500);
    }
}

TEST_P(Shading, KeepsAGreySceneAsBrightAsItIs) {
    // Right because grey is the same everywhere, so the mean is the light's alone: docs/spec/shading.md §2.
    Numbers numbers(4);
    const auto greyCloud = [&](auto&& place) {
        std::vector<AnalyticPoint> points(120'000);
        for (AnalyticPoint& p : points) {
            place(p);
            p.rgb = {128, 128, 128};
        }
        return AnalyticCloud(points, 0.02);
    };
    const auto ball = greyCloud([&](AnalyticPoint& p) {
        p.position = numbers.onSphere();
        p.normal = encodeNormal(glm::vec3(p.position));
    });
    const auto ground = greyCloud([&](AnalyticPoint& p) {
        p.position = {numbers.uniform(-2, 2), numbers.uniform(-2, 2), 0};
        p.normal = encodeNormal(glm::vec3(0, 0, 1));
    });
    // A room seen from inside: all six sides.
    const auto room = greyCloud([&](AnalyticPoint& p) {
        const int axis = static_cast<int>(numbers.next() % 3);
        const double side = numbers.uniform() < 0.5 ? -1 : 1;
        p.position = {numbers.uniform(-1, 1), numbers.uniform(-1, 1), numbers.uniform(-1, 1)};
        p.position[axis] = side;
        glm::vec3 normal(0);
        normal[axis] = float(-side);
        p.normal = encodeNormal(normal);
    });
    struct Case {
        const char* what;
        const AnalyticCloud& cloud;
        Viewpoint view;
        double least, most;
    };
    const Case cases[] = {
        {"a ball", ball, lookAt({0, -3, 0.5}, {0, 0, 0}, 200, 200, 50), 0.95, 1.05},
        {"ground from above", ground, lookAt({0, -0.01, 2}, {0, 0, 0}, 200, 200, 50), 0.95, 1.05},
        {"ground at 45 degrees", ground, lookAt({0, -1.5, 1.5}, {0, 0, 0}, 200, 200, 50), 0.95, 1.06},
        {"a room", room, lookAt({0.3, -0.6, 0}, {0, 1, -0.1}, 200, 200, 75), 0.95, 1.05},
    };
    for (const Case& c : cases) {
        NearestPass nearest = sprite(Footprint::Circle, Profile::Flat, 7);
        nearest.payload = Payload::Sample;
        Scene scene(c.view, c.cloud.cut(), nearest);
        scene.drawing.passes = scene.passes = {nearest, ResolvePass{false, true}, phongPass({}, {0, 0, 1})};
        const double ratio = meanBrightness(mustDraw(*device_, scene.drawing)) / 128;
        EXPECT_GT(ratio, c.least) << c.what;
        EXPECT_LT(ratio, c.most) << c.what;
    }
}

TEST_P(Shading, LeavesPixelsWithoutNormalsAsTheyAre) {
    // Right because there is nothing to light: docs/spec/shading.md §2 says so of no normal.
    const AnalyticPoint point{.position = {0, 0, 0}, .rgb = {200, 100, 50}};
    const AnalyticCloud cloud(std::span(&point, 1), 0.02);
    const Viewpoint view = lookAt({0, -3, 0}, {0, 0, 0}, 33, 33);
    NearestPass nearest = sprite(Footprint::Circle, Profile::Flat, 9);
    nearest.payload = Payload::Sample;
    Scene scene(view, cloud.cut(), nearest);
    scene.drawing.passes = scene.passes = {nearest, ResolvePass{false, true}, PhongPass{}};
    EXPECT_EQ(pixel(mustDraw(*device_, scene.drawing), 16, 16), (Rgb8{200, 100, 50}));
}

}  // namespace
}  // namespace scancast::test
