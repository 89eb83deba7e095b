// Looks that are decided: the same whatever the cloud is read from and however many threads look at it, sound for
// every cloud, and telling of a room that one is in it.
#include "renderer/look/decide_look.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <fstream>
#include <glm/common.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "protocol/json_text.hpp"
#include "renderer/look/keep_look.hpp"
#include "renderer/render.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "tests/support/clouds/cloud_file_bytes.hpp"
#include "tests/support/clouds/scene_clouds.hpp"
#include "tests/support/clouds/scene_points.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

std::string textOf(const Expected<Look>& look) {
    return look ? printJson(toJson(*look)) : look.error().message;
}

std::shared_ptr<const Cloud> generated(const std::string& scene) {
    static std::map<std::string, std::shared_ptr<const Cloud>> made;
    auto& cloud = made[scene];
    if (!cloud) cloud = test::sceneCloud(scene, 40000).value();
    return cloud;
}

std::shared_ptr<const Cloud> opened(const std::filesystem::path& file, std::uint64_t memory) {
    BlockCacheOptions options;
    options.memoryLimit = memory;
    return openCloud(file, BlockCache::create(options)).value();
}

/// What a look promises of itself.
void expectSound(const Cloud& cloud, const Look& look) {
    EXPECT_TRUE(validate(look));
    EXPECT_EQ(applyLook(Look{}, toJson(look)), look) << "it can be kept";
    EXPECT_FALSE(look.reason.empty());
    EXPECT_LE(look.outline.size(), Look::mostOutline);
    EXPECT_LE(look.views.size(), Look::mostViews);
    std::set<std::string> names;
    for (const LookView& view : look.views) EXPECT_TRUE(names.insert(view.name).second) << view.name;
    Cloud shown = cloud;
    shown.look = look;
    for (const double aspect : {0.5, 1.0, 16.0 / 9, 3.0})
        for (const LookView& named : viewsOf(shown, aspect)) {
            View view = defaultView(shown, int(aspect * 300), 300);
            view.camera = named.camera;
            const auto drawable = checkView(shown, view);
            EXPECT_TRUE(drawable) << named.name << ": " << drawable.error().message;
        }
}

TEST(DecideLook, IsTheSameOnAnyNumberOfThreads) {
    for (const char* scene : {"room", "sphere"}) {
        const auto cloud = generated(scene);
        const auto with = [&](std::size_t threads) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            return textOf(decideLook(*cloud));
        };
        EXPECT_EQ(with(1), with(2)) << scene;
        expectSound(*cloud, decideLook(*cloud).value());
    }
}

