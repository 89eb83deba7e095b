// Several clouds in one picture. Right because each oracle draws one cloud at a time, and knows nothing of octrees with several roots:
// two pictures and their depths say which cloud is seen in each pixel of both; a camera that is moved back says what a moved cloud
// looks like; a product of bytes, what a tint is.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/device/device.hpp"
#include "renderer/pick/pick.hpp"
#include "renderer/render.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "renderer/together/together.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/clouds/write_cloud.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

constexpr glm::dvec3 farAway(389500, 5819836, 40);  // as UTM coordinates are

ScanPoint groundThere(std::uint64_t i, std::uint64_t n) {
    ScanPoint point = ground(i, n);
    point.position += farAway;
    point.intensity = std::uint16_t(i % 1000);
    return point;
}

ScanPoint ballThere(std::uint64_t i, std::uint64_t n) {
    ScanPoint point = ball(i, n);
    point.position += farAway + glm::dvec3(90, 110, 8);
    point.color = {std::uint8_t(200 + i % 50), std::uint8_t(i % 251), 30};
    point.intensity = std::uint16_t(i % 700);
    return point;
}

std::shared_ptr<const Cloud> built(std::uint64_t points, SyntheticSource::Make make, bool colors = true,
                                   bool intensities = true) {
    Attributes attributes;
    attributes.color = colors;
    attributes.intensity = intensities;
    SyntheticSource source(points, std::move(make), attributes, 0.001, farAway);
    BuildOptions options;
    options.threads = 2;
    options.shape.leafPoints = 700;
    return buildCloud(source, options).value();
}

const std::shared_ptr<const Cloud>& groundCloud() {
    static const auto cloud = built(sized(60'000, 8'000), groundThere);
    return cloud;
}

const std::shared_ptr<const Cloud>& ballCloud() {
    static const auto cloud = built(sized(30'000, 5'000), ballThere);
    return cloud;
}

std::shared_ptr<BlockCache> cacheOf(std::uint64_t limit) {
    BlockCacheOptions options;
    options.memoryLimit = limit;
    return BlockCache::create(options);
}

const std::shared_ptr<BlockCache>& cache() {
    static const auto made = cacheOf(64 << 20);
    return made;
}

TogetherMember member(const char* name, const std::shared_ptr<const Cloud>& cloud) {
    return {.name = name, .cloud = cloud};
}

std::shared_ptr<const Cloud> together(std::vector<TogetherMember> members, bool byCloud = false,
                                      const Cloud* like = nullptr) {
    auto made = putTogether(std::move(members), byCloud, cache(), like);
    EXPECT_TRUE(made) << made.error().message;
    return made.value();
}

/// Points of a pixel each, as they are, from the leaves: pixels have one point's colour.
View plainView(const glm::dvec3& eye, const glm::dvec3& target) {
    View view;
    view.width = 240;
    view.height = 160;
    view.camera.eye = farAway + eye;
    view.camera.target = farAway + target;
    view.camera.near = 0.5;
    view.style.method = "point";
    view.style.color = ColorSource::Rgb;
    view.style.exposure = 0;
    view.style.shading = Shading::Unlit;
    view.style.background = {Background::Kind::Color, {1, 2, 3}, {}};
    view.quality.detail = 0;
    view.quality.samples = 1;
    return view;
}

const std::vector<View>& plainViews() {
    static const std::vector<View> views{plainView({20, -30, 60}, {95, 100, 0}),
                                         plainView({100, 40, 12}, {90, 110, 8}),
                                         plainView({90, 108, 120}, {90, 110, 0})};
    return views;
}

using Pixel = std::array<std::uint8_t, 3>;
Pixel pixelOf(const Frame& frame, std::size_t i) {
    return {frame.rgba[4 * i], frame.rgba[4 * i + 1], frame.rgba[4 * i + 2]};
}

/// Pixels that are not the same.
std::size_t differing(const Frame& a, const Frame& b) {
    EXPECT_EQ(a.width * a.height, b.width * b.height);
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.rgba.size() / 4; ++i) count += pixelOf(a, i) != pixelOf(b, i);
    return count;
}

/// Some pixel's centre may lie between what two origins make of a point in single precision.
constexpr std::size_t atBorders = 240 * 160 / 2000;

class TogetherOracle : public OnDevice {
  protected:
    Frame draw(const Cloud& cloud, const View& view) {
        auto frame = render(*device_, cloud, view);
        EXPECT_TRUE(frame) << frame.error().message;
        return frame ? std::move(*frame) : Frame{};
    }
};
SCANCAST_ON_DEVICES(TogetherOracle, "egl");

