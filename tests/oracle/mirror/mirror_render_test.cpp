// Mirrors through the front door, of a cloud built as any other: what is paid, what is said, and what the
// switches do.
#include <gtest/gtest.h>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/render.hpp"
#include "tests/oracle/mirror/draw_mirrored.hpp"
#include "tests/support/clouds/scene_points.hpp"
#include "tests/support/pictures/devices.hpp"

namespace scancast {
namespace {

using namespace test;

std::shared_ptr<const Cloud> build(const PointBatch& points, std::vector<Mirror> mirrors) {
    BatchSource source(points);
    BuildOptions options;
    options.mirrors = std::move(mirrors);
    options.shape.leafPoints = 2048;
    options.shape.surfels = true;
    return buildCloud(source, options).value();
}

View viewFrom(const glm::dvec3& eye, const glm::dvec3& target) {
    View view;
    view.width = 320;
    view.height = 240;
    view.camera.eye = eye;
    view.camera.target = target;
    view.quality.samples = 1;
    return view;
}

bool hasStage(const Frame& frame, const char* name) {
    return std::ranges::any_of(frame.stats.stages, [&](const StageTime& s) { return s.name == name; });
}

class MirrorRender : public OnDevice {
  protected:
    static void SetUpTestSuite() {
        SceneOptions options;
        options.scene = "room";
        options.points = 150'000;
        scene_ = std::make_unique<BuiltTwice>(builtTwice(options));
        ghosts_ = std::make_unique<PointBatch>(scenePoints(options));
        cloud_ = build(*ghosts_, {scene_->mirror});
    }
    static void TearDownTestSuite() {
        scene_.reset();
        ghosts_.reset();
        cloud_.reset();
    }
    Frame mustRender(const Cloud& cloud, const View& view, const RenderOptions& options = {}) const {
        auto frame = render(*device_, cloud, view, options);
        if (!frame) {
            ADD_FAILURE() << frame.error().message;
            return {};
        }
        return std::move(*frame);
    }

    const View towards_ = viewFrom({-1.2, -1.6, 1.6}, {0.4, 2.5, 1.3});
    const View away_ = viewFrom({0, 1, 1.5}, {0.5, -2.5, 1.2});
    static inline std::unique_ptr<BuiltTwice> scene_;
    static inline std::unique_ptr<PointBatch> ghosts_;
    static inline std::shared_ptr<const Cloud> cloud_;
};
SCANCAST_ON_DEVICES(MirrorRender, "egl");

TEST_P(MirrorRender, NoneInViewCostsNothing) {
    for (const Method& method : methods()) {
        View view = away_;
        view.style.method = method.name;
        const Frame on = mustRender(*cloud_, view);
        view.style.mirrors = false;
        const Frame off = mustRender(*cloud_, view);
        EXPECT_EQ(on.rgba, off.rgba) << method.name;
        EXPECT_EQ(on.stats.samplesDrawn, off.stats.samplesDrawn);
        EXPECT_EQ(on.stats.mirrorsDrawn, 0u);
        EXPECT_FALSE(hasStage(on, "mirrors"));
    }
}

TEST_P(MirrorRender, OneInViewIsPaidForAndSaid) {
    const Frame on = mustRender(*cloud_, towards_);
    View view = towards_;
    view.style.mirrors = false;
    const Frame off = mustRender(*cloud_, view);
    EXPECT_EQ(on.stats.mirrorsDrawn, 1u);
    EXPECT_EQ(on.stats.mirrorsLeftOut, 0u);
    EXPECT_TRUE(hasStage(on, "mirrors"));
    EXPECT_FALSE(hasStage(off, "mirrors"));
    EXPECT_GT(on.stats.samplesDrawn, off.stats.samplesDrawn);
    // Only what the mirror shows is selected.
    EXPECT_LT(on.stats.samplesDrawn, off.stats.samplesDrawn * 7 / 4);
    EXPECT_NE(on.rgba, off.rgba);
}

/// The scanner recorded exact images: what the mirror shows is what the points behind it showed.
TEST_P(MirrorRender, TheReflectionLooksLikeWhatTheScannerSaw) {
    View raw = towards_;
    raw.style.mirrors = false;
    raw.style.behindMirrors = true;
    const Frame recorded = mustRender(*cloud_, raw), drawn = mustRender(*cloud_, towards_);
    const auto viewpoint = Viewpoint::create(towards_, cloud_->origin, cloud_->bounds).value();
    Mirror mirror = scene_->mirror;
    mirror.center -= cloud_->origin;
    const PixelMask inside = eroded(glassOf(mirror, viewpoint).mask, 320, 240, 4);
    EXPECT_GE(psnr(drawn, recorded, inside).value(), 20);  // other points, of the same things
    raw.style.behindMirrors = false;
    EXPECT_LE(psnr(mustRender(*cloud_, raw), recorded, inside).value(), 12);  // a hole
}

TEST_P(MirrorRender, LevelsOfDetailAndBudgetsHoldForReflections) {
    View view = towards_;
    view.quality.budget = 30'000;
    const Frame small = mustRender(*cloud_, view);
    EXPECT_LE(small.stats.samplesDrawn, 30'000u);
    EXPECT_EQ(small.stats.mirrorsDrawn, 1u);
    view.quality.budget.reset();
    view.quality.detail = 8;
    const Frame coarse = mustRender(*cloud_, view), brute = mustRender(*cloud_, view, {.bruteForce = true});
    EXPECT_LT(coarse.stats.samplesDrawn, brute.stats.samplesDrawn / 4);
    // Culling for the reflected eye loses nothing.
    view.quality.detail = 0;
    EXPECT_EQ(mustRender(*cloud_, view).rgba, brute.rgba);
}

/// Draws everything twice: the tile that is asked for, and once the whole picture.
class WholeToo : public Device {
  public:
    explicit WholeToo(Device& device) : device_(device) {}
    DeviceInfo info() const override { return device_.info(); }
    Expected<Frame> draw(const Drawing& drawing, std::stop_token stop) override {
        if (tiles++ == 0) {
            Drawing all = drawing;
            const Viewpoint& view = drawing.mainView().viewpoint;
            all.window = {0, 0, view.width, view.height};
            whole = mustDraw(device_, all);
        }
        return device_.draw(drawing, stop);
    }
    int tiles = 0;
    Frame whole;

  private:
    Device& device_;
};

TEST_P(MirrorRender, PostersAreDrawnInTilesLikeWholePictures) {
    View view = viewFrom({-1.2, -1.6, 1.6}, {-2.006, -1.008, 1.55});  // the mirror at the tiles' border
    view.width = 2304;
    view.height = 300;
    for (const char* method : {"square", "ewa"}) {
        view.style.method = method;
        WholeToo device(*device_);
        const auto poster = render(device, *cloud_, view);
        ASSERT_TRUE(poster) << poster.error().message;
        EXPECT_EQ(device.tiles, 2);
        EXPECT_EQ(poster->stats.mirrorsDrawn, 1u);
        EXPECT_EQ(poster->rgba, device.whole.rgba) << method;
        EXPECT_EQ(poster->depth, device.whole.depth) << method;
        View off = view;
        off.style.mirrors = false;
        EXPECT_NE(mustRender(*cloud_, off).rgba, poster->rgba) << method;
    }
}

}  // namespace
}  // namespace scancast
