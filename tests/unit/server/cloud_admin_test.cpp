#include "server/cloud_admin.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/fake_painter.hpp"
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
        fs::create_symlink(root / "scans" / "church.las", root / "inside.las");
        admin.loadWith([this](const fs::path& file, const std::string& id) {
            loaded.emplace_back(file, id);
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
    CloudAdmin admin{catalog, root};
    std::vector<std::pair<fs::path, std::string>> loaded;
    bool room = true;
};

TEST_F(CloudAdminTest, AFileBelowTheRootIsLoadedInTheBackground) {
    EXPECT_EQ(admin.add({"scans/church.las", "", ""}).value(), "church");
    EXPECT_EQ(admin.add({"scans/church.las", "", ""}).value(), "church-2");
    EXPECT_EQ(admin.add({"scans/../inside.las", "nave", "The nave"}).value(), "nave");
    ASSERT_EQ(loaded.size(), 3U);
    EXPECT_EQ(loaded[2].first, fs::canonical(root / "scans" / "church.las"));
    EXPECT_EQ(loaded[2].second, "nave");
    EXPECT_EQ(catalog.find("nave")->state, CloudState::Loading);
    EXPECT_EQ(catalog.find("nave")->title, "The nave");
}

TEST_F(CloudAdminTest, NothingOutsideIsEverOpened) {
    for (const char* file : {"../secret.las", "scans/../../secret.las", "link.las", "", "../rootless.las"})
        EXPECT_EQ(refusal({file, "", ""}), 403) << file;
    EXPECT_EQ(refusal({(root / "scans" / "church.las").string(), "", ""}), 403) << "absolute";
    EXPECT_EQ(refusal({std::string("scans\0/church.las", 17), "", ""}), 403);
    EXPECT_EQ(refusal({"scans/none.las", "", ""}), 404);
    EXPECT_EQ(refusal({"scans", "", ""}), 422);
    EXPECT_TRUE(loaded.empty());
    EXPECT_TRUE(catalog.list().empty());
    CloudAdmin rootless(catalog, {});
    EXPECT_EQ(rootless.add({"scans/church.las", "", ""}).error().status, 403);
}

TEST_F(CloudAdminTest, IdsAreNamesAndTakenOnce) {
    EXPECT_EQ(refusal({"scans/church.las", "a/b", ""}), 400);
    EXPECT_EQ(refusal({"scans/church.las", "nave", ""}), 0);
    EXPECT_EQ(refusal({"scans/church.las", "nave", ""}), 409);
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
