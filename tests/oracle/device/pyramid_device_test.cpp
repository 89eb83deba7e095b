// Method `pyramid` through the device: splats, guard band and screen passes together, as a client sees them.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "renderer/method/method.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"

namespace scancast::test {
namespace {

class PyramidMethod : public OnDevice {};
SCANCAST_ON_DEVICES(PyramidMethod, "egl");

/// The method's passes for a cloud of this spacing, drawn in full.
PassList passesFor(double spacing, Shading shading) {
    const Method& method = *findMethod("pyramid");
    const ParameterValues values = resolveParameters(method, {}).value();
    CloudTraits cloud;
    cloud.spacing = spacing;
    return method.passes(
        {.method = method, .values = values, .shading = shading, .cloud = cloud, .detail = 0});
}

Frame drawn(Device& device, const Viewpoint& view, const AnalyticCloud& cloud, double spacing,
            Shading shading = Shading::Unlit) {
    Scene scene(view, cloud.cut(), {});
    scene.passes = passesFor(spacing, shading);
    scene.drawing.passes = scene.passes;
    return mustDraw(device, scene.drawing);
}

struct PictureSetting {
    int width, height;
    bool perspective;
    double spacingPx;
};

std::vector<PictureSetting> pictureSettings(bool small) {
    std::vector<PictureSetting> all;
    for (const auto& [width, height] : {std::pair{480, 360}, {801, 603}}) {
        if (small && width > 480) continue;
        for (const bool perspective : {true, false}) {
            for (const double spacing : {2.0, 3.5}) all.push_back({width, height, perspective, spacing});
        }
    }
    return all;
}

std::string nameOf(const PictureSetting& s) {
    return std::to_string(s.width) + " x " + std::to_string(s.height) + ", every " +
           std::to_string(s.spacingPx) + " px, " + (s.perspective ? "perspective" : "orthographic");
}

constexpr Rgb8 green{0, 200, 0}, red{200, 0, 0};

TEST_P(PyramidMethod, CoversASphere) {
    // Inside its silhouette a sphere has no holes, outside it nothing is drawn.
    for (const PictureSetting& s : pictureSettings(slow_)) {
        const double eye = 3, viewHeight = 2.6;
        const Viewpoint view =
            s.perspective ? lookAt({0, -eye, 0}, {0, 0, 0}, s.width, s.height, 50)
                          : lookAtOrthographic({0, -eye, 0}, {0, 0, 0}, s.width, s.height, viewHeight);
        const double spacing = s.spacingPx / view.q(eye - 1);
        const auto count = static_cast<int>(4 * 3.14159265358979 / (spacing * spacing));
        std::vector<AnalyticPoint> points(static_cast<std::size_t>(count));
        for (int i = 0; i < count; ++i) {
            const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
            AnalyticPoint& p = points[static_cast<std::size_t>(i)];
            p.position = {r * std::cos(a), r * std::sin(a), z};
            p.rgb = green;
        }
        const AnalyticCloud cloud(points, spacing);
        const Frame frame = drawn(*device_, view, cloud, spacing);
        const Frame lit = drawn(*device_, view, cloud, spacing, Shading::Phong);
        const double silhouette = view.pixelsPerUnit * (s.perspective ? 1 / std::sqrt(eye * eye - 1) : 1);
        double inside = 0, holes = 0, outside = 0, spilled = 0;
        for (int y = 0; y < s.height; ++y) {
            for (int x = 0; x < s.width; ++x) {
                const double r = std::hypot(x + 0.5 - s.width / 2.0, y + 0.5 - s.height / 2.0);
                const bool shown = !std::isinf(depth(frame, x, y));
                inside += r < silhouette - 2 ? 1 : 0;
                holes += r < silhouette - 2 && !shown ? 1 : 0;
                outside += r > silhouette + s.spacingPx ? 1 : 0;
                spilled += r > silhouette + s.spacingPx && shown ? 1 : 0;
                ASSERT_EQ(pixel(frame, x, y), shown ? green : (Rgb8{0, 0, 0}));
            }
        }
        EXPECT_LE(holes / inside, 0.001) << nameOf(s);
        EXPECT_LE(spilled / outside, 0.05) << nameOf(s);
        // The light comes from the viewer's side: the middle is brighter than the lower right rim.
        const int rim = static_cast<int>(0.65 * silhouette);
        EXPECT_GT(pixel(lit, s.width / 2, s.height / 2)[1],
                  pixel(lit, s.width / 2 + rim, s.height / 2 + rim)[1] + 30)
            << nameOf(s);
    }
}

TEST_P(PyramidMethod, HidesTheRearSheetUpToThePicturesBorder) {
    // A green sheet before a red one: not one pixel in a hundred may be red or empty, the outermost ones
    // included, which is what the guard band is for.
    for (const PictureSetting& s : pictureSettings(slow_)) {
        const Viewpoint view = s.perspective
                                   ? lookAt({0, -10, 0}, {0, 0, 0}, s.width, s.height, 50)
                                   : lookAtOrthographic({0, -10, 0}, {0, 0, 0}, s.width, s.height, 9);
        const double spacing = s.spacingPx / view.q(10), gap = 6.6 * spacing;
        Numbers numbers(86);
        std::vector<AnalyticPoint> points;
        for (const double behind : {0.0, gap}) {
            const double halfHeight = 0.65 * s.height / view.q(10 + behind);
            const double halfWidth = halfHeight * s.width / s.height;
            for (double z = -halfHeight; z < halfHeight; z += spacing) {
                for (double x = -halfWidth; x < halfWidth; x += spacing) {
                    const auto noise = [&] { return numbers.uniform(-0.3, 0.3) * spacing; };
                    AnalyticPoint p;
                    p.position = {x + noise(), behind + noise(), z + noise()};
                    p.rgb = behind > 0 ? red : green;
                    points.push_back(p);
                }
            }
        }
        const AnalyticCloud cloud(points, spacing);
        const Frame frame = drawn(*device_, view, cloud, spacing);
        double wrong = 0, wrongAtBorder = 0, border = 0;
        for (int y = 0; y < s.height; ++y) {
            for (int x = 0; x < s.width; ++x) {
                const bool atBorder = x < 8 || y < 8 || x >= s.width - 8 || y >= s.height - 8;
                const bool bad = pixel(frame, x, y) != green;
                wrong += bad ? 1 : 0;
                border += atBorder ? 1 : 0;
                wrongAtBorder += atBorder && bad ? 1 : 0;
            }
        }
        EXPECT_LE(wrong / (s.width * s.height), 0.01) << nameOf(s);
        EXPECT_LE(wrongAtBorder / border, 0.02) << nameOf(s);
    }
}

}  // namespace
}  // namespace scancast::test
