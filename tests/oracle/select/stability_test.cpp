// Stability in motion: no change of level moves more than 2 % of the pixels by more than 16 of 255.
//
// Right because of how a change of level is isolated: the same view is drawn twice, with the nodes that this
// camera chooses and with those that the camera of the step before chose; nothing else differs between the
// two pictures.
#include <gtest/gtest.h>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/method/method.hpp"
#include "renderer/select/fade.hpp"
#include "simulator/scene.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"
#include "tests/support/pictures/stability.hpp"

namespace scancast::test {
namespace {

constexpr double mostChanged = 0.02;

std::shared_ptr<const Cloud> build(const char* scene, std::uint64_t points) {
    SceneOptions options;
    options.scene = scene;
    options.points = points;
    auto source = simulate(options);
    BuildOptions build;
    build.shape.surfels = true;
    return source ? buildCloud(**source, build).value_or(nullptr) : nullptr;
}

class Levels : public OnDevice {
  protected:
    static void SetUpTestSuite() { town_ = build("town", 400'000); }
    static void TearDownTestSuite() { town_.reset(); }
    void SetUp() override {
        ASSERT_TRUE(town_);
        OnDevice::SetUp();
    }

    /// A look at the whole cloud, turned about it.
    View look(const Cloud& cloud, double degrees, double detail) const {
        View view = defaultView(cloud, slow_ ? 480 : 640, slow_ ? 270 : 360);
        view.camera = moved(view.camera, Motion::Orbit, degrees);
        view.quality.samples = 1;
        view.quality.detail = detail;
        return view;
    }

    static inline std::shared_ptr<const Cloud> town_;
};
SCANCAST_ON_DEVICES(Levels, "egl");

TEST_P(Levels, FadeInEveryMethod) {
    const StabilityOptions options{Motion::Orbit, 0.1, slow_ ? 1 : 2, false};
    double changes = 0;
    for (const Method& method : methods())
        for (const double detail : {2.0, 4.0})
            for (const double degrees : {0.0, 200.0}) {
                if (slow_ && degrees > 0) continue;
                View view = look(*town_, degrees, detail);
                view.style.method = method.name;
                const auto stability = measureStability(*device_, *town_, view, options);
                ASSERT_TRUE(stability) << method.name << ": " << stability.error().message;
                EXPECT_LE(stability->levels.worst, mostChanged) << method.name << ", tau " << detail;
                changes += stability->levels.mean();
            }
    EXPECT_GT(changes, 0) << "levels must have changed to prove anything";
}

/// The worst change of level in a zoom without perspective, where all nodes of one spacing would switch at
/// once, with a band of this width.
double worstInZoom(Device& device, const Cloud& cloud, View view, double band) {
    view.camera.projection = Projection::Orthographic;
    SelectOptions selection;
    selection.detail = *view.quality.detail;
    selection.fade = band;
    double worst = 0;
    std::vector<SampleRun> keep;
    const auto cutFor = [&](const Viewpoint& viewpoint) {
        Cut cut = select(cloud.octree, viewpoint, selection);
        for (CutRun& run : cut.runs) {
            keep.push_back(cloud.octree.run(run.nodeIndex).value());
            run.samples = keep.back().samples;
        }
        return cut;
    };
    Cut before;
    for (int i = 0; i < 160; ++i, view.camera = moved(view.camera, Motion::Zoom, 0.5)) {
        const Viewpoint viewpoint = Viewpoint::create(view, cloud.origin, cloud.bounds).value();
        Cut now = cutFor(viewpoint);
        const auto isSame = [](const CutRun& a, const CutRun& b) {
            return a.nodeIndex == b.nodeIndex && a.share == b.share;
        };
        if (i > 0 && !std::ranges::equal(before.runs, now.runs, isSame)) {
            const NearestPass circles = sprite(Footprint::Circle, Profile::Flat, 0);
            const Scene old(viewpoint, before, circles), recent(viewpoint, now, circles);
            worst = std::max(worst, changed(mustDraw(device, old.drawing), mustDraw(device, recent.drawing)));
        }
        before = std::move(now);
    }
    return worst;
}

TEST_P(Levels, FadeWhereManyWouldSwitchAtOnce) {
    const View view = look(*town_, 0, 4);
    EXPECT_LE(worstInZoom(*device_, *town_, view, fadeBand(4)), mostChanged);
    // The measure can fail: it does without fading.
    EXPECT_GT(worstInZoom(*device_, *town_, view, 0), mostChanged);
}

// Right because without levels there are no changes of level: full detail is brute force, so both cuts are
// the same.
TEST_P(Levels, FullDetailHasNone) {
    const auto stability =
        measureStability(*device_, *town_, look(*town_, 10, 0), {Motion::Orbit, 0.1, 2, true});
    ASSERT_TRUE(stability);
    EXPECT_EQ(stability->levels.worst, 0);
    EXPECT_EQ(stability->frames.worst, stability->bruteForce.worst);
    EXPECT_GT(stability->frames.worst, 0);
}

}  // namespace
}  // namespace scancast::test
