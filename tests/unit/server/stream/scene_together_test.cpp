// Several clouds in a session's scene: what a client may see of what somebody else shows, and what is left where a cloud is gone.
#include <gtest/gtest.h>

#include "renderer/together/together.hpp"
#include "server/catalog/visible_clouds.hpp"
#include "server/stream/scene.hpp"
#include "tests/support/serving/fake_painter.hpp"

namespace scancast::test {
namespace {

/// The clouds that somebody may see; anything can be drawn.
class SeenBy final : public StreamWorld {
  public:
    explicit SeenBy(VisibleClouds clouds) : clouds_(std::move(clouds)) {}
    std::string defaultCloud() const override { return clouds_.defaultId(); }
    tl::expected<std::shared_ptr<const Cloud>, Problem> cloud(std::string_view id) const override {
        return clouds_.cloud(id);
    }
    Expected<std::shared_ptr<const Cloud>> viewed(std::string_view id, const View& view) const override {
        return clouds_.viewed(id, view);
    }
    bool loading(std::string_view id) const override {
        const auto entry = clouds_.find(id);
        return entry && entry->state == CloudState::Loading;
    }
    bool live(std::string_view id) const override { return clouds_.isLive(id); }
    Expected<std::shared_ptr<const PlannedView>> plan(const Cloud&, const View&) const override {
        return nullptr;
    }
    double ownDetail(const View&) const override { return 1; }
    std::vector<std::string> methodNames() const override { return {}; }

  private:
    const VisibleClouds clouds_;
};

class SceneTogether : public ::testing::Test {
  protected:
    void SetUp() override {
        for (const char* id : {"one", "two", "three"}) catalog.setReady(catalog.add(id), tinyCloud(id[1]));
        shown.cloudId = "one";
        shown.view.with = {{"two", {0, 0, 1}, std::nullopt, false},
                           {".", {}, Rgb8{255, 0, 0}, false},
                           {"three", {}, {}, false}};
    }
    static std::vector<std::string> namesOf(const Scene& scene) {
        std::vector<std::string> names;
        for (const TogetherMember& member : scene.cloud->together->members) names.push_back(member.name);
        return names;
    }

    Catalog catalog;
    SharedView shown;
    static constexpr std::uint64_t pixels = 1'000'000;
};

TEST_F(SceneTogether, WhoFollowsSeesOfTheLeadersCloudsThoseThatHeMaySee) {
    const SeenBy all{VisibleClouds(catalog)}, guests{VisibleClouds(catalog, "one")};
    const auto users = SceneResolver(all, nullptr, pixels).followed(shown, 64, 48);
    ASSERT_TRUE(users);
    EXPECT_EQ(namesOf(*users), (std::vector<std::string>{"one", "two", "three"}));
    EXPECT_EQ(users->view.with, shown.view.with);
    const auto guest = SceneResolver(guests, nullptr, pixels).followed(shown, 64, 48);
    ASSERT_TRUE(guest);
    EXPECT_EQ(namesOf(*guest), std::vector<std::string>{"one"});
    EXPECT_EQ(guest->view.with, (ViewedClouds{shown.view.with[1]})) << "nor does the view name them";
    shown.view.with = {{"two", {}, {}, false}};
    const auto alone = SceneResolver(guests, nullptr, pixels).followed(shown, 64, 48);
    ASSERT_TRUE(alone);
    EXPECT_FALSE(alone->cloud->together);
}

TEST_F(SceneTogether, WhatAClientNamesItselfIsThereOrRefused) {
    const SeenBy guests{VisibleClouds(catalog, "one")};
    const SceneResolver scenes(guests, nullptr, pixels);
    messages::Hello hello;
    hello.cloud = "one";
    hello.width = 64;
    hello.height = 48;
    const auto own = scenes.opened(hello);
    ASSERT_TRUE(own);
    const auto change = [&](const char* id) {
        return scenes.changed(*own,
                              {.seq = 1, .cloud = std::nullopt, .changes = {{"with", {{{"cloud", id}}}}}});
    };
    ASSERT_FALSE(change("two"));
    Problem hidden = change("two").error(), none = change("six").error();
    EXPECT_EQ(hidden.status, 404);
    EXPECT_EQ(hidden.errors.at(0).parameter, "with");
    none.detail.replace(none.detail.find("six"), 3, "two");
    EXPECT_EQ(hidden.detail, none.detail);
    EXPECT_TRUE(change("."));
    EXPECT_EQ(scenes.known(shown.view.with), ViewedClouds{shown.view.with[1]});
}

TEST_F(SceneTogether, IsTheSameCloudUntilOneOfThemIsAnother) {
    const SeenBy all{VisibleClouds(catalog)};
    const SceneResolver scenes(all, nullptr, pixels);
    Scene scene = scenes.followed(shown, 64, 48).value();
    const auto before = scene.cloud;
    ASSERT_TRUE(scenes.lookAnew(scene));
    EXPECT_EQ(scene.cloud, before);
    scene.view.camera.eye.x += 1;
    ASSERT_TRUE(scenes.lookAnew(scene));
    EXPECT_EQ(scene.cloud, before) << "a camera makes no other cloud";
    EXPECT_TRUE(scenes.isCurrent(scene));
    catalog.replace("three", catalog.find("three")->cloud, tinyCloud(500));
    EXPECT_FALSE(scenes.isCurrent(scene));
    ASSERT_TRUE(scenes.lookAnew(scene));
    EXPECT_TRUE(scenes.isCurrent(scene));
    EXPECT_NE(scene.cloud, before);
    EXPECT_FALSE(scenes.loading(scene));
    catalog.add("later");
    catalog.setPreview("later", tinyCloud(2));
    scene.view.with.push_back({"later", {}, {}, false});
    EXPECT_TRUE(scenes.loading(scene));
    EXPECT_TRUE(scenes.lookAnew(scene)) << "coarsely";
}

}  // namespace
}  // namespace scancast::test
