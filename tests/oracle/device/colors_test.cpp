// Colours through the front door, docs/spec/shading.md §4, §7 and §8: points that stand alone, a pixel each, against the
// formulas in double. Right because nothing else is in such a picture: a pixel's colour is its point's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "protocol/view/view_words.hpp"
#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/device/cpu/simd_level.hpp"
#include "renderer/image/colormap.hpp"
#include "renderer/render.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"

namespace scancast::test {
namespace {

constexpr int side = 16, pitch = 4;  // points, and px between them
constexpr double zStep = 0.1;
/// Odd, and so few that floats put no intensity on the other side of where rounding turns.
constexpr std::uint32_t leastIntensity = 1000, greatestIntensity = 5999;

/// The i-th point: every channel takes every value, and every entry of a ramp is met.
struct Point {
    explicit Point(std::size_t i)
        : rgb{std::uint8_t(i), std::uint8_t(255 - i), std::uint8_t(7 * i)},
          intensity(static_cast<std::uint16_t>(i * 27)),
          classification(static_cast<std::uint8_t>(i % 20)),
          height(101 * i % 256),
          number(i) {}
    Rgb8 rgb;
    std::uint16_t intensity;  // some below, some above the cloud's range
    std::uint8_t classification;
    std::size_t height;  // in 255ths of the cloud's
    std::size_t number;
};

std::vector<Sample> samples() {
    std::vector<Sample> made(side * side);
    for (std::size_t i = 0; i < made.size(); ++i) {
        const Point p(i);
        Sample& s = made[i];
        s.x = static_cast<std::uint16_t>(i % side * (65535 / (side - 1)));
        s.y = static_cast<std::uint16_t>(i / side * (65535 / (side - 1)));
        s.z = static_cast<std::uint16_t>(p.height * 257);
        s.intensity = p.intensity;
        s.r = p.rgb[0];
        s.g = p.rgb[1];
        s.b = p.rgb[2];
        s.classification = p.classification;
    }
    return made;
}

std::uint8_t infrared(std::size_t number) {
    return static_cast<std::uint8_t>(number * 37 + 11);
}

/// Mean curvatures from -64 to 64 in 1 / unit, and what nobody knows, in the leaf's unit; and near infrared.
std::vector<BesideWord> beside() {
    std::vector<BesideWord> made(side * side);
    for (std::size_t i = 0; i < made.size(); ++i)
        made[i] = withNearInfrared(static_cast<CurvatureCode>((i * 7 % 98 + (i % 2) * 158) % 256 |
                                                              (i * 5 % 90) << 8 | (i % 32) << 16),
                                   infrared(i));
    return made;
}

/// One leaf: a grid in x and y, at all heights.
Cloud grid() {
    Cloud cloud;
    cloud.origin = {500'000, 4'000'000, 100};
    const glm::dvec3 size(side - 1, side - 1, 255 * zStep);
    cloud.bounds = {cloud.origin, cloud.origin + size};
    cloud.points = side * side;
    cloud.attributes.color = cloud.attributes.intensity = cloud.attributes.classification = true;
    cloud.intensityRange = {leastIntensity, greatestIntensity};
    cloud.spacing = 1;
    Node node{};
    node.boxMax = size;
    node.step = size / 65535.0;
    node.center = size / 2.0;
    node.radius = 20;
    node.spacing = node.meanSpacing = 1;
    node.sampleCount = side * side;
    node.points = side * side;
    node.radiusUnit = 0.125f;
    cloud.companions = {curvaturePlane(), nearInfraredPlane()};
    cloud.usual.emplace().curvature = {-8, 3};
    cloud.octree = Octree({node}, samples(), beside());
    return cloud;
}

/// From above, every point in the middle of a pixel.
View view(const Cloud& cloud, const std::string& color, const std::string& exposure) {
    View from;
    from.width = from.height = side * pitch + 1;
    from.camera.projection = Projection::Orthographic;
    from.camera.viewHeight = side + 1.0 / pitch;
    from.camera.target = (cloud.bounds[0] + cloud.bounds[1]) / 2.0;
    from.camera.eye = from.camera.target + glm::dvec3(0, 0, 100);
    from.camera.up = {0, 1, 0};
    from.style.method = "point";
    from.quality.samples = 1;
    return applyWords(from, {{"color", color}, {"exposure", exposure}}).value();
}

/// docs/spec/shading.md §8, for one channel.
double exposed(double value, double stops) {
    if (stops == 0) return value;
    const double s = value / 255, gain = std::pow(2, stops);
    double light = gain * (s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
    if (gain > 1 && light > 0.5) {
        const double over = light - 0.5;
        light = 0.5 + over / (1 + (2 - 1 / (gain - 0.5)) * over);
    }
    return std::round(255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055));
}

Rgb8 plainColor(const Point& p, std::string_view source, double stops) {
    if (source == "elevation") return (*colormap("viridis"))[p.height];
    if (source == "curvature") {
        const Curvature c = decodeCurvature(curvatureIn(beside()[p.number]), {0, 0, 1}, 0.125f);
        const double t = (0.5 * (double(c.k1) + double(c.k2)) + 8) / 16;
        return curvatureColors()[std::size_t(std::lround(255 * std::clamp(t, 0.0, 1.0)))];
    }
    if (source == "classification") return classificationColors()[p.classification];
    if (source == "#ff8800") return {255, 136, 0};
    const Rgb8 measured = source == "cir" ? Rgb8{infrared(p.number), p.rgb[0], p.rgb[1]} : p.rgb;
    Rgb8 color;
    for (std::size_t c = 0; c < 3; ++c) color[c] = static_cast<std::uint8_t>(exposed(measured[c], stops));
    return color;
}

/// §7: 0.45 where intensity is least, 1.15 where it is greatest, in 256 steps and in 256ths.
Rgb8 expectedColor(const Point& p, std::string_view color, double stops) {
    const auto star = color.find('*');
    Rgb8 result = plainColor(p, color.substr(0, star), stops);
    if (star == std::string_view::npos) return result;
    const double range = greatestIntensity - leastIntensity;
    const double t = std::clamp((p.intensity - double(leastIntensity)) / range, 0.0, 1.0);
    const double factor = std::round(256 * (0.45 + 0.7 * std::round(255 * t) / 255));
    for (auto& channel : result)
        channel = static_cast<std::uint8_t>(std::min(255.0, std::floor((channel * factor + 128) / 256)));
    return result;
}

void expectColors(Device& device, const std::string& color, const std::string& exposure, double stops) {
    SCOPED_TRACE("color=" + color + "&exposure=" + exposure + " on " + device.info().renderer);
    const Cloud cloud = grid();
    const auto frame = render(device, cloud, view(cloud, color, exposure));
    ASSERT_TRUE(frame) << frame.error().message;
    for (std::size_t i = 0; i < side * side; ++i) {
        const int x = pitch / 2 + int(i % side) * pitch;
        const int y = pitch / 2 + (side - 1 - int(i / side)) * pitch;
        ASSERT_TRUE(std::isfinite(depth(*frame, x, y))) << i;
        ASSERT_EQ(pixel(*frame, x, y), expectedColor(Point(i), color, stops)) << i;
    }
}

void expectAllColors(Device& device) {
    for (const char* color : {"rgb", "cir", "curvature", "rgb*intensity", "elevation*intensity",
                              "classification*intensity", "#ff8800*intensity"}) {
        expectColors(device, color, "auto", 0);
        for (const double stops : {-3.0, -0.5, 0.25, 3.0})
            expectColors(device, color, std::to_string(stops), stops);
    }
}

class PointColors : public OnDevice {};
SCANCAST_ON_DEVICES(PointColors, "egl");

TEST_P(PointColors, AreTheFormulas) {
    expectAllColors(*device_);
}

TEST(PointColorsOfKernels, AreTheFormulasAtEverySimdLevel) {
    for (const cpu::SimdLevel& level : cpu::simdLevels()) {
        if (!level.available()) continue;
        setenv("SCANCAST_SIMD", std::string(level.name).c_str(), 1);
        const auto device = createCpuDevice(2).value();
        unsetenv("SCANCAST_SIMD");
        expectAllColors(*device);
    }
}

}  // namespace
}  // namespace scancast::test
