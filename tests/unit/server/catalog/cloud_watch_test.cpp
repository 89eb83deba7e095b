// Cloud files that are replaced, overwritten, cut short, described anew or damaged while they are served: the loader
// and its watch, on real files.
#include "server/catalog/cloud_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <mutex>
#include <thread>

#include "renderer/look/keep_look.hpp"
#include "server/catalog/loader.hpp"
#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/clouds/write_cloud.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using ::testing::HasSubstr;

class CloudWatchTest : public testing::Test {
  protected:
    void SetUp() override { write("town.scan", 6000); }

    /// A cloud file of so many points, which tell it apart.
    void write(const std::string& name, std::uint64_t points) {
        SyntheticSource source(points, ground, {});
        writeCloud(*build(source), folder / name);
    }
    /// Into the file that is there, as `cp` does.
    void overwrite(const fs::path& from, const fs::path& onto) {
        std::ifstream in(from, std::ios::binary);
        std::ofstream(onto, std::ios::binary | std::ios::trunc) << in.rdbuf();
    }
    /// Turns a byte in the middle of a leaf's block.
    static void damageLeaf(const fs::path& path) {
        std::uint64_t at = 0;
        {
            const auto file = CloudFile::open(path);
            ASSERT_TRUE(file) << file.error().message;
            const BlockPlace& place = (*file)->nodes().back().samples;
            at = place.offset + place.bytes / 2;
        }
        std::fstream bytes(path, std::ios::binary | std::ios::in | std::ios::out);
        bytes.seekg(std::streamoff(at));
        const char turned = char(~bytes.get());
        bytes.seekp(std::streamoff(at));
        bytes.put(turned);
    }

    LoaderOptions options() {
        LoaderOptions options;
        options.damage = std::make_shared<DamageReports>();
        BlockCacheOptions cache;
        cache.memoryLimit = std::uint64_t(256) << 20;
        cache.onDamaged = [damage = options.damage](const auto& file, const Error& error) {
            damage->add(file, error);
        };
        options.cache = BlockCache::create(cache);
        options.version = "1";
        options.watchInterval = 5ms;
        const auto say = [this](const std::string& line) {
            const std::lock_guard lock(mutex);
            said.push_back(line);
        };
        options.onNote = say;
        options.onFailed = [say](const Error& error) { say("refused: " + error.message); };
        options.onDamaged = [say](const CloudFile&, const Error& error) { say("damaged: " + error.message); };
        options.onChanged = [this] { ++changes; };
        return options;
    }
    void load(const std::string& file, LoaderOptions with) {
        loader.emplace(std::vector<fs::path>{folder / file}, catalog, std::move(with));
        ASSERT_TRUE(soon([&] { return loader->finished(); }));
        ASSERT_EQ(entry().state, CloudState::Ready) << entry().error;
    }
    CatalogEntry entry() const { return catalog.list().front(); }
    std::uint64_t points() const { return entry().cloud ? entry().cloud->points : 0; }
    static bool soon(const std::function<bool()>& condition) {
        const auto end = std::chrono::steady_clock::now() + 60s;
        while (!condition())
            if (std::chrono::steady_clock::now() > end)
                return false;
            else
                std::this_thread::sleep_for(1ms);
        return true;
    }
    std::size_t times(const std::string& words) const {
        const std::lock_guard lock(mutex);
        return std::size_t(std::ranges::count_if(
            said, [&](const auto& line) { return line.find(words) != std::string::npos; }));
    }

    const TemporaryFolder folder;
    Catalog catalog;
    mutable std::mutex mutex;
    std::vector<std::string> said;
    std::atomic<int> changes{0};
    std::optional<Loader> loader;
};

TEST_F(CloudWatchTest, AFileThatTakesTheNameIsServedAndTheOneBeforeCanStillBeRead) {
    load("town.scan", options());
    const auto before = entry().cloud;
    write("new.scan", 7000);
    fs::rename(folder / "new.scan", folder / "town.scan");
    ASSERT_TRUE(soon([&] { return points() == 7000 && changes == 1; }));
    EXPECT_NE(pictureRevision(*entry().cloud), pictureRevision(*before));
    for (std::uint32_t node = 0; node < before->octree.nodes().size(); ++node)
        EXPECT_TRUE(before->octree.run(node)) << "pictures that have begun are finished";
    EXPECT_EQ(times("has been replaced"), 1u);
}

