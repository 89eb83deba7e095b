// A picture drawn by several devices together, each with a share of the samples, has the bytes of one device's: all it
// takes is that what they agree on between passes are integers (decision 2). The oracle of pictures by ranks.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "renderer/method/automatic.hpp"
#include "renderer/method/method.hpp"
#include "tests/support/clouds/scene_clouds.hpp"
#include "tests/support/pictures/drawn_together.hpp"
#include "tests/support/sized.hpp"

namespace scancast::test {
namespace {

/// With a mirror.
class Together : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        cloud_ = sceneCloud("room", test::sized(60'000, 8'000), 512).value();
        alone_ = createCpuDevice(2).value();
    }
    static void TearDownTestSuite() {
        alone_.reset();
        cloud_.reset();
    }
    static View view(std::string_view method) {
        View view = sceneView(*cloud_, sceneViews("room")[0], Projection::Perspective, sized(301, 101),
                              sized(203, 67));
        view.style.method = method;
        return view;
    }
    static std::shared_ptr<const PreparedView> prepared(const View& view) {
        return prepare(*cloud_, plan(*cloud_, view).value()).value();
    }
    static void expectSame(const View& view, std::uint32_t devices, bool mirror = true) {
        const auto whole = prepared(view);
        const auto alone = draw(*alone_, *whole);
        ASSERT_TRUE(alone) << alone.error().message;
        Meeting meeting(devices);
        const auto together = drawTogether(meeting, devices, *whole, devices == 2 ? 2 : 1);
        ASSERT_TRUE(together) << together.error().message;
        EXPECT_GT(meeting.meetings, 0);
        EXPECT_EQ(together->stats.mirrorsDrawn, mirror ? 1u : 0u);
        const auto covered =
            std::ranges::count_if(alone->depth, [](float depth) { return std::isfinite(depth); });
        EXPECT_GT(covered, std::ptrdiff_t(alone->depth.size() / 200))
            << "a picture of nothing proves nothing";
        EXPECT_EQ(alone->stats.samplesDrawn, together->stats.samplesDrawn);
        EXPECT_TRUE(std::ranges::equal(alone->rgba, together->rgba)) << "colours";
        EXPECT_EQ(0, std::memcmp(alone->depth.data(), together->depth.data(), 4 * alone->depth.size()))
            << "depths";
    }
    template <class Change>
    static void inEveryMethod(const Change& change) {
        std::uint32_t devices = 1;
        for (const Method& method : methods()) {
            if (method.name == automaticName) continue;
            SCOPED_TRACE(method.name);
            View changed = view(method.name);
            change(changed);
            devices = devices % 4 + 1;  // each number with some of the methods
            expectSame(changed, devices, changed.style.mirrors);
        }
    }

    static inline std::shared_ptr<const Cloud> cloud_;
    static inline std::unique_ptr<Device> alone_;
};

TEST_F(Together, EveryMethodWithAMirror) {
    for (const std::uint32_t devices : {2u, 3u}) {
        for (const Method& method : methods()) {
            if (method.name == automaticName) continue;
            SCOPED_TRACE(std::string(method.name) + ", devices: " + std::to_string(devices));
            expectSame(view(method.name), devices);
        }
    }
}

TEST_F(Together, Lit) {
    inEveryMethod([](View& view) {
        view.style.shading = Shading::Phong;
        view.style.light.sun = {{200, 35}};
        view.style.light.shadow = 0.8;
        view.style.light.occlusion = 0.5;
    });
}

TEST_F(Together, SeveralSamplesAPixelWithoutPerspective) {
    inEveryMethod([](View& view) {
        view.quality.samples = 4;
        view.camera.projection = Projection::Orthographic;
        view.style.color = ColorSource::Elevation;
    });
}

TEST_F(Together, BordersOfParaboloidsAreSmoothed) {
    for (const std::uint32_t devices : {2u, 3u}) {
        View smooth = view("paraboloid");
        smooth.style.parameters["smooth"] = true;
        expectSame(smooth, devices);
    }
}

