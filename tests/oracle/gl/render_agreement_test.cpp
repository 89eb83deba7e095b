// Device against device through the front door: generated scenes with levels of detail, surfels and a mirror,
// in every method, and everything that a style or a quality can ask for. The devices share the host's
// arithmetic, but neither kernels nor memory nor tiles.
//
// Asked for: at least 45 dB. A driver that contracts nothing (shaders say `precise`) and rounds quotients and
// roots correctly, by itself or corrected (shaders/exact.glsl), computes what the processor does, so there
// the methods that only keep the nearest sample must give the same bytes. Where no correction helps, a sample
// may fall on the other side of a pixel's border; hence decibels.
#include <gtest/gtest.h>

#include <map>

#include "renderer/device/gl/gl_device.hpp"
#include "renderer/method/automatic.hpp"
#include "renderer/method/method.hpp"
#include "tests/support/clouds/scene_clouds.hpp"
#include "tests/support/pictures/agreement.hpp"
#include "tests/support/pictures/devices.hpp"

namespace scancast::test {
namespace {

constexpr std::uint64_t agreedPoints = 50'000;
constexpr int agreedWidth = 301, agreedHeight = 203;  // no multiple of any work group
constexpr Projection projections[] = {Projection::Perspective, Projection::Orthographic};

/// Only integers are compared and kept: what lies nearest, by its depth's bits.
bool onlyKeepsTheNearest(const View& view) {
    const Method& method = *findMethod(view.style.method);
    const bool blends =
        method.name == "hqs" || method.name == "ewa" || method.name == "voronoi" || method.name == "pyramid";
    return !blends && view.style.shading.value_or(method.defaultShading) == Shading::Unlit;
}

/// Built once for all tests of this program.
const Cloud& agreedCloud(const std::string& scene) {
    static std::map<std::string, std::shared_ptr<const Cloud>> clouds;
    auto& cloud = clouds[scene];
    if (!cloud) cloud = sceneCloud(scene, agreedPoints).value();
    return *cloud;
}

void expectPicturesAgree(Device& gl, Device& cpu, const Cloud& cloud, const View& view,
                         const RenderOptions& options = {}) {
    const auto a = render(gl, cloud, view, options), b = render(cpu, cloud, view, options);
    ASSERT_TRUE(b) << b.error().message;
    ASSERT_TRUE(a) << a.error().message;
    EXPECT_EQ(a->stats.samplesDrawn, b->stats.samplesDrawn);
    EXPECT_EQ(a->stats.mirrorsDrawn, b->stats.mirrorsDrawn);
    const Agreement agreement = agreementOf(*a, *b);
    EXPECT_GE(agreement.psnr, 45);
    EXPECT_LE(agreement.part(agreement.changedDepth), 0.01);
    EXPECT_GT(agreement.part(agreement.covered), 0.05) << "a picture of nothing proves nothing";
    if (gl.info().exact && onlyKeepsTheNearest(view)) {
        EXPECT_TRUE(agreement.identical())
            << agreement.changed << " pixels and " << agreement.changedDepth << " depths differ";
    }
}

/// Of paraboloids, one sample a pixel, borders smoothed.
View smoothView(View view) {
    view.style.method = "paraboloid";
    view.style.parameters["smooth"] = true;
    view.quality.samples = 1;
    return view;
}

/// Calls work(view) for every method.
template <class Work>
void inEveryMethod(View view, const Work& work) {
    for (const Method& method : methods()) {
        if (method.name == automaticName) continue;
        SCOPED_TRACE(method.name);
        view.style.method = method.name;
        work(view);
    }
}

/// On one device or the other, a scene.
class SceneAgreement : public OnDeviceWith<std::tuple<std::string, std::string>> {};

TEST_P(SceneAgreement, InEveryMethodAndProjection) {
    REQUIRE_DEVICE(cpu, "cpu");
    const auto& [device, scene] = GetParam();
    const Cloud& cloud = agreedCloud(scene);
    for (const Projection projection : projections) {
        SCOPED_TRACE(std::string(name(projection)));
        inEveryMethod(sceneView(cloud, sceneViews(scene)[0], projection, agreedWidth, agreedHeight),
                      [&](const View& view) { expectPicturesAgree(*device_, *cpu, cloud, view); });
    }
}

/// Both backends run the same driver where there is no graphics card: one scene will show that OSMesa draws
/// it, too.
std::vector<std::tuple<std::string, std::string>> deviceScenes() {
    std::vector<std::tuple<std::string, std::string>> all{{"osmesa", "town"}};
    for (const char* scene : {"town", "statue", "sign", "cube", "torus", "bridge"})
        all.emplace_back("egl", scene);
    return all;
}
INSTANTIATE_TEST_SUITE_P(Gl, SceneAgreement, testing::ValuesIn(deviceScenes()),
                         [](const auto& p) { return std::get<0>(p.param) + "_" + std::get<1>(p.param); });

/// As on a graphics card whose own quotients and roots are as far off as OpenGL allows.
struct SpoiltArithmetic {
    const char* name;
    gl::Arithmetic arithmetic;
    bool agrees;
};
class ArithmeticAgreement : public testing::TestWithParam<SpoiltArithmetic> {};

TEST_P(ArithmeticAgreement, CorrectedQuotientsAndRootsGiveTheCpusBytes) {
    REQUIRE_DEVICE(cpu, "cpu");
    const auto device = createEglDevice(-1, {.arithmetic = GetParam().arithmetic});
    if (!device) GTEST_SKIP() << "MISSING BACKEND egl: " << device.error().message;
    const Cloud& cloud = agreedCloud("town");
    std::size_t others = 0;
    for (const Projection projection : projections) {
        SCOPED_TRACE(std::string(name(projection)));
        // That nothing is right by itself, one projection will show.
        if (!GetParam().agrees && projection == Projection::Orthographic) continue;
        const View from = sceneView(cloud, sceneViews("town")[0], projection, agreedWidth, agreedHeight);
        const auto compare = [&](const View& view) {
            const auto a = render(**device, cloud, view), b = render(*cpu, cloud, view);
            ASSERT_TRUE(a && b);
            const Agreement agreement = agreementOf(*a, *b);
            others += !agreement.identical();
            if (GetParam().agrees) {
                EXPECT_TRUE(agreement.identical())
                    << agreement.changed << " pixels and " << agreement.changedDepth << " depths differ, "
                    << agreement.psnr << " dB";
            }
        };
        inEveryMethod(from, compare);
        compare(smoothView(from));
    }
    if (!GetParam().agrees) {
        EXPECT_GT(others, 0u) << "pictures do not hang on quotients and roots, it seems";
    }
}
INSTANTIATE_TEST_SUITE_P(
    Gl, ArithmeticAgreement,
    testing::Values(
        SpoiltArithmetic{"corrected", {.rounding = gl::Rounding::BySplitting, .rough = true}, true},
        SpoiltArithmetic{"left_as_it_is", {.rounding = gl::Rounding::Own, .rough = true}, false}),
    [](const auto& p) { return p.param.name; });

/// A room with a mirror, and what a view can ask for besides.
class ViewAgreement : public OnDevice {
  protected:
    void SetUp() override {
        REQUIRE_DEVICE(cpu, "cpu");
        cpu_ = cpu;
        OnDevice::SetUp();
    }
    View view(Projection projection = Projection::Perspective, std::size_t from = 0) const {
        return sceneView(cloud_, sceneViews("room")[from], projection, agreedWidth, agreedHeight);
    }
    void check(const View& view, const RenderOptions& options = {}) {
        expectPicturesAgree(*device_, *cpu_, cloud_, view, options);
    }
    Device* cpu_ = nullptr;
    const Cloud& cloud_ = agreedCloud("room");
};
INSTANTIATE_TEST_SUITE_P(Gl, ViewAgreement, testing::Values("egl"), deviceName);
/// A suite, and a process, of its own: each colour compiles shaders of its own.
using ColourAgreement = ViewAgreement;
INSTANTIATE_TEST_SUITE_P(Gl, ColourAgreement, testing::Values("egl"), deviceName);

TEST_P(ViewAgreement, Mirrors) {
    for (const Projection projection : projections) {
        inEveryMethod(view(projection), [&](View v) {
            check(v);
            v.style.mirrors = false;
            v.style.behindMirrors = true;
            check(v);
        });
    }
}

TEST_P(ViewAgreement, Shadings) {
    inEveryMethod(view(Projection::Perspective, 1), [&](View v) {
        for (const Shading shading : {Shading::Unlit, Shading::Phong, Shading::EyeDome}) {
            SCOPED_TRACE(std::string(name(shading)));
            v.style.shading = shading;
            check(v);
        }
    });
}

TEST_P(ColourAgreement, Sources) {
    for (const char* method : {"paraboloid", "hqs", "disc", "ewa", "voronoi", "pyramid"}) {
        View v = view(Projection::Orthographic, 1);
        v.style.method = method;
        for (const ColorSource color :
             {ColorSource::Intensity, ColorSource::Elevation, ColorSource::Classification,
              ColorSource::Normal, ColorSource::Curvature, ColorSource::Depth, ColorSource::Lod,
              ColorSource::Flat}) {
            SCOPED_TRACE(std::string(method) + ", " + std::string(name(color)));
            v.style.color = color;
            v.style.flatColor = {10, 200, 90};
            check(v);
        }
        if (v.style.method == "pyramid") {
            v.style.color = ColorSource::Visibility;
            check(v);
        }
        v.style.color = ColorSource::Rgb;
        v.style.exposure = 1.5;
        v.style.byIntensity = true;
        check(v);
    }
}

/// Every colour looks up whose cell it is another way, and mirrors are layers of their own.
TEST_P(ColourAgreement, SmoothBorders) {
    View v = smoothView(view());
    for (const Projection projection : projections) {
        const View from = view(projection);
        v.camera = from.camera;
        for (const Shading shading : {Shading::Unlit, Shading::Phong}) {
            v.style.shading = shading;
            v.quality.samples = 1;
            check(v);
            View hard = v;
            hard.style.parameters["smooth"] = false;
            EXPECT_NE(render(*cpu_, cloud_, hard)->rgba, render(*cpu_, cloud_, v)->rgba);
            // Several samples a pixel smooth by themselves.
            v.quality.samples = hard.quality.samples = 3;
            EXPECT_EQ(render(*cpu_, cloud_, hard)->rgba, render(*cpu_, cloud_, v)->rgba);
        }
    }
    v.quality.samples = 1;
    for (const ColorSource color : {ColorSource::Elevation, ColorSource::Depth, ColorSource::Flat}) {
        v.style.color = color;
        check(v);
    }
}

TEST_P(ViewAgreement, ClipAndClasses) {
    View from = view(Projection::Perspective, 1);
    from.style.clip = ClipBox{{-1.1, -1.2, 0.3}, {1.7, 1.9, 2}};
    inEveryMethod(from, [&](const View& v) { check(v); });
    // Only the town has classes.
    const Cloud& town = agreedCloud("town");
    from = sceneView(town, sceneViews("town")[0], Projection::Perspective, agreedWidth, agreedHeight);
    from.style.classes = std::vector<std::uint8_t>{2, 6};
    inEveryMethod(from, [&](const View& v) { expectPicturesAgree(*device_, *cpu_, town, v); });
}

TEST_P(ViewAgreement, Shapes) {
    const Cloud& town = agreedCloud("town");
    glm::dvec3 middle = (town.bounds[0] + town.bounds[1]) * 0.5;
    middle.z = town.bounds[0].z + 5;
    View from = sceneView(town, sceneViews("town")[0], Projection::Perspective, agreedWidth, agreedHeight);
    // Kept: what is in one of three, crossing each other. Taken away: two, and what lies behind a leaning plane.
    for (const double yaw : {0.0, 40.0, 100.0})
        from.style.clips.push_back(TurnedBox{middle, {180, 50, 80}, {yaw, 5, 0}});
    from.style.clips.push_back(TurnedBox{middle + glm::dvec3(10, 5, 0), {12, 8, 40}, {20, 0, 0}, true});
    from.style.clips.push_back(TurnedBox{middle - glm::dvec3(15, 0, 0), {9, 9, 9}, {0, 0, 0}, true});
    from.style.clips.push_back(HalfSpace{middle + glm::dvec3(0, 0, 15), {0.1, 0.2, -1}});
    inEveryMethod(from, [&](const View& v) { expectPicturesAgree(*device_, *cpu_, town, v); });
}

TEST_P(ViewAgreement, AveragedFramesOnTransparency) {
    View from = view();
    from.quality.samples = 3;
    from.style.background.kind = Background::Kind::Transparent;
    inEveryMethod(from, [&](const View& v) { check(v); });
}

TEST_P(ViewAgreement, LevelsThatFadeAndNone) {
    inEveryMethod(view(Projection::Perspective, 1), [&](View v) {
        v.quality.detail = 5;
        check(v);
        v.quality.detail = std::nullopt;
        check(v, {.bruteForce = true});
    });
}

/// Larger than a tile: drawn in two by the cpu device, which share the mirror, and in one piece where there is
/// memory for that.
TEST_P(ViewAgreement, Tiles) {
    View from = view();
    from.width = 2304;
    from.height = 120;
    inEveryMethod(from, [&](const View& v) { check(v); });
}

/// Draws what another draws, as many pixels at once as it is told.
class AtOnce : public Device {
  public:
    AtOnce(Device& device, std::int64_t pixels) : device_(device), pixels_(pixels) {}
    DeviceInfo info() const override { return device_.info(); }
    DeviceMemory* memory() override { return device_.memory(); }
    std::int64_t pixelsAtOnce() const override { return pixels_; }
    Expected<Frame> draw(const Drawing& drawing, std::stop_token stop) override {
        ++pieces;
        return device_.draw(drawing, std::move(stop));
    }
    Expected<std::unique_ptr<PendingFrame>> begin(const Drawing& drawing, std::stop_token stop) override {
        ++pieces;
        return device_.begin(drawing, std::move(stop));
    }
    int pieces = 0;