TEST_F(CloudWatchTest, WhoIsToldToServeFilesLooksAtOnceWhetherTheyHaveChanged) {
    LoaderOptions seldom = options();
    seldom.watchInterval = 1h;
    load("town.scan", seldom);
    write("new.scan", 7000);
    fs::rename(folder / "new.scan", folder / "town.scan");
    const auto done = loader->serve({folder / "town.scan"});
    EXPECT_EQ(done.added + done.removed + done.tried, 0u);
    EXPECT_TRUE(soon([&] { return points() == 7000; }));
}

TEST_F(CloudWatchTest, AFileThatIsOverwrittenIsServedAnewAndNothingOfBothIsMixed) {
    load("town.scan", options());
    const auto before = entry().cloud;
    write("new.scan", 7000);
    overwrite(folder / "new.scan", folder / "town.scan");
    ASSERT_TRUE(soon([&] { return points() == 7000; }));
    SyntheticSource same(6000, ground, {});
    const auto truth = build(same);
    for (std::uint32_t node = 0; node < before->octree.nodes().size(); ++node) {
        const auto run = before->octree.run(node);
        if (!run) continue;  // overwritten before it was read
        EXPECT_TRUE(
            std::ranges::equal(std::as_bytes(run->samples), std::as_bytes(truth->octree.run(node)->samples)));
    }
    EXPECT_EQ(times("damaged:"), 0u) << "it is told as what it is";
}

TEST_F(CloudWatchTest, AFileThatIsCutShortIsRefusedUntilItIsWholeAgain) {
    load("town.scan", options());
    fs::copy_file(folder / "town.scan", folder / "copy.scan");
    fs::resize_file(folder / "town.scan", fs::file_size(folder / "town.scan") / 2);
    ASSERT_TRUE(soon([&] { return entry().state == CloudState::Failed && changes == 1; }));
    EXPECT_THAT(entry().error, HasSubstr("town.scan"));
    EXPECT_THAT(entry().error, ::testing::Not(HasSubstr(folder.path().string())));
    EXPECT_FALSE(catalog.cloud("town"));
    ASSERT_TRUE(soon([&] { return times("refused: town: town.scan has changed while it was served") == 1; }));
    fs::rename(folder / "copy.scan", folder / "town.scan");
    ASSERT_TRUE(soon([&] { return entry().state == CloudState::Ready; }));
    EXPECT_EQ(points(), 6000u);
    EXPECT_TRUE(entry().error.empty());
    EXPECT_EQ(times("refused:"), 1u) << "once";
}

TEST_F(CloudWatchTest, WhatIsNoCloudFileTakesNoCloudsPlace) {
    load("town.scan", options());
    const auto before = entry().cloud;
    std::ofstream(folder / "text") << "not a cloud";
    fs::rename(folder / "text", folder / "town.scan");
    ASSERT_TRUE(soon([&] { return times("what was opened before is served on") == 1; }));
    EXPECT_EQ(entry().cloud, before);
    EXPECT_EQ(entry().state, CloudState::Ready);
    fs::remove(folder / "town.scan");
    ASSERT_TRUE(soon([&] { return times("there is no such file") == 1; }));
    EXPECT_EQ(entry().cloud, before);
    EXPECT_EQ(changes, 0);
}

TEST_F(CloudWatchTest, WhatIsBeneathAFolderIsLookedForThereAndNowhereElse) {
    fs::create_directories(folder / "root");
    fs::rename(folder / "town.scan", folder / "root" / "town.scan");
    write("outside.scan", 7000);
    loader.emplace(std::vector<fs::path>{}, catalog, options());
    ASSERT_EQ(catalog.add("town"), "town");
    const auto root = InputFolder::open(folder / "root");
    ASSERT_TRUE(root);
    ASSERT_TRUE(loader->load(*ScanInput::openBeneath(*root, "town.scan"), "town"));
    ASSERT_TRUE(soon([&] { return points() == 6000; }));
    fs::create_symlink(folder / "outside.scan", folder / "root" / "link");
    fs::rename(folder / "root" / "link", folder / "root" / "town.scan");
    ASSERT_TRUE(soon([&] { return times("what was opened of it is served on") == 1; }));
    EXPECT_EQ(points(), 6000u);
    write("root/new.scan", 8000);
    fs::rename(folder / "root" / "new.scan", folder / "root" / "town.scan");
    ASSERT_TRUE(soon([&] { return points() == 8000; }));
}