TEST(DecideLook, IsTheSameFromMemoryAndFromAFile) {
    const test::TemporaryFolder folder;
    constexpr std::uint64_t mebibyte = 1 << 20;
    const auto expectTheSame = [&](const Cloud& cloud, std::initializer_list<std::uint64_t> limits) {
        const auto file = folder.path() / "cloud.scan";
        const auto written = test::writeCloudFile(file, cloud.octree, cloud);
        ASSERT_TRUE(written) << written.error().message;
        const std::string wanted = textOf(decideLook(cloud));
        for (const std::uint64_t limit : limits)
            EXPECT_TRUE(textOf(decideLook(*opened(file, limit * mebibyte))) == wanted) << limit << " MiB";
    };
    expectTheSame(*generated("cube"), {1024});
    // Less than the samples take, which are 16 bytes each.
    const auto large = test::sceneCloud("room", test::sized(2'500'000, 40'000));
    ASSERT_TRUE(large) << large.error().message;
    expectTheSame(**large, {1024, 40});
}

TEST(DecideLook, ARoomIsFirstSeenFromInside) {
    const auto cloud = generated("room");
    const auto look = decideLook(*cloud);
    ASSERT_TRUE(look) << look.error().message;
    EXPECT_EQ(look->kind, SceneKind::Indoor);
    ASSERT_TRUE(look->views.front().inside) << look->reason;
    const glm::dvec3 eye = look->views.front().camera.eye;
    EXPECT_EQ(glm::clamp(eye, cloud->bounds[0], cloud->bounds[1]), eye);
    EXPECT_GT(look->noise, 0);
    EXPECT_EQ(look->style.color, ColorSource::Rgb) << "it has photographs";
}

TEST(DecideLook, WhatADepthCameraSawIsShownAsItSawIt) {
    const auto make = [](std::uint64_t i, std::uint64_t) {
        const double u = test::uniform(i, 1) * 1.2 - 0.6, v = test::uniform(i, 2) * 0.9 - 0.45;
        const double depth = std::abs(u - 0.1) < 0.08 ? 1.5 : 3 + 0.5 * u;
        test::ScanPoint p;
        p.position = {u * depth, v * depth, depth};
        p.color = {std::uint8_t(128 + 100 * std::sin(40 * u)), std::uint8_t(128 + 100 * std::sin(50 * v)),
                   90};
        return p;
    };
    test::SyntheticSource source(30000, make, {.color = true});
    const auto cloud = buildCloud(source, {});
    ASSERT_TRUE(cloud);
    const auto look = decideLook(**cloud);
    ASSERT_TRUE(look) << look.error().message;
    EXPECT_EQ(look->kind, SceneKind::DepthFrame) << look->reason;
    EXPECT_EQ(look->up, glm::dvec3(0, -1, 0));
    EXPECT_EQ(look->views.front().camera.eye, glm::dvec3(0));
    expectSound(**cloud, *look);
}

TEST(DecideLook, StraysMakeNoPictureSmaller) {
    const auto make = [](std::uint64_t i, std::uint64_t n) {
        test::ScanPoint p = test::ball(i, n);
        if (i % 5000 == 99) p.position = p.position * 300.0;
        return p;
    };
    test::SyntheticSource source(20000, make, {.color = true});
    const auto cloud = buildCloud(source, {});
    ASSERT_TRUE(cloud);
    const auto look = decideLook(**cloud);
    ASSERT_TRUE(look) << look.error().message;
    for (int a = 0; a < 3; ++a) {
        EXPECT_NEAR(look->bounds[0][a], -10, 1);
        EXPECT_NEAR(look->bounds[1][a], 10, 1);
    }
}

struct Degenerate {
    const char* name;
    std::uint64_t points;
    test::SyntheticSource::Make make;
};

/// Where no camera may stand.
bool isTooFar(const Cloud& cloud) {
    const glm::dvec3 farthest = glm::max(glm::abs(cloud.bounds[0]), glm::abs(cloud.bounds[1]));
    return std::max({farthest.x, farthest.y, farthest.z}) > 1e11;
}

class DegenerateCloud : public ::testing::TestWithParam<Degenerate> {};

TEST_P(DegenerateCloud, HasALook) {
    for (const bool surfels : {true, false})
        for (const bool colors : {true, false}) {
            test::SyntheticSource source(GetParam().points, GetParam().make, {.color = colors});
            BuildOptions options;
            options.shape.surfels = surfels;
            const auto cloud = buildCloud(source, options);
            ASSERT_TRUE(cloud) << cloud.error().message;
            const auto look = decideLook(**cloud);
            if (isTooFar(**cloud)) {
                EXPECT_FALSE(look);
                EXPECT_EQ(withLook(*cloud), *cloud) << "it is shown as one without";
                continue;
            }
            ASSERT_TRUE(look) << look.error().message;
            expectSound(**cloud, *look);
            const auto shown = withLook(*cloud);
            EXPECT_EQ(shown->look, *look);
        }
}

test::SyntheticSource::Make along(const glm::dvec3& step, const glm::dvec3& from = glm::dvec3(0)) {
    return [=](std::uint64_t i, std::uint64_t) {
        test::ScanPoint p;
        p.position = from + double(i) * step;
        p.color = {std::uint8_t(i * 40), std::uint8_t(i * 70), 9};
        return p;
    };
}

INSTANTIATE_TEST_SUITE_P(All, DegenerateCloud,
                         testing::Values(Degenerate{"OnePoint", 1, along({0, 0, 0}, {5, 6, 7})},
                                         Degenerate{"TwoPoints", 2, along({1, 2, 3})},
                                         Degenerate{"AllTheSame", 300, along({0, 0, 0}, {1, 2, 3})},
                                         Degenerate{"ALine", 1000, along({0.1, 0.2, 0.3})},
                                         Degenerate{"AnUprightLine", 1000, along({0, 0, 0.5})},
                                         Degenerate{"FarAway", 500, along({1, 1e-3, 2}, {1e9, -1e9, 1e6})},
                                         Degenerate{"BeyondAllMeasure", 500,
                                                    along({1e12, -2e12, 1e12}, {-1e14, 1e14, 0})},
                                         Degenerate{"AFarPoint", 1, along({0, 0, 0}, {1e15, -1e15, 1e15})},
                                         Degenerate{"AFlatSquare", 2500,
                                                    [](std::uint64_t i, std::uint64_t) {
                                                        test::ScanPoint p;
                                                        p.position = {double(i % 50), double(i / 50), 3};
                                                        return p;
                                                    }}),
                         [](const auto& tested) { return tested.param.name; });

TEST(DecideLook, WithoutPointsThereIsNone) {
    const auto look = decideLook(Cloud{});
    ASSERT_FALSE(look);
    EXPECT_EQ(look.error().code, ErrorCode::Empty);
    const auto cloud = std::make_shared<const Cloud>();
    EXPECT_EQ(withLook(cloud), cloud);
}

TEST(WithLook, ItsOwnStays) {
    auto cloud = std::make_shared<Cloud>(*generated("cube"));
    cloud->look = decideLook(*cloud).value();
    cloud->look->reason = "because";
    EXPECT_EQ(withLook(cloud), cloud);
}

TEST(KeepLook, IsThereWhenTheFileIsOpenedAgain) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "cube.scan";
    const auto cloud = generated("cube");
    ASSERT_TRUE(test::writeCloudFile(file, cloud->octree, *cloud));
    const auto before = opened(file, 1 << 26);
    EXPECT_FALSE(before->look);
    const auto kept = decideAndKeepLook(file, {{"reason", "so"}, {"noise", 0.25}});
    ASSERT_TRUE(kept) << kept.error().message;
    EXPECT_EQ(kept->reason, "so");
    const auto after = opened(file, 1 << 26);
    EXPECT_EQ(after->look, *kept);
    EXPECT_EQ(after->revision, before->revision) << "no block was changed";
    EXPECT_NE(pictureRevision(*after), pictureRevision(*before)) << "but what is shown";
    Look other = *kept;
    other.views.resize(1);
    ASSERT_TRUE(keepLook(file, other));
    EXPECT_EQ(opened(file, 1 << 26)->look, other);
    EXPECT_NE(pictureRevision(*opened(file, 1 << 26)), pictureRevision(*after));
}

TEST(KeepLook, WhatCannotBeKeptChangesNothing) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "cube.scan";
    const auto cloud = generated("cube");
    ASSERT_TRUE(test::writeCloudFile(file, cloud->octree, *cloud));
    const auto bytes = test::fileBytes(file);
    const auto wrong = decideAndKeepLook(file, {{"kind", "a dream"}});
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().field, "kind");
    EXPECT_FALSE(keepLook(file, Look{})) << "without a view nothing could be shown";
    EXPECT_EQ(test::fileBytes(file), bytes);
    EXPECT_FALSE(decideAndKeepLook(folder.path() / "none.scan", {}));
    std::ofstream(folder.path() / "scan.xyz") << "1 2 3\n";
    EXPECT_FALSE(keepLook(folder.path() / "scan.xyz", decideLook(*cloud).value()));
}

}  // namespace
}  // namespace scancast
