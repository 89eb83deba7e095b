// Blinn-Phong lighting, docs/spec/shading.md §2, pixel by pixel against the formula in double.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"
#include "tests/support/pictures/reference_renderer.hpp"

namespace scancast::test {
namespace {

class Shading : public OnDevice {};
SCANCAST_ON_DEVICES(Shading, "egl");

/// What the light makes of a colour; n and the way to the eye are unit vectors in view space.
double shaded(double color, glm::dvec3 n, glm::dvec3 toEye) {
    if (glm::dot(n, toEye) < 0) n = -n;
    const glm::dvec3 light = glm::normalize(glm::dvec3(-1, 1, 1));
    const double diffuse = 0.25 + 0.55 * glm::dot(n, toEye) + 0.35 * std::max(0.0, glm::dot(n, light));
    const double shine = std::pow(std::max(0.0, glm::dot(n, glm::normalize(light + toEye))), 32);
    return std::min(255.0, color * diffuse + 255 * 0.15 * shine);
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
    for (const Viewpoint& view : {lookAt({0.4, -3, 1}, {0.1, 0, 0}, 331, 247, 50),
                                  lookAtOrthographic({0.4, -3, 1}, {0.1, 0, 0}, 331, 247, 2.3)}) {
        NearestPass nearest = sprite(Footprint::Circle, Profile::Paraboloid, 5);
        nearest.payload = Payload::Sample;
        Scene scene(view, cloud.cut(), nearest);
        scene.drawing.passes = scene.passes = {nearest, ResolvePass{false, true}, PhongPass{}};
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
                const double error = std::max({std::abs(got[0] - shaded(s.r, n, toEye)),
                                               std::abs(got[1] - shaded(s.g, n, toEye)),
                                               std::abs(got[2] - shaded(s.b, n, toEye))});
                ++compared;
                differing += error > 1.1;
            }
        }
        EXPECT_GT(compared, 20'000);
        // Where two paraboloids cross, float and double may choose differently.
        EXPECT_LE(differing, compared / 500);
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
