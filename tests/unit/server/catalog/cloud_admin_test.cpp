#include "server/catalog/cloud_admin.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "tests/support/serving/fake_painter.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

class CloudAdminTest : public ::testing::Test {
  protected:
    CloudAdminTest() {
        fs::create_directories(root / "scans");
        for (const fs::path& file :
             {root / "scans" / "church.las", folder / "secret.las", folder / "rootless.las"})
            std::ofstream(file) << "points";
        fs::create_symlink(folder / "secret.las", root / "link.las");
        fs::create_symlink("scans/church.las", root / "inside.las");
        fs::create_symlink(root / "scans" / "church.las", root / "absolute.las");
        fs::create_symlink("loop.las", root / "loop.las");
        ::mkfifo((root / "pipe.las").c_str(), 0600);
        admin.loadWith([this](ScanInput input, const std::string& id) {
            loaded.emplace_back(std::move(input), id);
            return room;
        });
    }
    int refusal(const AddCloud& asked) {
        const auto added = admin.add(asked);
        return added ? 0 : added.error().status;
    }

    const test::TemporaryFolder folder;
    const fs::path root = folder / "root";
    Catalog catalog;
    CloudAdmin admin{catalog, root, 256};
    std::vector<std::pair<ScanInput, std::string>> loaded;
    bool room = true;
};

TEST_F(CloudAdminTest, AFileBelowTheRootIsLoadedInTheBackground) {
    EXPECT_EQ(admin.add({"scans/church.las", "", ""}).value(), "church");
    EXPECT_EQ(admin.add({"scans/church.las", "", ""}).value(), "church-2");
    EXPECT_EQ(admin.add({"scans/../inside.las", "nave", "The nave"}).value(), "nave");
    ASSERT_EQ(loaded.size(), 3U);
    EXPECT_EQ(loaded[2].first.file().identity(), loaded[0].first.file().identity());
    EXPECT_EQ(loaded[2].second, "nave");
    EXPECT_EQ(catalog.find("nave")->state, CloudState::Loading);
    EXPECT_EQ(catalog.find("nave")->title, "The nave");
}

TEST_F(CloudAdminTest, NothingOutsideIsEverOpened) {
    for (const char* file :
         {"../secret.las", "scans/../../secret.las", "link.las", "absolute.las", "", "../rootless.las"})
        EXPECT_EQ(refusal({file, "", ""}), 403) << file;
    EXPECT_EQ(refusal({(root / "scans" / "church.las").string(), "", ""}), 403) << "absolute";
    EXPECT_EQ(refusal({std::string("scans\0/church.las", 17), "", ""}), 403);
    EXPECT_EQ(refusal({"scans/none.las", "", ""}), 404);
    EXPECT_EQ(refusal({"scans", "", ""}), 422);
    EXPECT_EQ(refusal({"pipe.las", "", ""}), 422) << "and nobody waits for a writer";
    EXPECT_EQ(refusal({"loop.las", "", ""}), 422);
    EXPECT_TRUE(loaded.empty());
    EXPECT_TRUE(catalog.list().empty());
    CloudAdmin rootless(catalog, {}, 256);
    EXPECT_EQ(rootless.add({"scans/church.las", "", ""}).error().status, 403);
}

// Between the request and its turn in the loader, somebody who may write there puts a link to a secret in its
// place.
TEST_F(CloudAdminTest, WhatWasCheckedIsWhatIsLoaded) {
    ASSERT_TRUE(admin.add({"scans/church.las", "", ""}));
    fs::remove(root / "scans" / "church.las");
    fs::create_symlink(folder / "secret.las", root / "scans" / "church.las");
    std::ofstream(folder / "secret.las") << "a secret";
    ASSERT_EQ(loaded.size(), 1U);
    EXPECT_EQ(loaded[0].first.file().text(100).value(), "points");
}

TEST_F(CloudAdminTest, IdsAreNamesAndTakenOnce) {
    EXPECT_EQ(refusal({"scans/church.las", "a/b", ""}), 400);
    EXPECT_EQ(refusal({"scans/church.las", "nave", ""}), 0);
    EXPECT_EQ(refusal({"scans/church.las", "nave", ""}), 409);
}

TEST_F(CloudAdminTest, AsManyCloudsAsMayBe) {
    CloudAdmin few(catalog, root, 2);
    few.loadWith([](const ScanInput&, const std::string&) { return true; });
    catalog.addLive("camera");
    const std::string id = few.add({"scans/church.las", "", ""}).value();
    const auto refused = few.add({"scans/church.las", "", ""});
    ASSERT_FALSE(refused) << "live ones count";
    EXPECT_EQ(refused.error().status, 409);
    EXPECT_NE(refused.error().detail.find("2 clouds"), std::string::npos) << refused.error().detail;
    EXPECT_NE(refused.error().detail.find("--max-clouds"), std::string::npos);
    EXPECT_EQ(catalog.size(), 2U);
    catalog.setFailed(id, "damaged");
    ASSERT_TRUE(few.remove(id));
    EXPECT_TRUE(few.add({"scans/church.las", "", ""}));
}

TEST_F(CloudAdminTest, WithoutRoomNothingIsLeftBehind) {
    room = false;
    EXPECT_EQ(refusal({"scans/church.las", "", ""}), 503);
    EXPECT_TRUE(catalog.list().empty());
    admin.loadWith({});
    EXPECT_EQ(refusal({"scans/church.las", "", ""}), 503);
}

TEST_F(CloudAdminTest, RemovingFreesTheCloudAndLeavesTheFile) {
    const std::string id = admin.add({"scans/church.las", "", ""}).value();
    EXPECT_EQ(admin.remove(id).error().status, 409) << "it is being loaded";
    auto cloud = test::tinyCloud();
    const std::weak_ptr<const Cloud> watched = cloud;
    catalog.setReady(id, std::move(cloud));
    EXPECT_TRUE(admin.remove(id));
    EXPECT_TRUE(watched.expired());
    EXPECT_EQ(admin.remove(id).error().status, 404);
    EXPECT_TRUE(fs::exists(root / "scans" / "church.las"));
}

}  // namespace
}  // namespace scancast
