#include "renderer/device/cpu/cpu_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "tests/support/pictures/draw_cut.hpp"
#include "tests/support/sized.hpp"

namespace scancast::test {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

class CpuDeviceTest : public testing::Test {
  protected:
    std::unique_ptr<Device> device_ = createCpuDevice(2).value();
    /// 64 × 48 px, looking along +Y from 10 units away: (0, 0, 0) is at the middle, depth 10.
    Viewpoint view_ = lookAt({0, -10, 0}, {0, 0, 0}, 64, 48);

    Frame draw(const Cut& cut, const NearestPass& pass) {
        Scene scene(view_, cut, pass);
        return mustDraw(*device_, scene.drawing);
    }
    static AnalyticCloud one(glm::dvec3 place, Rgb8 color = {200, 100, 50}) {
        AnalyticPoint p;
        p.position = place;
        p.rgb = color;
        p.intensity = 1000;
        p.classification = 6;
        p.normal = encodeNormal({0, 0, 1});
        return {std::vector{p}, 0.1};
    }
};

TEST_F(CpuDeviceTest, AnEmptyCutIsBackground) {
    const Frame f = draw(Cut{}, sprite(Footprint::Circle, Profile::Paraboloid, 5));
    EXPECT_EQ(std::ranges::count(f.depth, infinity), 64 * 48);
    EXPECT_EQ(pixel(f, 3, 3), (Rgb8{0, 0, 0}));
    EXPECT_EQ(alpha(f, 3, 3), 255);
}

TEST_F(CpuDeviceTest, OneSampleCoversItsPixelAtItsDepthWhateverItsShapeAndSize) {
    // A quarter of a pixel right of and below the picture's middle: pixel (32, 24).
    const double quarter = 0.25 * 10 / view_.pixelsPerUnit;
    const AnalyticCloud cloud = one({quarter, 0, -quarter});
    for (const Footprint footprint : {Footprint::Pixel, Footprint::Square, Footprint::Circle}) {
        for (const Profile profile : {Profile::Flat, Profile::Paraboloid, Profile::Cone, Profile::Sphere}) {
            for (const float px : {0.0f, 0.01f, 0.5f, 1.0f, 1.5f, 3.0f, 6.0f, 20.0f, 256.0f}) {
                const Frame f = draw(cloud.cut(), sprite(footprint, profile, px));
                EXPECT_EQ(pixel(f, 32, 24), (Rgb8{200, 100, 50})) << px;
                EXPECT_FLOAT_EQ(depth(f, 32, 24), 10) << px;
                if (px <= 1 && px > 0) {
                    EXPECT_EQ(std::ranges::count(f.depth, infinity), 64 * 48 - 1) << px;
                }
            }
        }
    }
}

TEST_F(CpuDeviceTest, SplatsWithTheirCentreOutsideReachIn) {
    // 2 px left of the picture's left border, 9 px wide: columns 0, 1 and 2 are within 4.5 px.
    const AnalyticCloud cloud = one({-34 * 10 / view_.pixelsPerUnit, 0, 0});
    const Frame f = draw(cloud.cut(), sprite(Footprint::Square, Profile::Flat, 9));
    EXPECT_EQ(pixel(f, 0, 24), (Rgb8{200, 100, 50}));
    EXPECT_EQ(pixel(f, 1, 24), (Rgb8{200, 100, 50}));
    EXPECT_EQ(pixel(f, 3, 24), (Rgb8{0, 0, 0}));
}

TEST_F(CpuDeviceTest, NearAndFarDropSamples) {
    const AnalyticCloud cloud = one({0.01, 0, -0.01});
    const auto visible = [&](double near, double far) {
        view_.near = near;
        view_.far = far;
        return draw(cloud.cut(), sprite(Footprint::Circle, Profile::Cone, 3)).depth[24 * 64 + 32] < infinity;
    };
    EXPECT_TRUE(visible(1, 100));
    EXPECT_TRUE(visible(9.99, 10.01));
    EXPECT_FALSE(visible(10.01, 100));
    EXPECT_FALSE(visible(1, 9.99));
    EXPECT_TRUE(visible(1, std::numeric_limits<double>::infinity()));
}

TEST_F(CpuDeviceTest, NothingBehindTheEyeOrAtItIsDrawn) {
    Numbers numbers(1);
    std::vector<AnalyticPoint> points(5000);
    for (AnalyticPoint& p : points)
        p.position = glm::dvec3(0, -10, 0) + numbers.onSphere() * numbers.uniform(0, 3);
    points[0].position = {0, -10, 0};
    const AnalyticCloud cloud(points, 0.1, 512);
    for (const float px : {0.0f, 1.0f, 5.0f, 40.0f}) {
        for (const Projection projection : {Projection::Perspective, Projection::Orthographic}) {
            view_.projection = projection;
            view_.near = 0;
            const Frame f = draw(cloud.cut(), sprite(Footprint::Circle, Profile::Sphere, px));
            for (const float d : f.depth) ASSERT_TRUE(d > 0 && (d <= 50 || d == infinity)) << d;
        }
    }
}

TEST_F(CpuDeviceTest, EveryColourSource) {
    const AnalyticCloud cloud = one({0.01, 0, -0.01});
    Scene scene(view_, cloud.cut(), sprite(Footprint::Circle, Profile::Paraboloid, 3));
    ColorRule& rule = scene.drawing.color;
    for (std::size_t i = 0; i < 256; ++i) rule.ramp[i] = {std::uint8_t(i), std::uint8_t(255 - i), 7};
    const auto color = [&](ColorSource source, double low, double high) {
        rule.source = source;
        rule.low = low;
        rule.high = high;
        return pixel(mustDraw(*device_, scene.drawing), 32, 24);
    };
    const auto ramp = [&](int i) { return rule.ramp[static_cast<std::size_t>(i)]; };
    EXPECT_EQ(color(ColorSource::Rgb, 0, 1), (Rgb8{200, 100, 50}));
    rule.flat = {1, 2, 3};
    EXPECT_EQ(color(ColorSource::Flat, 0, 1), (Rgb8{1, 2, 3}));
    EXPECT_EQ(color(ColorSource::Intensity, 0, 2550), ramp(100));
    EXPECT_EQ(color(ColorSource::Intensity, 2000, 3000), ramp(0));
    EXPECT_EQ(color(ColorSource::Intensity, 0, 10), ramp(255));
    EXPECT_EQ(color(ColorSource::Elevation, -0.51, 0.49), ramp(128));
    EXPECT_EQ(color(ColorSource::Depth, 0, 25.5), ramp(100));
    EXPECT_EQ(color(ColorSource::Classification, 0, 1), ramp(6));
    EXPECT_EQ(color(ColorSource::Lod, 0, 1), ramp(0));
    const Rgb8 up = color(ColorSource::Normal, 0, 1);
    EXPECT_NEAR(up[0], 128, 3);
    EXPECT_NEAR(up[1], 128, 3);
    EXPECT_EQ(up[2], 255);
    EXPECT_EQ(color(ColorSource::Intensity, 5, 5), ramp(0)) << "a range of no width";
}

TEST_F(CpuDeviceTest, FiltersDropSamplesOneByOne) {
    std::vector<AnalyticPoint> points(3);
    for (int i = 0; i < 3; ++i) {
        points[i].position = {(i - 1) * 2.0, 0, 0.01};
        points[i].classification = static_cast<std::uint8_t>(i);
        points[i].rgb = {static_cast<std::uint8_t>(100 + i), 0, 0};
    }
    const AnalyticCloud cloud(points, 0.1);
    Scene scene(view_, cloud.cut(), sprite(Footprint::Pixel, Profile::Flat, 1));
    const auto drawn = [&] {
        std::array<bool, 3> seen{};
        const Frame f = mustDraw(*device_, scene.drawing);
        for (std::size_t i = 0; i < f.depth.size(); ++i) {
            if (f.depth[i] < infinity) seen[f.rgba[4 * i] - 100u] = true;
        }
        return seen;
    };
    EXPECT_EQ(drawn(), (std::array{true, true, true}));
    scene.drawing.view().filter.classes.emplace().fill(false);
    (*scene.drawing.view().filter.classes)[1] = true;
    EXPECT_EQ(drawn(), (std::array{false, true, false}));
    scene.drawing.view().filter.classes.reset();
    scene.drawing.view().filter.clip = ClipBox{{-1, -1, -1}, {9, 1, 1}};
    EXPECT_EQ(drawn(), (std::array{false, true, true}));
    scene.drawing.view().filter.clip = ClipBox{{5, 5, 5}, {9, 9, 9}};
    EXPECT_EQ(drawn(), (std::array{false, false, false}));
}

TEST_F(CpuDeviceTest, BackgroundsAreColourGradientOrNothing) {
    const AnalyticCloud cloud = one({0.01, 0, -0.01});
    Scene scene(view_, cloud.cut(), sprite(Footprint::Pixel, Profile::Flat, 1));
    Background& b = scene.drawing.background;
    b.top = {200, 100, 0};
    b.bottom = {0, 100, 200};
    EXPECT_EQ(pixel(mustDraw(*device_, scene.drawing), 5, 40), b.top);
    b.kind = Background::Kind::Gradient;
    const Frame gradient = mustDraw(*device_, scene.drawing);
    for (int y = 0; y < 48; ++y) {
        const double t = (y + 0.5) / 48;
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(pixel(gradient, 5, y)[c], b.top[c] + t * (b.bottom[c] - b.top[c]), 0.51) << y;
        }
    }
    b.kind = Background::Kind::Transparent;
    const Frame open = mustDraw(*device_, scene.drawing);
    EXPECT_EQ(alpha(open, 5, 40), 0);
    EXPECT_EQ(alpha(open, 32, 24), 255);
    EXPECT_EQ(pixel(open, 32, 24), (Rgb8{200, 100, 50}));
}