TEST_P(TogetherOracle, EachPixelIsOfTheNearerCloud) {
    const auto both = together({member("ground", groundCloud()), member("ball", ballCloud())});
    EXPECT_EQ(both->octree.roots(), 2U);
    EXPECT_EQ(both->points, groundCloud()->points + ballCloud()->points);
    for (const View& view : plainViews()) {
        const Frame a = draw(*groundCloud(), view), b = draw(*ballCloud(), view), all = draw(*both, view);
        std::size_t wrong = 0, ofA = 0, ofB = 0;
        for (std::size_t i = 0; i < all.depth.size(); ++i) {
            const bool isA = a.depth[i] <= b.depth[i];
            wrong += pixelOf(all, i) != pixelOf(isA ? a : b, i);
            ofA += isA && std::isfinite(a.depth[i]);
            ofB += !isA;
        }
        EXPECT_LE(wrong, atBorders);
        EXPECT_GT(ofA, 1000U);
        EXPECT_GT(ofB, 200U);
    }
}

TEST_P(TogetherOracle, IsTheCloudOfBothScans) {
    const auto half = [](std::uint64_t i, std::uint64_t n) {
        return i < n / 2 ? groundThere(i, n / 2) : ballThere(i - n / 2, n / 2);
    };
    const std::uint64_t each = sized(20'000, 4'000);
    const auto one = built(2 * each, half);
    const auto both =
        together({member("ground", built(each, groundThere)), member("ball", built(each, ballThere))});
    for (const View& view : plainViews()) {
        // Places are kept in other steps there: a few points lie in the next pixel.
        EXPECT_LE(differing(draw(*one, view), draw(*both, view)), std::size_t(240 * 160 / 50));
    }
}

TEST_P(TogetherOracle, AMovedCloudIsWhatAMovedCameraSees) {
    const glm::dvec3 shift(-12.25, 7.5, 3);
    TogetherMember moved = member("ball", ballCloud());
    moved.shift = shift;
    TogetherMember hidden = member("ground", groundCloud());
    hidden.hidden = true;
    const auto ballAlone = together({hidden, moved});
    for (View view : plainViews()) {
        const Frame here = draw(*ballAlone, view);
        view.camera.eye -= shift;
        view.camera.target -= shift;
        EXPECT_LE(differing(here, draw(*ballCloud(), view)), atBorders);
    }
    // And all of them moved together, seen by a camera that goes with them.
    TogetherMember ground = member("ground", groundCloud());
    ground.shift = shift;
    const auto still = together({member("ground", groundCloud()), member("ball", ballCloud())});
    const auto all = together({ground, moved});
    View view = plainViews()[0];
    const Frame before = draw(*still, view);
    view.camera.eye += shift;
    view.camera.target += shift;
    EXPECT_LE(differing(before, draw(*all, view)), atBorders);
}

TEST_P(TogetherOracle, HiddenIsAbsent) {
    TogetherMember hidden = member("ball", ballCloud());
    hidden.hidden = true;
    const auto one = together({member("ground", groundCloud()), hidden});
    for (View view : plainViews()) {
        EXPECT_EQ(differing(draw(*one, view), draw(*groundCloud(), view)), 0U);
        for (const char* method : {"paraboloid", "square"}) {
            view.style.method = method;
            view.quality.detail.reset();
            view.style.shading.reset();
            EXPECT_EQ(differing(draw(*one, view), draw(*groundCloud(), view)), 0U) << method;
        }
    }
    TogetherMember none = member("ground", groundCloud());
    none.hidden = true;
    const Frame nothing = draw(*together({none, hidden}), plainViews()[0]);
    EXPECT_TRUE(std::ranges::all_of(nothing.depth, [](float d) { return std::isinf(d); }));
}