TEST_F(Together, FilteredAndByWhatSamplesKnow) {
    const std::pair<const char*, void (*)(View&)> changes[] = {
        {"classes",
         [](View& v) {
             v.style.classes = {{1, 2, 6}};
         }},
        {"clip",
         [](View& v) {
             v.style.clip = ClipBox{v.camera.target - 1.5, v.camera.target + 1.5};
         }},
        {"outliers", [](View& v) { v.style.outliers = Outliers::Show; }},
        {"intensity",
         [](View& v) {
             v.style.color = ColorSource::Elevation;
             v.style.byIntensity = true;
         }},
        {"toned", [](View& v) { v.style.exposure = 1.5; }},
    };
    for (const auto& [what, change] : changes) {
        SCOPED_TRACE(what);
        View changed = view("ewa");
        changed.style.mirrors = false;
        change(changed);
        const auto whole = prepared(changed);
        const auto alone = draw(*alone_, *whole);
        ASSERT_TRUE(alone) << alone.error().message;
        Meeting meeting(3);
        const auto together = drawTogether(meeting, 3, *whole, 1);
        ASSERT_TRUE(together) << together.error().message;
        EXPECT_TRUE(std::ranges::equal(alone->rgba, together->rgba));
    }
}

/// Without a mirror each device finishes rows of its own: with what passes look at around them.
TEST_F(Together, TheScreenIsDivided) {
    inEveryMethod([](View& view) {
        view.style.mirrors = false;
        view.quality.samples = 4;
        view.style.light.sun = {{200, 35}};
        view.style.light.shadow = 0.8;
        view.style.shading = Shading::Phong;
    });
    for (const std::uint32_t devices : {2u, 4u}) {
        for (const std::string_view method : {"point", "paraboloid", "hqs", "voronoi"}) {
            SCOPED_TRACE(std::string(method) + ", devices: " + std::to_string(devices));
            View changed = view(method);
            changed.style.mirrors = false;
            if (method == "paraboloid") changed.style.parameters["smooth"] = true;
            changed.style.shading = method == "voronoi" ? Shading::Phong : Shading::EyeDome;
            changed.style.light.occlusion = 0.5;
            expectSame(changed, devices, false);
        }
    }
}

TEST_F(Together, FewerRowsThanDevices) {
    for (const std::string_view method : {"point", "paraboloid", "ewa", "pyramid"}) {
        SCOPED_TRACE(method);
        View low = view(method);
        low.height = 3;
        low.style.mirrors = false;
        if (method == "paraboloid") low.style.parameters["smooth"] = true;
        low.style.shading = Shading::Phong;
        expectSame(low, 4, false);
    }
}

/// Of so few nodes some have none.
TEST_F(Together, WhereSomeHaveNothing) {
    for (const Method& method : methods()) {
        if (method.name == automaticName) continue;
        SCOPED_TRACE(method.name);
        View coarse = view(method.name);
        coarse.quality.budget = 1;
        coarse.style.mirrors = false;
        coarse.style.shading = Shading::Phong;
        expectSame(coarse, 4, false);
    }
}

/// At whatever of their meetings somebody says so.
TEST_F(Together, AllOfThemStop) {
    View stopped = view("voronoi");
    stopped.style.shading = Shading::Phong;
    const auto whole = prepared(stopped);
    int meetings = 1;
    for (int at = 1; at <= meetings; ++at) {
        Meeting meeting(3);
        std::stop_source stop;
        meeting.onMeeting = [&] {
            if (meeting.meetings == at) stop.request_stop();
        };
        const auto frame = drawTogether(meeting, 3, *whole, 1, {stop.get_token()});
        ASSERT_FALSE(frame);
        EXPECT_EQ(frame.error().code, ErrorCode::Cancelled);
        EXPECT_EQ(meeting.meetings, at) << "they went on";
        if (at > 1) continue;
        Meeting all(3);
        ASSERT_TRUE(drawTogether(all, 3, *whole, 1));
        meetings = all.meetings;
    }
    EXPECT_GE(meetings, 6);  // three passes, of the picture and its mirror
}

}  // namespace
}  // namespace scancast::test