/// Draws it at once, and one by one.
void expectTheMean(Device& device, Scene& scene, const std::vector<glm::dvec2>& jitter) {
    std::vector<Frame> frames;
    for (const glm::dvec2& j : jitter) {
        scene.drawing.jitter = {&j, 1};
        frames.push_back(mustDraw(device, scene.drawing));
    }
    scene.drawing.jitter = jitter;
    const Frame mean = mustDraw(device, scene.drawing);
    const int count = static_cast<int>(jitter.size());
    EXPECT_EQ(mean.depth, frames[0].depth);
    for (std::size_t i = 0; i < mean.depth.size(); ++i) {
        int covered = 0, sum[3] = {};
        for (const Frame& f : frames) {
            if (f.rgba[4 * i + 3] == 0) continue;
            ++covered;
            for (int c = 0; c < 3; ++c) sum[c] += f.rgba[4 * i + c];
        }
        ASSERT_EQ(mean.rgba[4 * i + 3], (covered * 255 + count / 2) / count);
        for (int c = 0; c < 3 && covered > 0; ++c)
            ASSERT_EQ(mean.rgba[4 * i + c], (sum[c] + covered / 2) / covered);
    }
}

// Frames of sprites are drawn some at a time: three are fewer than that, and seven are some and some more.
TEST_F(CpuDeviceTest, AveragesTheFramesAsIfDrawnOneByOne) {
    Numbers numbers(5);
    std::vector<AnalyticPoint> points(3000);
    for (AnalyticPoint& p : points) {
        p.position = numbers.onSphere() * 3.0;
        p.rgb = numbers.color();
    }
    const AnalyticCloud cloud(points, 0.1, 500);
    const std::vector<glm::dvec2> three = {{0, 0.17}, {-0.25, -0.17}, {0.25, -0.39}};
    const std::vector<glm::dvec2> seven = {{0, 0.17},       {-0.25, -0.17}, {0.25, -0.39}, {0.4, 0.4},
                                           {-0.49, 0.0625}, {0.1, 0.2},     {0, 0}};
    for (const auto& jitter : {three, seven}) {
        for (const float px : {1.0f, 2.5f, 12.0f}) {
            for (const auto kind : {Background::Kind::Gradient, Background::Kind::Transparent}) {
                Scene scene(view_, cloud.cut(), sprite(Footprint::Circle, Profile::Paraboloid, px));
                if (px < 2) scene.addEyeDome();
                scene.drawing.background = Background{};
                scene.drawing.background.kind = kind;
                expectTheMean(*device_, scene, jitter);
            }
        }
    }
}