TEST_P(TogetherOracle, ATintIsAProductOrTheColor) {
    const Rgb8 tint{255, 128, 7};
    TogetherMember tinted = member("ball", ballCloud());
    tinted.tint = tint;
    const auto both = together({member("ground", groundCloud()), tinted});
    const auto plain = together({member("ground", groundCloud()), member("ball", ballCloud())});
    const auto byCloud = together({member("ground", groundCloud()), tinted}, true);
    const auto colorless = built(sized(30'000, 5'000), ballThere, false);
    tinted.cloud = colorless;
    const auto asColor = together({member("ground", groundCloud()), tinted});
    const auto untinted = together({member("ground", groundCloud()), member("ball", colorless)});
    for (View view : plainViews()) {
        const Frame a = draw(*groundCloud(), view), b = draw(*ballCloud(), view);
        const Frame drawn = draw(*both, view), before = draw(*plain, view), color = draw(*asColor, view),
                    grey = draw(*untinted, view);
        view.style.color = ColorSource::Cloud;
        const Frame clouds = draw(*byCloud, view);
        std::size_t wrong = 0, seen = 0;
        for (std::size_t i = 0; i < drawn.depth.size(); ++i) {
            if (std::isinf(before.depth[i])) continue;
            const bool isBall = b.depth[i] < a.depth[i];
            Pixel expected = pixelOf(before, i);
            for (std::size_t c = 0; isBall && c < 3; ++c)
                expected[c] = std::uint8_t(std::floor(expected[c] * tint[c] / 255.0 + 0.5));
            wrong += pixelOf(drawn, i) != expected;
            wrong += pixelOf(color, i) != (isBall ? tint : pixelOf(before, i));
            wrong += pixelOf(grey, i) != (isBall ? Pixel{200, 200, 200} : pixelOf(before, i));
            wrong += pixelOf(clouds, i) != (isBall ? tint : cloudColors[0]);
            seen += isBall;
        }
        EXPECT_LE(wrong, 4 * atBorders);
        EXPECT_GT(seen, 200U);
    }
    // One cloud has the first of the colours.
    View view = plainViews()[0];
    view.style.color = ColorSource::Cloud;
    const Frame alone = draw(*groundCloud(), view);
    for (std::size_t i = 0; i < alone.depth.size(); ++i)
        if (std::isfinite(alone.depth[i])) {
            ASSERT_EQ(pixelOf(alone, i), cloudColors[0]);
        }
}

TEST_P(TogetherOracle, AFilterHoldsForEachCloud) {
    TogetherMember tinted = member("ball", ballCloud());
    tinted.tint = Rgb8{255, 255, 255};  // changes nothing, and has its samples painted
    for (const auto& other : {member("ball", ballCloud()), tinted}) {
        const auto both = together({member("ground", groundCloud()), other});
        View view = plainViews()[1];
        view.style.filter = {{"intensity", 100, 450}};
        const Frame a = draw(*groundCloud(), view), b = draw(*ballCloud(), view), all = draw(*both, view);
        view.style.filter.clear();
        EXPECT_GT(differing(all, draw(*both, view)), 1000U);
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < all.depth.size(); ++i)
            wrong += pixelOf(all, i) != pixelOf(a.depth[i] <= b.depth[i] ? a : b, i);
        EXPECT_LE(wrong, atBorders);
    }
    const auto without = built(1000, ballThere, true, false);
    View view = plainViews()[1];
    view.style.filter = {{"intensity", 100, 450}};
    const auto refused =
        render(*device_, *together({member("ground", groundCloud()), member("bare", without)}), view);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().field, "filter");
    EXPECT_NE(refused.error().message.find("\"bare\""), std::string::npos) << refused.error().message;
}

TEST_P(TogetherOracle, IsTheSameOnEveryDeviceAndOutOfFiles) {
    const TemporaryFolder folder;
    writeCloud(*groundCloud(), folder / "ground.scan");
    writeCloud(*ballCloud(), folder / "ball.scan");
    // Less than all of it, so that blocks come and go.
    const std::uint64_t limit = sized(std::uint64_t(6) << 20, std::uint64_t(3) << 20);
    const auto small = cacheOf(limit);
    const auto ground = openCloud(folder / "ground.scan", small).value();
    const auto ball = openCloud(folder / "ball.scan", small).value();
    const auto pair = [&](const auto& a, const auto& b) {
        TogetherMember one = member("ground", a), other = member("ball", b);
        one.shift = {0, 0, -0.25};
        other.tint = Rgb8{90, 255, 200};
        return std::vector{one, other};
    };
    const auto inMemory = together(pair(groundCloud(), ballCloud()));
    const auto outOfCore = putTogether(pair(ground, ball), false, small).value();
    EXPECT_FALSE(outOfCore->octree.store().whole());
    std::string reason;
    Device* const cpu = sharedDevices->get("cpu", reason);
    ASSERT_NE(cpu, nullptr);
    for (View view : plainViews()) {
        const Frame expected = draw(*inMemory, view);
        EXPECT_EQ(differing(expected, draw(*outOfCore, view)), 0U);
        for (const char* method : {"point", "paraboloid", "square"}) {
            view.style.method = method;
            view.quality.detail.reset();
            auto reference = render(*cpu, *outOfCore, view);
            ASSERT_TRUE(reference) << reference.error().message;
            EXPECT_EQ(differing(*reference, draw(*outOfCore, view)), 0U) << method;
        }
    }
}