  private:
    Device& device_;
    const std::int64_t pixels_;
};

/// What a device draws at once depends on its memory, and a picture's bytes do not. Oracle: the same picture
/// in tiles, and where it must be, the cpu device's.
TEST_P(ViewAgreement, OnePieceHasTheBytesOfItsTiles) {
    const RenderOptions options{.tileSide = 128};
    const auto compare = [&](const View& v) {
        AtOnce tiles(*device_, 0), piece(*device_, 1 << 20);
        const auto a = render(tiles, cloud_, v, options), b = render(piece, cloud_, v, options);
        ASSERT_TRUE(a) << a.error().message;
        ASSERT_TRUE(b) << b.error().message;
        EXPECT_EQ(tiles.pieces, 6);
        EXPECT_EQ(piece.pieces, v.style.method == "pyramid" ? 6 : 1);
        EXPECT_EQ(b->rgba.lent(), piece.pieces == 1);
        EXPECT_EQ(a->rgba, b->rgba);
        EXPECT_EQ(a->depth, b->depth);
        expectPicturesAgree(piece, *cpu_, cloud_, v, options);
    };
    inEveryMethod(view(), compare);
    compare(smoothView(view()));
}

/// Occlusion looks beyond a tile, and shadows come from far beyond. Oracle: as above.
TEST_P(ViewAgreement, LightHasTheBytesOfItsTiles) {
    const RenderOptions options{.tileSide = 128};
    View v = view();
    v.style.light.sun = {{200, 35}};
    v.style.light.shadow = 0.9;
    v.style.light.occlusion = 0.8;
    v.quality.samples = 2;
    using enum scancast::Shading;
    for (const auto& [method, shading] : {std::pair{"paraboloid", Unlit}, {"ewa", Phong}, {"hqs", EyeDome}}) {
        v.style.method = method;
        v.style.shading = shading;
        AtOnce tiles(*device_, 0), piece(*device_, 1 << 20);
        const auto a = render(tiles, cloud_, v, options), b = render(piece, cloud_, v, options);
        ASSERT_TRUE(a) << a.error().message;
        ASSERT_TRUE(b) << b.error().message;
        EXPECT_EQ(piece.pieces, 1);
        EXPECT_EQ(a->rgba, b->rgba) << method;
        expectPicturesAgree(piece, *cpu_, cloud_, v, options);
    }
}

}  // namespace
}  // namespace scancast::test