TEST_F(CpuDeviceTest, AnAbandonedPictureLeavesNoTrace) {
    Numbers numbers(6);
    std::vector<AnalyticPoint> points(test::sized(200'000, 40'000));
    for (AnalyticPoint& p : points) {
        p.position = numbers.onSphere() * 3.0;
        p.rgb = numbers.color();
    }
    const AnalyticCloud cloud(points, 0.05);
    Scene scene(view_, cloud.cut(), sprite(Footprint::Circle, Profile::Cone, 40));
    const Frame right = mustDraw(*device_, scene.drawing);
    std::stop_source already;
    already.request_stop();
    const auto refused = device_->draw(scene.drawing, already.get_token());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::Cancelled);
    // Stopped at some other moment each time; whatever came of it, the next picture is right.
    for (int delay = 0; delay < 12; ++delay) {
        std::stop_source source;
        std::jthread stopper([&] {
            std::this_thread::sleep_for(std::chrono::milliseconds(delay));
            source.request_stop();
        });
        const auto frame = device_->draw(scene.drawing, source.get_token());
        if (frame) {
            EXPECT_EQ(frame->rgba, right.rgba);
        }
        if (!frame) {
            EXPECT_EQ(frame.error().code, ErrorCode::Cancelled);
        }
        EXPECT_EQ(mustDraw(*device_, scene.drawing).rgba, right.rgba);
    }
}

