// Device against device: the cpu device and the gl device share no code beyond the interface, so where both
// draw the same picture, a fault would have to be made twice. Asked for: at least 45 dB and 99 % identical
// pixels.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "renderer/method/method.hpp"
#include "tests/support/pictures/agreement.hpp"
#include "tests/support/pictures/analytic_cut.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"
#include "tests/support/pictures/faded_cut.hpp"

namespace scancast::test {
namespace {

/// A noisily coloured ball before a tilted wall, a few points behind the eye and far outside the picture, and
/// every attribute that a colour or a filter asks for.
AnalyticCloud scene() {
    Numbers numbers(7);
    std::vector<AnalyticPoint> points;
    const auto add = [&](glm::dvec3 position, glm::vec3 normal) {
        points.push_back({position, numbers.color(), static_cast<std::uint16_t>(numbers.next()),
                          static_cast<std::uint8_t>(numbers.next() % 20), encodeNormal(normal)});
    };
    for (int i = 0; i < 30000; ++i) {
        const glm::dvec3 n = numbers.onSphere();
        add(n, glm::vec3(n));
    }
    for (int i = 0; i < 30000; ++i) {
        const double x = numbers.uniform(-4, 4), z = numbers.uniform(-3, 3);
        add({x, 2 + 0.5 * x, z}, {0.447f, -0.894f, 0});
    }
    for (int i = 0; i < 200; ++i) add(numbers.onSphere() * numbers.uniform(5, 50), {0, 0, 1});
    return AnalyticCloud(points, 0.03);
}

const AnalyticCloud& sharedScene() {
    static const AnalyticCloud cloud = scene();
    return cloud;
}

constexpr int width = 403, height = 301;  // no multiple of any work group

Viewpoint viewpoint(Projection projection) {
    return projection == Projection::Perspective
               ? lookAt({0.3, -4, 1}, {0, 0, 0}, width, height, 50)
               : lookAtOrthographic({0.3, -4, 1}, {0, 0, 0}, width, height, 3.5);
}

ColorRule ramped(ColorSource source, double low, double high) {
    ColorRule rule;
    rule.source = source;
    rule.low = low;
    rule.high = high;
    rule.flat = {10, 200, 90};
    for (int i = 0; i < 256; ++i)
        rule.ramp[static_cast<std::size_t>(i)] = {static_cast<std::uint8_t>(i),
                                                  static_cast<std::uint8_t>(255 - i),
                                                  static_cast<std::uint8_t>(i * 7)};
    return rule;
}

ColorRule byIntensity(ColorRule rule) {
    rule.byIntensity = factors(3000, 61000);
    return rule;
}

ColorRule toned(ColorRule rule) {
    rule.toned = true;
    return rule;
}

/// Draws on both devices and holds them to the promise.
void expectAgreement(Device& gl, Device& cpu, const Drawing& drawing) {
    const auto a = gl.draw(drawing, {});
    const auto b = cpu.draw(drawing, {});
    ASSERT_TRUE(a) << a.error().message;
    ASSERT_TRUE(b) << b.error().message;
    ASSERT_EQ(a->rgba.size(), b->rgba.size());
    ASSERT_EQ(a->depth.size(), b->depth.size());
    const Agreement agreement = agreementOf(*a, *b);
    EXPECT_GE(agreement.psnr, 45);
    EXPECT_LE(agreement.part(agreement.changed), 0.01);
    EXPECT_LE(agreement.part(agreement.changedDepth), 0.01);
    EXPECT_GT(agreement.part(agreement.covered), 0.02) << "a picture of nothing proves nothing";
    std::printf("    %.1f dB, %zu pixels and %zu depths differ, %.0f %% covered\n", agreement.psnr,
                agreement.changed, agreement.changedDepth, 100 * agreement.part(agreement.covered));
}

struct MethodCase {
    const char* method;
    ParameterValues parameters;
    const char* label;
};
void PrintTo(const MethodCase& c, std::ostream* out) {
    *out << c.label;
}

const MethodCase methodCases[] = {
    {"point", {}, "point"},
    {"square", {}, "square"},
    {"circle", {}, "circle"},
    {"paraboloid", {}, "paraboloid"},
    {"cone", {}, "cone"},
    {"sphere", {}, "sphere"},
    {"paraboloid", {{"sizePx", 5.0}}, "paraboloid5px"},
    {"sphere", {{"sizePx", 23.0}}, "sphere23px"},
    {"cone", {{"sizePx", 4.0}, {"footprint", std::string("square")}}, "coneOnSquares"},
    {"paraboloid", {{"sizePx", 6.5}, {"footprint", std::string("square")}}, "paraboloidOnSquares"},
};

using AgreementCase = std::tuple<std::string, MethodCase, Projection>;
class DeviceAgreement : public testing::TestWithParam<AgreementCase> {};

PassList passesOf(const char* name, const ParameterValues& given, Shading shading) {
    const Method* method = findMethod(name);
    if (!method) throw std::runtime_error(std::string("no method ") + name);
    const auto values = resolveParameters(*method, given);
    if (!values) throw std::runtime_error(values.error().message);
    return method->passes({*method, *values, shading});
}

TEST_P(DeviceAgreement, Method) {
    const auto& [backend, method, projection] = GetParam();
    REQUIRE_DEVICE(gl, backend);
    REQUIRE_DEVICE(cpu, "cpu");
    const Viewpoint from = viewpoint(projection);
    for (const Shading shading : {Shading::Unlit, Shading::EyeDome}) {
        const PassList passes = passesOf(method.method, method.parameters, shading);
        expectAgreement(*gl, *cpu, OwnDrawing(from, sharedScene().cut(), passes));
    }
}

INSTANTIATE_TEST_SUITE_P(Gl, DeviceAgreement,
                         testing::Combine(testing::Values("egl"), testing::ValuesIn(methodCases),
                                          testing::Values(Projection::Perspective, Projection::Orthographic)),
                         [](const testing::TestParamInfo<AgreementCase>& c) {
                             return std::get<0>(c.param) + "_" + std::get<1>(c.param).label + "_" +
                                    std::string(name(std::get<2>(c.param)));
                         });

class DrawingAgreement : public testing::TestWithParam<std::string> {
  protected:
    void check(const Drawing& drawing) {
        REQUIRE_DEVICE(gl, GetParam());
        REQUIRE_DEVICE(cpu, "cpu");
        expectAgreement(*gl, *cpu, drawing);
    }
    const Viewpoint from_ = viewpoint(Projection::Perspective);
    const PassList passes_ = passesOf("paraboloid", {}, Shading::Unlit);
    const PassList lit_ = passesOf("paraboloid", {}, Shading::EyeDome);
    OwnDrawing drawing_{from_, sharedScene().cut(), passes_};
};
TEST_P(DrawingAgreement, RunsDrawnInPart) {
    const Cut faded = withShares(sharedScene().cut());
    drawing_.view().cut = faded;
    check(drawing_);
}

// Right because the second cut holds nothing but the samples that the first one draws.
TEST_P(DrawingAgreement, ARunInPartIsItsDrawnSamples) {
    REQUIRE_DEVICE(gl, GetParam());
    const Cut faded = withShares(sharedScene().cut());
    const DrawnOnly drawn(faded);
    drawing_.view().cut = faded;
    const auto inPart = gl->draw(drawing_, {});
    drawing_.view().cut = drawn.cut();
    const auto whole = gl->draw(drawing_, {});
    ASSERT_TRUE(inPart && whole);
    EXPECT_EQ(inPart->rgba, whole->rgba);
    EXPECT_EQ(inPart->depth, whole->depth);
}

INSTANTIATE_TEST_SUITE_P(Gl, DrawingAgreement, testing::Values("egl"),
                         [](const testing::TestParamInfo<std::string>& c) { return c.param; });

// Right because both devices look a sample's radius up in the same table of the same bits.
TEST_P(DrawingAgreement, SamplesWithRadiiOfTheirOwn) {
    Numbers numbers(8);
    std::vector<AnalyticPoint> points(20'000);
    for (AnalyticPoint& p : points) {
        p.position = numbers.onSphere();
        p.rgb = numbers.color();
        Surfel surfel;
        surfel.normal = glm::vec3(p.position);
        surfel.radius = static_cast<float>(numbers.uniform(0.005, 0.05));
        surfel.outlier = numbers.uniform() < 0.02;
        p.surfel = surfel;
    }
    const AnalyticCloud cloud(points, 0.02);
    drawing_.view().cut = cloud.cut();
    drawing_.surfels = true;
    for (const char* method : {"paraboloid", "square", "circle", "sphere"}) {
        SCOPED_TRACE(method);
        const PassList passes = passesOf(method, {}, Shading::Unlit);
        drawing_.passes = passes;
        check(drawing_);
    }
}

TEST_P(DrawingAgreement, EveryColorSource) {
    const ColorRule rules[] = {
        ramped(ColorSource::Rgb, 0, 1),        ramped(ColorSource::Intensity, 5000, 60000),
        ramped(ColorSource::Elevation, -1, 2), ramped(ColorSource::Classification, 0, 0),
        ramped(ColorSource::Normal, 0, 0),     ramped(ColorSource::Curvature, -1, 2),
        ramped(ColorSource::Depth, 3, 7),      ramped(ColorSource::Lod, 0, 0),
        ramped(ColorSource::Flat, 0, 0),       ramped(ColorSource::Elevation, 0.5, 0.5),
        toned(ramped(ColorSource::Rgb, 0, 1)), byIntensity(ramped(ColorSource::Elevation, -1, 2)),
        ramped(ColorSource::Infrared, 0, 1),
    };
    for (const ColorRule& rule : rules) {
        SCOPED_TRACE(std::string(name(rule.source)));
        drawing_.color = rule;
        check(drawing_);
    }
}

TEST_P(DrawingAgreement, Filters) {
    drawing_.view().filter.classes.emplace();
    for (std::size_t c = 0; c < 256; c += 3) (*drawing_.view().filter.classes)[c] = true;
    check(drawing_);
    drawing_.view().filter.clip = ClipBox{{-0.5, -1, -0.4}, {0.75, 3, 0.9}};
    check(drawing_);
}

TEST_P(DrawingAgreement, Backgrounds) {
    for (const auto kind :
         {Background::Kind::Color, Background::Kind::Gradient, Background::Kind::Transparent}) {
        drawing_.background.kind = kind;
        check(drawing_);
    }
}

TEST_P(DrawingAgreement, WindowsAndNearAndFar) {
    Viewpoint cut = from_;
    cut.near = 3.3;
    cut.far = 5;
    drawing_.view().viewpoint = cut;
    drawing_.window = {97, 61, 203, 105};
    check(drawing_);
    drawing_.passes = lit_;
    check(drawing_);
}

TEST_P(DrawingAgreement, AveragedFramesOnTransparency) {
    const glm::dvec2 jitter[] = {{0.25, -0.1}, {-0.375, 0.4}, {0.01, 0.2}};
    drawing_.jitter = jitter;
    drawing_.passes = lit_;
    drawing_.background.kind = Background::Kind::Transparent;
    check(drawing_);
}

/// Far from the origin floats are coarse: what is not composed in double would jitter by pixels.
TEST_P(DrawingAgreement, FarFromTheOrigin) {
    Numbers numbers(11);
    std::vector<AnalyticPoint> points;
    const glm::dvec3 offset(81234.5, -60321.25, 912.75);
    for (int i = 0; i < 40000; ++i) points.push_back({offset + numbers.onSphere(), numbers.color()});
    const AnalyticCloud cloud(points, 0.03);
    const Viewpoint from = lookAt(offset + glm::dvec3(0.3, -4, 1), offset, width, height, 50);
    drawing_.view().viewpoint = from;
    drawing_.view().cut = cloud.cut();
    check(drawing_);
}

/// Several runs a page, chunks that end early, runs larger than a chunk.
TEST_P(DrawingAgreement, RunsOfEverySize) {
    Numbers numbers(3);
    std::vector<AnalyticPoint> points;
    for (int i = 0; i < 30011; ++i) points.push_back({numbers.onSphere(), numbers.color()});
    for (const std::uint32_t leaf : {1000u, 1025u, 30011u}) {
        const AnalyticCloud cloud(points, 0.03, leaf);
        drawing_.view().cut = cloud.cut();
        check(drawing_);
    }
}

}  // namespace
}  // namespace scancast::test
