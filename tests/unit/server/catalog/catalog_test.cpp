#include "server/catalog/catalog.hpp"

#include <gtest/gtest.h>

#include "renderer/cloud/cloud.hpp"
#include "tests/support/serving/fake_painter.hpp"

namespace scancast {
namespace {

TEST(Catalog, IdsAreSafeInUrls) {
    EXPECT_EQ(cloudIdFor("guanyin-statue"), "guanyin-statue");
    EXPECT_EQ(cloudIdFor("Old Town (2021)"), "Old-Town-2021");
    EXPECT_EQ(cloudIdFor("../../etc/passwd"), "etc-passwd");
    EXPECT_EQ(cloudIdFor("..."), "cloud");
    EXPECT_EQ(cloudIdFor(""), "cloud");
    EXPECT_EQ(cloudIdFor("観音"), "cloud");
    EXPECT_EQ(cloudIdFor("a%2Fb?c#d"), "a-2Fb-c-d");
    EXPECT_LE(cloudIdFor(std::string(1000, 'x')).size(), 64U);
}

TEST(Catalog, IdsAreUnique) {
    Catalog catalog;
    EXPECT_EQ(catalog.add("town"), "town");
    EXPECT_EQ(catalog.add("town"), "town-2");
    EXPECT_EQ(catalog.add("town"), "town-3");
    EXPECT_EQ(catalog.add("town-2"), "town-2-2");
}

TEST(Catalog, FromLoadingToReady) {
    Catalog catalog;
    const std::string id = catalog.add("town");
    EXPECT_FALSE(catalog.settled());
    EXPECT_EQ(catalog.cloud(id).error().status, 503);
    catalog.setProgress(id, "reading", 25, 100);
    EXPECT_EQ(catalog.find(id)->progress, 0.25);
    catalog.setProgress(id, "sorting", 5, 0);
    EXPECT_FALSE(catalog.find(id)->progress);
    EXPECT_EQ(catalog.find(id)->stage, "sorting");
    catalog.setReady(id, test::tinyCloud(12));
    EXPECT_TRUE(catalog.settled());
    EXPECT_EQ(catalog.pointsResident(), 12U);
    EXPECT_TRUE(catalog.cloud(id));
    EXPECT_EQ(catalog.cloud("other").error().status, 404);
}

TEST(Catalog, ALiveCloudIsReplacedAgainAndAgain) {
    Catalog catalog;
    const std::string id = catalog.addLive("depth");
    EXPECT_TRUE(catalog.isLive(id));
    EXPECT_FALSE(catalog.settled());
    EXPECT_EQ(catalog.cloud(id).error().status, 503);
    LiveStatus status;
    for (std::uint64_t n = 1; n <= 3; ++n) {
        status.shown = n;
        catalog.setLive(id, status, test::tinyCloud(n));
        EXPECT_EQ((*catalog.cloud(id))->points, n);
    }
    EXPECT_TRUE(catalog.settled());
    status.state = LiveStatus::State::Broken;
    status.error = "it broke off";
    catalog.setLive(id, status);
    EXPECT_EQ((*catalog.cloud(id))->points, 3U) << "the last one stays";
    EXPECT_EQ(catalog.find(id)->live->error, "it broke off");
    EXPECT_FALSE(catalog.isLive("other"));
    EXPECT_FALSE(catalog.isLive(catalog.add("still")));
    catalog.setLive("other", status, test::tinyCloud());
}

TEST(Catalog, AFailedCloudIsNoReasonToWait) {
    Catalog catalog;
    const std::string bad = catalog.add("bad");
    const std::string good = catalog.add("good");
    catalog.setFailed(bad, "bad.las ends too early");
    EXPECT_FALSE(catalog.settled());
    catalog.setReady(good, test::tinyCloud());
    EXPECT_TRUE(catalog.settled());
    EXPECT_EQ(catalog.defaultId(), good);
    EXPECT_EQ(catalog.cloud(bad).error().status, 404);
    EXPECT_NE(catalog.cloud(bad).error().detail.find("ends too early"), std::string::npos);
    catalog.setPreview(bad, test::tinyCloud());
    EXPECT_FALSE(catalog.cloud(bad));
}

TEST(Catalog, APreviewCanBeLookedAtWhileTheRestIsLoaded) {
    Catalog catalog;
    catalog.add("first");
    const std::string id = catalog.add("town");
    catalog.setProgress(id, "reading", 1, 2);
    catalog.setPreview(id, test::tinyCloud(3));
    ASSERT_TRUE(catalog.cloud(id));
    EXPECT_EQ((*catalog.cloud(id))->points, 3U);
    EXPECT_EQ(catalog.defaultId(), id);
    EXPECT_EQ(catalog.find(id)->state, CloudState::Loading);
    EXPECT_EQ(catalog.find(id)->progress, 0.5);
    catalog.setReady(id, test::tinyCloud(100));
    catalog.setPreview(id, test::tinyCloud(3));
    EXPECT_EQ((*catalog.cloud(id))->points, 100U) << "a late preview never takes the place of the cloud";
}

TEST(Catalog, WhatCannotBeReachedIsNotWaitedForOnceSomethingIsShown) {
    Catalog catalog;
    const std::string away = catalog.add("away"), town = catalog.add("town");
    catalog.setProgress(away, Catalog::waitingStage, 0, 0);
    EXPECT_FALSE(catalog.settled());
    catalog.setReady(town, test::tinyCloud());
    EXPECT_TRUE(catalog.settled());
    Catalog other;
    const std::string late = other.add("away");
    other.setReady(other.add("town"), test::tinyCloud());
    EXPECT_FALSE(other.settled());
    other.setProgress(late, Catalog::waitingStage, 0, 0);
    EXPECT_TRUE(other.settled());
}

TEST(Catalog, ACloudIsReplacedWhereItIsStillShown) {
    Catalog catalog;
    const std::string id = catalog.add("town");
    const std::shared_ptr<const Cloud> first = test::tinyCloud(1), second = test::tinyCloud(2);
    EXPECT_FALSE(catalog.replace(id, nullptr, first)) << "it is Loading";
    catalog.setReady(id, first);
    EXPECT_FALSE(catalog.replace(id, second, first));
    EXPECT_FALSE(catalog.replace("nobody", first, second));
    EXPECT_TRUE(catalog.replace(id, first, fail(ErrorCode::Truncated, "it was cut short")));
    EXPECT_EQ(catalog.find(id)->state, CloudState::Failed);
    EXPECT_EQ(catalog.cloud(id).error().status, 404);
    EXPECT_NE(catalog.cloud(id).error().detail.find("it was cut short"), std::string::npos);
    EXPECT_TRUE(catalog.replace(id, nullptr, second));
    EXPECT_EQ(*catalog.cloud(id), second);
    EXPECT_TRUE(catalog.settled()) << "what comes and goes later changes nothing";
}

TEST(Catalog, NothingButFailuresIsNeverReady) {
    Catalog catalog;
    catalog.setFailed(catalog.add("bad"), "broken");
    EXPECT_FALSE(catalog.settled());
    EXPECT_FALSE(Catalog().settled());
}

}  // namespace
}  // namespace scancast