TEST_F(CpuDeviceTest, OddSizesAndWindows) {
    Numbers numbers(9);
    std::vector<AnalyticPoint> points(2000);
    for (AnalyticPoint& p : points) p.position = numbers.onSphere() * 4.0;
    const AnalyticCloud cloud(points, 0.2, 300);
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 300}, {16384, 3}, {3, 2000}, {7, 7}}) {
        const Viewpoint view = lookAt({0, -10, 0}, {0, 0, 0}, width, height);
        for (const float px : {0.0f, 1.0f, 5.0f, 256.0f}) {
            Scene scene(view, cloud.cut(), sprite(Footprint::Circle, Profile::Paraboloid, px));
            scene.addEyeDome();
            const Frame f = mustDraw(*device_, scene.drawing);
            ASSERT_EQ(f.rgba.size(), std::size_t(width) * height * 4);
            EXPECT_LT(std::ranges::count(f.depth, infinity), std::ssize(f.depth)) << "something is seen";
        }
        for (const Window w : {Window{-1, 0, 1, 1}, Window{0, 0, width + 1, height}, Window{0, 0, 0, 1},
                               Window{width, 0, 1, 1}}) {
            Scene scene(view, cloud.cut(), sprite(Footprint::Pixel, Profile::Flat, 1));
            scene.drawing.window = w;
            EXPECT_FALSE(device_->draw(scene.drawing, {}));
        }
    }
}

TEST_F(CpuDeviceTest, HostileNumbersNeverBecomeNaN) {
    Numbers numbers(10);
    std::vector<AnalyticPoint> points(500);
    for (AnalyticPoint& p : points) p.position = numbers.onSphere() * 1e9;
    const AnalyticCloud far(points, 1e9, 100);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const float px : {nan, infinity, -5.0f, 1e30f, 1e-30f}) {
        for (const float gain : {nan, infinity, -1.0f, 1e30f}) {
            for (Projection projection : {Projection::Perspective, Projection::Orthographic}) {
                view_.projection = projection;
                view_.near = 0;
                view_.far = 1e300;
                const Frame f = draw(far.cut(), sprite(Footprint::Circle, Profile::Paraboloid, px, gain));
                for (const float d : f.depth) ASSERT_GT(d, 0);
            }
        }
    }
    view_.cloudToView[3] = {1e300, -1e300, 1e300, 1};
    EXPECT_EQ(std::ranges::count(draw(far.cut(), sprite(Footprint::Pixel, Profile::Flat, 1)).depth, infinity),
              64 * 48);
}

TEST_F(CpuDeviceTest, RefusesPassListsThatItDoesNotKnow) {
    const AnalyticCloud cloud = one({0, 0, 0});
    Scene scene(view_, cloud.cut(), sprite(Footprint::Pixel, Profile::Flat, 1));
    ResolvePass smooth;
    smooth.smooth = true;
    NearestPass cones = sprite(Footprint::Circle, Profile::Cone, 5);
    cones.payload = Payload::Sample;
    for (const PassList& list :
         {PassList{}, PassList{ResolvePass{}}, PassList{ResolvePass{}, NearestPass{}},
          PassList{NearestPass{}, ResolvePass{}, EyeDomePass{}, EyeDomePass{}},
          PassList{sprite(Footprint::Circle, Profile::Paraboloid, 5), smooth}, PassList{cones, smooth}}) {
        scene.drawing.passes = list;
        const auto frame = device_->draw(scene.drawing, {});
        ASSERT_FALSE(frame);
        EXPECT_EQ(frame.error().code, ErrorCode::Unsupported);
    }
}

TEST_F(CpuDeviceTest, RefusesPicturesThatAreTooLarge) {
    const AnalyticCloud cloud = one({0, 0, 0});
    const Viewpoint huge = lookAt({0, -10, 0}, {0, 0, 0}, 16384, 16384);
    Scene scene(huge, cloud.cut(), sprite(Footprint::Pixel, Profile::Flat, 1));
    const auto frame = device_->draw(scene.drawing, {});
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().code, ErrorCode::ResourceLimit);
}

TEST_F(CpuDeviceTest, TellsWhatItCost) {
    const AnalyticCloud cloud = one({0, 0, 0});
    const Frame f = draw(cloud.cut(), sprite(Footprint::Circle, Profile::Paraboloid, 5));
    EXPECT_EQ(f.stats.samplesDrawn, 1u);
    EXPECT_EQ(f.stats.device, "cpu");
    ASSERT_GE(f.stats.stages.size(), 2u);
    EXPECT_EQ(f.stats.stages[0].name, "nearest");
    EXPECT_EQ(f.stats.stages[1].name, "resolve");
}

}  // namespace
}  // namespace scancast::test