// Without pixels: what selection promises of one root, it keeps of several.
TEST(TogetherTree, EveryLeafIsDrawnOnceWithinAnyBudget) {
    const auto both = together(
        {member("ground", groundCloud()), member("ball", ballCloud()), member("again", ballCloud())});
    const Octree& octree = both->octree;
    EXPECT_EQ(octree.roots(), 3U);
    for (std::uint32_t i = 0; i < octree.nodes().size(); ++i) {
        const Node& node = octree.node(i);
        EXPECT_EQ(node.parent == noNode, i < octree.roots());
        for (std::uint32_t c = 0; c < node.childCount; ++c)
            EXPECT_EQ(octree.node(node.firstChild + c).parent, i);
    }
    const auto viewpoint = Viewpoint::create(plainViews()[0], both->origin, both->bounds).value();
    for (const double fade : {0.0, 0.5})
        for (const std::uint64_t budget : {0ULL, 1ULL, 4000ULL, 20'000ULL}) {
            SelectOptions options;
            options.detail = 3;
            options.cull = false;
            options.fade = fade;
            if (budget > 0) options.budget = budget;
            const Cut cut = select(octree, viewpoint, options);
            std::set<std::uint32_t> whole;
            for (const CutRun& run : cut.runs)
                if (run.share == 1) whole.insert(run.nodeIndex);
            EXPECT_TRUE(std::ranges::is_sorted(cut.runs, {}, &CutRun::nodeIndex));
            for (std::uint32_t leaf = 0; leaf < octree.nodes().size(); ++leaf) {
                if (!octree.node(leaf).isLeaf()) continue;
                int times = 0;
                for (std::uint32_t up = leaf; up != noNode; up = octree.node(up).parent)
                    times += whole.contains(up);
                ASSERT_EQ(times, 1) << leaf << ", budget " << budget << ", fade " << fade;
            }
        }
}

TEST(TogetherTree, WhatOnlyMovesKeepsItsSamplesOnDevices) {
    TogetherMember tinted = member("ball", ballCloud());
    tinted.tint = Rgb8{9, 99, 199};
    const auto first = together({member("ground", groundCloud()), tinted});
    tinted.shift = {1, 2, 3};
    const auto moved = together({member("ground", groundCloud()), tinted}, false, first.get());
    EXPECT_EQ(first->octree.source(), moved->octree.source());
    EXPECT_EQ(first->together->stores, moved->together->stores);
    EXPECT_NE(first->revision, moved->revision);
    EXPECT_EQ(first->together->stores[0].get(), &groundCloud()->octree.store())
        << "shared with the cloud itself";
    tinted.tint = Rgb8{9, 99, 198};
    EXPECT_NE(together({member("ground", groundCloud()), tinted}, false, first.get())->octree.source(),
              first->octree.source());
}

TEST(TogetherTree, DefaultCamerasSeeAllOfThem) {
    TogetherMember moved = member("ball", ballCloud());
    moved.shift = {400, 0, 0};
    const auto both = together({member("ground", groundCloud()), moved});
    const View view = defaultView(*both, 320, 200);
    const auto viewpoint = Viewpoint::create(view, both->origin, both->bounds).value();
    EXPECT_EQ(both->bounds[1].x, ballCloud()->bounds[1].x + 400);
    for (unsigned corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p(both->bounds[corner & 1].x, both->bounds[corner >> 1 & 1].y,
                           both->bounds[corner >> 2 & 1].z);
        const glm::dvec3 seen = viewpoint.project(viewpoint.cloudToView * glm::dvec4(p - both->origin, 1));
        EXPECT_TRUE(seen.x > 0 && seen.x < 320 && seen.y > 0 && seen.y < 200 && seen.z > 0);
    }
}

TEST(TogetherTree, ALookThatOthersDoNotHaveIsLeftOut) {
    auto own = std::make_shared<Cloud>(*groundCloud());
    own->look.emplace();
    own->look->bounds = own->bounds;
    own->look->views = {LookView{"whole", false, own->defaultCamera(1.5)}};
    own->look->style.color = ColorSource::Rgb;
    own->look->style.byIntensity = true;
    own->look->style.shading = Shading::Phong;
    TogetherMember hidden = member("ground", own);
    hidden.hidden = true;
    const auto plain = built(500, ballThere, false, false);
    const auto both = together({hidden, member("plain", plain)});
    ASSERT_TRUE(both->look);
    EXPECT_EQ(both->look->style.color, ColorSource::Auto);
    EXPECT_FALSE(both->look->style.byIntensity);
    EXPECT_TRUE(plan(*both, defaultView(*both, 64, 48)));
    own->look->style.color = ColorSource::Column;
    own->look->style.column = "nobody has it";
    EXPECT_TRUE(plan(*together({hidden, member("plain", plain)}), defaultView(*both, 64, 48)));
    EXPECT_EQ(together({member("ground", groundCloud()), member("ball", ballCloud())})->attributes.color,
              true);
}

TEST(TogetherPick, SaysWhosePointItIsAndWhereThatHasIt) {
    TogetherMember moved = member("ball", ballCloud());
    moved.shift = {0, -20, 4};
    moved.tint = Rgb8{0, 0, 255};
    const auto both = together({member("ground", groundCloud()), moved});
    std::string reason;
    Device* const cpu = sharedDevices->get("cpu", reason);
    const View view = plainViews()[0];
    const Frame frame = render(*cpu, *both, view).value();
    int ofBall = 0, ofGround = 0;
    for (std::size_t i = 7; i < frame.depth.size(); i += 23) {
        if (!std::isfinite(frame.depth[i])) continue;
        const auto picked = pick(*both, view, {int(i % 240), int(i / 240)}, frame.depth[i]).value();
        ASSERT_TRUE(picked && picked->of);
        const bool isBall = picked->of->name == "ball";
        ++(isBall ? ofBall : ofGround);
        EXPECT_EQ(picked->of->shift, isBall ? moved.shift : glm::dvec3(0));
        if (!isBall) continue;
        // On the ball's own surface, in its own colours.
        EXPECT_NEAR(glm::distance(picked->point.position, farAway + glm::dvec3(90, 110, 8)), 10, 0.05);
        EXPECT_EQ(picked->sample.b, 30);
    }
    EXPECT_GT(ofBall, 5);
    EXPECT_GT(ofGround, 50);
    // What a filter takes away is not picked, of no cloud; what is left is whose it was.
    View filtered = view;
    filtered.style.filter = {{"intensity", 300, 400}};
    for (std::size_t i = 7; i < frame.depth.size(); i += 997) {
        const auto picked = pick(*both, filtered, {int(i % 240), int(i / 240)}, frame.depth[i]).value();
        if (!picked) continue;
        EXPECT_GE(picked->sample.intensity, 300);
        EXPECT_LE(picked->sample.intensity, 400);
    }
}

TEST(TogetherRefuses, OtherSystemsAndTooManyNodes) {
    const auto in = [](int epsg) {
        auto cloud = std::make_shared<Cloud>(*ballCloud());
        cloud->crsEpsg = epsg;
        return std::shared_ptr<const Cloud>(cloud);
    };
    const auto refused = putTogether({member("a", in(25832)), member("b", in(25833))}, false, cache());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::Unsupported);
    EXPECT_EQ(refused.error().field, "with");
    EXPECT_NE(refused.error().message.find("25832"), std::string::npos) << refused.error().message;
    EXPECT_NE(refused.error().message.find("25833"), std::string::npos);
    EXPECT_TRUE(putTogether({member("a", in(25832)), member("b", in(25832))}, false, cache()));
    EXPECT_TRUE(putTogether({member("a", in(25832)), member("b", ballCloud())}, false, cache()))
        << "not known";
    const auto tiny = cacheOf(4096);
    const auto large = putTogether({member("a", groundCloud()), member("b", ballCloud())}, false, tiny);
    ASSERT_FALSE(large);
    EXPECT_EQ(large.error().code, ErrorCode::ResourceLimit);
}

TEST(TogetherRefuses, MoreThanThereIsMemoryForAtATime) {
    const auto shifted = [](double by) {
        TogetherMember moved = member("ball", ballCloud());
        moved.shift.z = by;
        return std::vector{member("ground", groundCloud()), moved};
    };
    const std::uint64_t nodes = groundCloud()->octree.nodes().size() + ballCloud()->octree.nodes().size();
    const auto little = cacheOf(6 * nodes * bytesPerNodeTogether);  // a quarter holds one and a half
    auto first = putTogether(shifted(1), false, little);
    ASSERT_TRUE(first) << first.error().message;
    const auto second = putTogether(shifted(2), false, little);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, ErrorCode::Unavailable);
    first = fail(ErrorCode::Cancelled, "gone");
    EXPECT_TRUE(putTogether(shifted(2), false, little));
}

}  // namespace
}  // namespace scancast::test