TEST_F(CloudWatchTest, AnotherLookIsShownOfTheSameBlocks) {
    load("town.scan", options());
    const auto before = entry().cloud;
    ASSERT_TRUE(before->look);
    Look look = *before->look;
    look.kind = look.kind == SceneKind::Object ? SceneKind::Street : SceneKind::Object;
    const auto kept = keepLook(folder / "town.scan", look);
    ASSERT_TRUE(kept) << kept.error().message;
    ASSERT_TRUE(soon([&] { return entry().cloud != before && changes == 1; }));
    EXPECT_EQ(entry().cloud->look->kind, look.kind);
    EXPECT_EQ(entry().cloud->octree.source(), before->octree.source()) << "nothing is read a second time";
    EXPECT_NE(pictureRevision(*entry().cloud), pictureRevision(*before));
    // A new time of change alone is nothing to tell of.
    fs::last_write_time(folder / "town.scan", fs::file_time_type::clock::now() + 1h);
    std::this_thread::sleep_for(20ms);
    write("new.scan", 7000);
    fs::rename(folder / "new.scan", folder / "town.scan");
    ASSERT_TRUE(soon([&] { return points() == 7000; }));
    ASSERT_TRUE(soon([&] { return changes == 2; }));
    EXPECT_EQ(times("damaged:") + times("refused:"), 0u);
}

TEST_F(CloudWatchTest, ADamagedBlockIsToldAndTheFileRepairedInPlaceIsReadAnew) {
    fs::copy_file(folder / "town.scan", folder / "copy.scan");
    damageLeaf(folder / "town.scan");
    load("town.scan", options());
    const auto last = std::uint32_t(entry().cloud->octree.nodes().size() - 1);
    EXPECT_FALSE(entry().cloud->octree.run(last));
    ASSERT_TRUE(soon([&] { return times("damaged:") == 1; }));
    overwrite(folder / "copy.scan", folder / "town.scan");
    EXPECT_TRUE(soon([&] {
        const auto now = entry().cloud;  // none, where it was looked at while it was being written
        return now != nullptr && now->octree.run(last).has_value();
    }));
}

TEST_F(CloudWatchTest, ADamagedKeptFileIsBuiltAnewOnceAndNotInALoop) {
    fs::create_directories(folder / "cache");
    std::ofstream text(folder / "ground.xyz");
    for (std::uint64_t i = 0; i < 6000; ++i) {
        const auto p = ground(i, 6000).position;
        text << p.x << ' ' << p.y << ' ' << p.z << '\n';
    }
    text.close();
    LoaderOptions keep = options();
    keep.kept = std::make_shared<KeptClouds>(KeptCloudsOptions{.folder = folder / "cache"});
    load("ground.xyz", keep);
    const std::string revision = pictureRevision(*entry().cloud);
    loader.reset();
    const fs::path kept = fs::directory_iterator(folder / "cache")->path();
    damageLeaf(kept);
    catalog.remove("ground");
    changes = 0;

    LoaderOptions again = options();
    again.kept = std::make_shared<KeptClouds>(KeptCloudsOptions{.folder = folder / "cache"});
    load("ground.xyz", again);
    ASSERT_TRUE(soon([&] { return times("has been built anew") == 1 && changes == 1; }));
    EXPECT_EQ(times("damaged:"), 1u);
    EXPECT_EQ(pictureRevision(*entry().cloud), revision) << "the same cloud";
    const auto last = std::uint32_t(entry().cloud->octree.nodes().size() - 1);
    EXPECT_TRUE(entry().cloud->octree.run(last));

    fs::copy_file(kept, folder / "copy.scan");
    damageLeaf(folder / "copy.scan");
    fs::rename(folder / "copy.scan", kept);
    ASSERT_TRUE(soon([&] { return times("is damaged again") == 1; }));
    ASSERT_TRUE(soon([&] { return loader->finished(); }));
    EXPECT_EQ(times("has been built anew"), 1u);
    EXPECT_FALSE(entry().cloud->octree.run(last));
}

}  // namespace
}  // namespace scancast::test
