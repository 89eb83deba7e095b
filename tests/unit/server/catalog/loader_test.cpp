#include "server/catalog/loader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <future>
#include <mutex>

#include "server/catalog/preview.hpp"
#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/clouds/write_cloud.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/native/ept_bytes.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

// Right because it knows the numbers: every stride-th from the first on, of all that were added.
TEST(StrideSample, IsEvenOverAllThatWasAdded) {
    for (const std::size_t batchSize : {1u, 7u, 1000u, 65536u}) {
        StrideSample sample(1000);
        std::uint64_t added = 0;
        while (added < 150'000) {
            PointBatch batch;
            for (std::size_t i = 0; i < batchSize; ++i, ++added) {
                batch.position.emplace_back(double(added), 0, 0);
                batch.intensity.push_back(std::uint16_t(added));
            }
            sample.add(batch);
        }
        const PointBatch& kept = sample.points();
        EXPECT_EQ(kept.size(), (added + sample.stride() - 1) / sample.stride());
        EXPECT_LE(kept.size(), 1000u);
        EXPECT_GE(kept.size(), 499u);
        ASSERT_EQ(kept.intensity.size(), kept.size());
        EXPECT_TRUE(kept.color.empty());
        for (std::size_t k = 0; k < kept.size(); ++k) {
            ASSERT_EQ(kept.position[k].x, double(k * sample.stride()));
            ASSERT_EQ(kept.intensity[k], std::uint16_t(k * sample.stride()));
        }
    }
}

TEST(Preview, ShowsWhatHasBeenReadAndPassesEverythingOn) {
    std::mutex mutex;
    std::vector<std::shared_ptr<const Cloud>> shown;
    PreviewOptions options;
    options.title = "ground";
    options.mostPoints = 5000;
    options.mostOfFirst = 500;
    options.first = options.second = 0ms;
    options.show = [&](std::shared_ptr<const Cloud> cloud) {
        const std::lock_guard lock(mutex);
        shown.push_back(std::move(cloud));
    };
    std::shared_ptr<const Cloud> whole;
    {
        PreviewSource source(
            std::make_unique<test::SyntheticSource>(300'000, test::ground, Attributes{.color = true}),
            options);
        whole = test::build(source);
    }
    test::SyntheticSource direct(300'000, test::ground, {.color = true});
    EXPECT_EQ(whole->revision, test::build(direct)->revision);
    ASSERT_GE(shown.size(), 2u) << "early, and when everything is read";
    for (std::size_t i = 0; i < shown.size(); ++i) {
        EXPECT_GT(shown[i]->points, i == 0 ? 200u : 2000u);
        EXPECT_LE(shown[i]->points, i == 0 ? 500u : 5000u);
        EXPECT_TRUE(shown[i]->attributes.color);
    }
    // The last one is of everything: it reaches as far as the scan does.
    EXPECT_GT(shown.back()->bounds[1].y, 195);
}

/// With every 100th of its points to glance at.
class GlancedSource final : public test::SyntheticSource {
  public:
    using SyntheticSource::SyntheticSource;
    Expected<PointBatch> glance() override {
        test::SyntheticSource few(*header().points / 100, test::ground, header().attributes);
        PointBatch all, part;
        while (few.read(part).value()) append(all, part);
        return all;
    }
};

TEST(Preview, AGlanceIsShownAtOnceAndFillsWhatIsNotRead) {
    std::vector<std::shared_ptr<const Cloud>> shown;
    PreviewOptions options;
    options.mostPoints = 5000;
    options.second = 0ms;
    options.show = [&](std::shared_ptr<const Cloud> cloud) { shown.push_back(std::move(cloud)); };
    {
        PreviewSource source(std::make_unique<GlancedSource>(300'000, test::ground, Attributes{}), options);
        PointBatch batch;
        while (source.read(batch).value()) continue;
    }
    ASSERT_GE(shown.size(), 2u);
    EXPECT_EQ(shown.front()->points, 3000u);
    for (const auto& cloud : shown) EXPECT_GT(cloud->bounds[1].y, 190) << "as far as the scan reaches";
    EXPECT_LE(shown.back()->points, 5000u) << "all is read: no point twice";
}

class LoaderTest : public testing::Test {
  protected:
    void SetUp() override {
        fs::create_directories(folder_ / "cache");
        std::ofstream text(folder_ / "ground.xyz");
        for (std::uint64_t i = 0; i < 20'000; ++i) {
            const auto p = test::ground(i, 20'000).position;
            text << p.x << ' ' << p.y << ' ' << p.z << '\n';
        }
    }

    LoaderOptions options(std::uint64_t memoryLimit = std::uint64_t(1) << 30) {
        BlockCacheOptions cache;
        cache.memoryLimit = memoryLimit;
        LoaderOptions options;
        options.cache = cache_ = BlockCache::create(cache);
        options.version = "1";
        return options;
    }
    /// Until everything has been loaded, or for far longer than any test takes.
    static void awaitEnd(const Loader& loader) {
        const auto end = std::chrono::steady_clock::now() + 60s;
        while (!loader.finished() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(1ms);
    }
    /// What the catalog says when everything has been loaded.
    CatalogEntry load(const fs::path& file, LoaderOptions options) {
        Loader loader({file}, catalog_, std::move(options));
        awaitEnd(loader);
        return catalog_.list().back();
    }
    std::vector<fs::path> kept() const {
        std::vector<fs::path> files;
        for (const auto& entry : fs::directory_iterator(folder_ / "cache")) files.push_back(entry.path());
        return files;
    }

    const test::TemporaryFolder folder_;
    Catalog catalog_;
    std::shared_ptr<BlockCache> cache_;
};

TEST_F(LoaderTest, AScanIsBuiltInMemoryAndCounted) {
    const auto entry = load(folder_ / "ground.xyz", options());
    ASSERT_TRUE(entry.cloud) << entry.error;
    EXPECT_EQ(entry.state, CloudState::Ready);
    EXPECT_EQ(entry.cloud->points, 20'000u);
    EXPECT_TRUE(entry.cloud->octree.store().whole());
    EXPECT_GE(cache_->stats().bytes, entry.cloud->octree.bytesResident());
}

TEST_F(LoaderTest, CopcIsShownAsItIsWhereThatIsAskedForAndAnotherInItsPlaceAsWell) {
    REQUIRE_TEST_DATA("copc/ellipsoid.copc.laz");
    const fs::path file = folder_ / "shown.copc.laz", next = folder_ / "next.laz";
    fs::copy_file(test::testData("copc/ellipsoid.copc.laz"), file);
    LoaderOptions native = options();
    native.import.importerDirectory = SCANCAST_BIN_DIR;
    native.native = true;
    native.watchInterval = 20ms;
    Loader loader({file}, catalog_, native);
    awaitEnd(loader);
    const auto entry = catalog_.list().back();
    ASSERT_TRUE(entry.cloud) << entry.error;
    EXPECT_EQ(entry.cloud->points, 100'000u);
    EXPECT_FALSE(entry.cloud->octree.store().whole());
    EXPECT_TRUE(entry.cloud->look);
    EXPECT_TRUE(entry.cloud->octree.run(0));

    fs::copy_file(test::testData("copc/simple_with_page.copc.laz"), next);
    fs::rename(next, file);
    const auto end = std::chrono::steady_clock::now() + 60s;
    while (catalog_.list().back().cloud == entry.cloud && std::chrono::steady_clock::now() < end)
        std::this_thread::sleep_for(5ms);
    EXPECT_EQ(catalog_.list().back().cloud->points, 1065u);
}

TEST_F(LoaderTest, EptIsShownAsItIsByItsFolderAndAnotherInItsPlaceAsWell) {
    const auto write = [&](std::size_t points, const fs::path& last) {
        const auto set = test::EptMaker::make(test::CopcMaker::make(test::wavyPoints(points), 300),
                                              test::EptMaker::Kind::Binary);
        for (const auto& [name, bytes] : set.files) {
            const fs::path file = folder_ / "set" / (name == "ept.json" ? last : fs::path(name));
            fs::create_directories(file.parent_path());
            std::ofstream(file, std::ios::binary)
                .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
        }
    };
    write(1000, "ept.json");
    LoaderOptions native = options();
    native.native = true;
    native.watchInterval = 20ms;
    Loader loader({folder_ / "set"}, catalog_, native);
    awaitEnd(loader);
    const auto entry = catalog_.list().back();
    ASSERT_TRUE(entry.cloud) << entry.error;
    EXPECT_EQ(entry.id, "set");
    EXPECT_EQ(entry.cloud->points, 1000u);
    EXPECT_FALSE(entry.cloud->octree.store().whole());
    EXPECT_TRUE(entry.cloud->octree.run(0));

    // What describes it comes last.
    write(2000, "new.json");
    fs::rename(folder_ / "set/new.json", folder_ / "set/ept.json");
    const auto end = std::chrono::steady_clock::now() + 60s;
    while (catalog_.list().back().cloud == entry.cloud && std::chrono::steady_clock::now() < end)
        std::this_thread::sleep_for(5ms);
    EXPECT_EQ(catalog_.list().back().cloud->points, 2000u);
}

TEST_F(LoaderTest, MoreIsLoadedWhileItRunsAndNothingAfterItsStop) {
    Loader loader({}, catalog_, options());
    EXPECT_TRUE(loader.finished());
    ASSERT_TRUE(catalog_.addAs("later", "ground"));
    ASSERT_TRUE(loader.load(*ScanInput::open(folder_ / "ground.xyz"), "later"));
    awaitEnd(loader);
    EXPECT_EQ(catalog_.find("later")->state, CloudState::Ready);
    const std::weak_ptr<const Cloud> watched = catalog_.find("later")->cloud;
    const auto resident = cache_->stats().bytes;
    EXPECT_TRUE(catalog_.remove("later"));
    EXPECT_TRUE(watched.expired());
    EXPECT_LT(cache_->stats().bytes, resident) << "its memory is given back";
    loader.requestStop();
    EXPECT_FALSE(loader.load(*ScanInput::open(folder_ / "ground.xyz"), "later"));
}

TEST_F(LoaderTest, OtherFilesAreServedFromNowOn) {
    const fs::path ground = folder_ / "ground.xyz", late = folder_ / "late.xyz", more = folder_ / "more.xyz";
    fs::copy_file(ground, more);
    std::atomic<int> changes{0};
    LoaderOptions told = options();
    told.onChanged = [&] { ++changes; };
    Loader loader({ground, late}, catalog_, told);
    awaitEnd(loader);
    EXPECT_FALSE(loader.allFailed());
    EXPECT_EQ(catalog_.find("late")->state, CloudState::Failed);
    const std::shared_ptr<const Cloud> shown = catalog_.find("ground")->cloud;

    fs::copy_file(ground, late);
    Loader::Changes done = loader.serve({ground, late, more});
    awaitEnd(loader);
    EXPECT_EQ(done.added, 1U);
    EXPECT_EQ(done.removed, 0U);
    EXPECT_EQ(done.tried, 1U);
    EXPECT_EQ(catalog_.find("late")->state, CloudState::Ready);
    EXPECT_EQ(catalog_.find("more")->state, CloudState::Ready);
    EXPECT_EQ(catalog_.find("ground")->cloud, shown) << "it was sound, and is what it was";

    ASSERT_TRUE(catalog_.remove("more")) << "by an administrator";
    done = loader.serve({late, more});
    awaitEnd(loader);
    EXPECT_EQ(done.removed, 1U);
    EXPECT_EQ(done.tried, 1U);
    EXPECT_EQ(changes, 1);
    EXPECT_FALSE(catalog_.find("ground"));
    EXPECT_EQ(catalog_.find("more")->state, CloudState::Ready);
    done = loader.serve({late, more});
    EXPECT_EQ(done.added + done.removed + done.tried, 0U);
}

TEST_F(LoaderTest, AUrlThatIsSignedAnewIsTheSameFile) {
    LoaderOptions away = options();
    away.remote = std::make_shared<RemoteFiles>(RemoteOptions{});
    const std::string url = "http://127.0.0.1:1/town.scan?X-Amz-Signature=";  // where nobody listens
    Loader loader({url + "1"}, catalog_, away);
    Loader::Changes done = loader.serve({url + "2"}, Loader::Again::Leave);
    EXPECT_EQ(done.added + done.removed + done.tried, 0U);
    EXPECT_TRUE(catalog_.find("town"));
    done = loader.serve({"http://127.0.0.1:1/other.scan?X-Amz-Signature=2"}, Loader::Again::Leave);
    EXPECT_EQ(done.added, 1U);
    EXPECT_EQ(done.removed, 1U);
    loader.requestStop();
    away.remote->stop();
}

TEST_F(LoaderTest, WhatOthersRemovedOrCouldNotBeReadMayBeLeftAsItIs) {
    const fs::path ground = folder_ / "ground.xyz", late = folder_ / "late.xyz", more = folder_ / "more.xyz";
    fs::create_directory(folder_ / "other");
    const fs::path other = folder_ / "other" / "ground.xyz";
    Loader loader({ground, late}, catalog_, options());
    awaitEnd(loader);
    EXPECT_EQ(catalog_.find("late")->state, CloudState::Failed);
    ASSERT_TRUE(catalog_.remove("ground")) << "by an administrator";
    for (const fs::path& copy : {late, more, other}) fs::copy_file(ground, copy);
    Loader::Changes done = loader.serve({ground, late, more}, Loader::Again::Leave);
    awaitEnd(loader);
    EXPECT_EQ(done.added, 1U);
    EXPECT_EQ(done.tried, 0U);
    EXPECT_FALSE(catalog_.find("ground"));
    EXPECT_EQ(catalog_.find("late")->state, CloudState::Failed);
    EXPECT_EQ(catalog_.find("more")->state, CloudState::Ready);
    // Another file takes the name that is free; what goes with the first one is not the other's.
    loader.serve({ground, late, more, other}, Loader::Again::Leave);
    awaitEnd(loader);
    ASSERT_TRUE(catalog_.find("ground"));
    loader.serve({late, more, other}, Loader::Again::Leave);
    EXPECT_TRUE(catalog_.find("ground"));
    done = loader.serve({late, more, other, ground});
    awaitEnd(loader);
    EXPECT_EQ(done.tried, 1U);
    EXPECT_EQ(catalog_.find("late")->state, CloudState::Ready);
    EXPECT_TRUE(catalog_.find("ground-2"));
}

TEST_F(LoaderTest, WhatCouldNotBeReadMayBeTriedAgainAndWhatOthersRemovedStaysRemoved) {
    const fs::path ground = folder_ / "ground.xyz", late = folder_ / "late.xyz";
    Loader loader({ground, late}, catalog_, options());
    awaitEnd(loader);
    ASSERT_TRUE(catalog_.remove("ground")) << "by an administrator";
    fs::copy_file(ground, late);
    const Loader::Changes done = loader.serve({ground, late}, Loader::Again::TryFailed);
    awaitEnd(loader);
    EXPECT_EQ(done.tried, 1U);
    EXPECT_EQ(catalog_.find("late")->state, CloudState::Ready);
    EXPECT_FALSE(catalog_.find("ground"));
}

TEST_F(LoaderTest, WhatAnAdministratorAddedUnderTheNameOfOneThatHeRemovedIsHis) {
    Loader loader({folder_ / "ground.xyz"}, catalog_, options());
    awaitEnd(loader);
    ASSERT_TRUE(catalog_.remove("ground"));
    ASSERT_TRUE(catalog_.addAs("ground", "his"));
    ASSERT_TRUE(loader.load(*ScanInput::open(folder_ / "ground.xyz"), "ground"));
    awaitEnd(loader);
    loader.serve({});
    EXPECT_TRUE(catalog_.find("ground"));
    loader.serve({folder_ / "ground.xyz"});
    awaitEnd(loader);
    EXPECT_EQ(catalog_.list().size(), 2U);
}

// Its name is nobody else's before the thread that reads it is done: what that brings would be shown as another's.
TEST_F(LoaderTest, WhatIsBeingReadGoesWhenItHasBeen) {
    std::promise<void> begun, release;
    std::shared_future<void> mayGoOn = release.get_future().share();
    std::once_flag once;
    LoaderOptions told = options();
    told.onProgress = [&](const std::string&, const Progress&) {
        std::call_once(once, [&] { begun.set_value(); });
        mayGoOn.wait();
    };
    fs::create_directory(folder_ / "other");
    fs::copy_file(folder_ / "ground.xyz", folder_ / "other" / "ground.xyz");
    Loader loader({folder_ / "ground.xyz"}, catalog_, told);
    begun.get_future().wait();
    EXPECT_EQ(loader.serve({folder_ / "other" / "ground.xyz"}).removed, 1U);
    EXPECT_TRUE(catalog_.find("ground"));
    EXPECT_TRUE(catalog_.find("ground-2"));
    EXPECT_EQ(loader.serve({folder_ / "ground.xyz", folder_ / "other" / "ground.xyz"}).added, 0U)
        << "it may stay after all";
    EXPECT_EQ(loader.serve({folder_ / "other" / "ground.xyz"}).removed, 1U);
    release.set_value();
    awaitEnd(loader);
    EXPECT_FALSE(catalog_.find("ground"));
    EXPECT_EQ(catalog_.find("ground-2")->state, CloudState::Ready);
}

TEST_F(LoaderTest, WhoeverIsToldAndThrowsHarmsNoCloud) {
    std::ofstream(folder_ / "bad.xyz") << "no numbers\n";
    LoaderOptions telling = options();
    std::atomic<int> told{0};
    telling.onLoaded = [&](const LoadedCloud&) {
        ++told;
        throw std::bad_alloc();
    };
    telling.onFailed = [&](const Error&) {
        ++told;
        throw std::runtime_error("the log is full");
    };
    Loader loader({folder_ / "bad.xyz", folder_ / "ground.xyz"}, catalog_, telling);
    awaitEnd(loader);
    const auto entries = catalog_.list();
    ASSERT_EQ(entries.size(), 2u);
    EXPECT_EQ(entries[0].state, CloudState::Failed);
    EXPECT_THAT(entries[0].error, testing::HasSubstr("bad.xyz")) << "the reason stays";
    EXPECT_EQ(entries[1].state, CloudState::Ready) << entries[1].error;
    EXPECT_EQ(told, 2);
}

TEST_F(LoaderTest, ACloudFileIsOpened) {
    test::SyntheticSource source(30'000, test::ground, {});
    test::writeCloud(*test::build(source), folder_ / "town.scan");
    const auto entry = load(folder_ / "town.scan", options());
    ASSERT_TRUE(entry.cloud) << entry.error;
    EXPECT_EQ(entry.state, CloudState::Ready);
    EXPECT_EQ(entry.cloud->points, 30'000u);
    EXPECT_FALSE(entry.cloud->octree.store().whole());
    EXPECT_TRUE(entry.cloud->octree.store().find(0)) << "there is something to draw at once";
}

TEST_F(LoaderTest, WhatIsKeptIsOpenedTheNextTime) {
    LoaderOptions keep = options();
    keep.kept = std::make_shared<KeptClouds>(KeptCloudsOptions{.folder = folder_ / "cache"});
    ASSERT_TRUE(load(folder_ / "ground.xyz", keep).cloud);
    ASSERT_EQ(kept().size(), 1u);
    const fs::path file = kept()[0];
    const auto made = fs::last_write_time(file);
    const auto again = load(folder_ / "ground.xyz", keep);
    ASSERT_TRUE(again.cloud);
    EXPECT_EQ(again.cloud->points, 20'000u);
    EXPECT_EQ(fs::last_write_time(file), made);
    keep.version = "2";
    ASSERT_TRUE(load(folder_ / "ground.xyz", keep).cloud);
    EXPECT_EQ(kept().size(), 2u) << "another program builds anew";
    std::ofstream(folder_ / "ground.xyz", std::ios::app) << "1 2 3\n";
    EXPECT_EQ(load(folder_ / "ground.xyz", keep).cloud->points, 20'001u) << "so does another scan";
}

TEST_F(LoaderTest, ADamagedKeptFileIsBuiltAnew) {
    LoaderOptions keep = options();
    keep.kept = std::make_shared<KeptClouds>(KeptCloudsOptions{.folder = folder_ / "cache"});
    std::string note;
    keep.onNote = [&](const std::string& text) { note = text; };
    ASSERT_TRUE(load(folder_ / "ground.xyz", keep).cloud);
    fs::resize_file(kept().at(0), fs::file_size(kept().at(0)) / 2);
    const auto again = load(folder_ / "ground.xyz", keep);
    ASSERT_TRUE(again.cloud) << again.error;
    EXPECT_EQ(again.cloud->points, 20'000u);
    EXPECT_THAT(note, testing::HasSubstr("built anew"));
}

TEST_F(LoaderTest, WhatThereIsNoRoomToKeepIsShownAndSaid) {
    LoaderOptions keep = options();
    keep.kept = std::make_shared<KeptClouds>(KeptCloudsOptions{.folder = folder_ / "cache", .limit = 50'000});
    std::string note;
    keep.onNote = [&](const std::string& text) { note = text; };
    const auto entry = load(folder_ / "ground.xyz", keep);
    ASSERT_TRUE(entry.cloud) << entry.error;
    EXPECT_EQ(entry.cloud->points, 20'000u);
    EXPECT_TRUE(kept().empty());
    EXPECT_THAT(note, testing::AllOf(testing::HasSubstr("ground.xyz is not kept"),
                                     testing::HasSubstr("--cache-size")));
}

TEST_F(LoaderTest, WhatIsKeptAndShownIsNotRemovedForAnother) {
    LoaderOptions keep = options();
    keep.kept =
        std::make_shared<KeptClouds>(KeptCloudsOptions{.folder = folder_ / "cache", .limit = 4'000'000});
    fs::copy_file(folder_ / "ground.xyz", folder_ / "other.xyz");
    const auto shown = load(folder_ / "ground.xyz", keep);  // by the catalog, from now on
    ASSERT_EQ(kept().size(), 1u);
    const fs::path first = kept()[0];
    keep.kept = std::make_shared<KeptClouds>(
        KeptCloudsOptions{.folder = folder_ / "cache", .limit = fs::file_size(first) + 1000});
    ASSERT_TRUE(load(folder_ / "other.xyz", keep).cloud);
    EXPECT_EQ(kept(), std::vector<fs::path>{first});
}

TEST_F(LoaderTest, WhatDoesNotFitIntoMemoryGoesThroughAFile) {
    const auto entry = load(folder_ / "ground.xyz", options(std::uint64_t(2) << 20));
    ASSERT_TRUE(entry.cloud) << entry.error;
    EXPECT_EQ(entry.cloud->points, 20'000u);
    EXPECT_FALSE(entry.cloud->octree.store().whole());
    for (std::uint32_t node = 0; node < entry.cloud->octree.nodes().size(); ++node)
        ASSERT_TRUE(entry.cloud->octree.run(node)) << "though its name is gone";
    for (const auto& left : fs::directory_iterator(fs::temp_directory_path()))
        EXPECT_FALSE(fs::exists(left.path() / "cloud.scan")) << left.path();
}

// Nobody writes to the pipe, and nobody waits for that: neither who starts the loader, nor its thread.
TEST_F(LoaderTest, APipeADeviceAndAFolderKeepNobodyWaiting) {
    ASSERT_EQ(::mkfifo((folder_ / "pipe.las").c_str(), 0600), 0);
    fs::create_symlink("pipe.las", folder_ / "link.scan");
    for (const fs::path& file :
         {folder_ / "pipe.las", folder_ / "link.scan", fs::path("/dev/zero"), folder_.path()}) {
        const auto entry = load(file, options());
        EXPECT_EQ(entry.state, CloudState::Failed) << file;
        EXPECT_THAT(entry.error,
                    testing::AnyOf(testing::HasSubstr("not a file"), testing::HasSubstr("a directory")))
            << file;
    }
    EXPECT_EQ(load(folder_ / "ground.xyz", options()).state, CloudState::Ready);
}

TEST_F(LoaderTest, AFailureSaysWhyWithoutSayingWhere) {
    std::ofstream(folder_ / "broken.las") << "LASF and nothing more";
    const auto entry = load(folder_ / "broken.las", options());
    EXPECT_EQ(entry.state, CloudState::Failed);
    EXPECT_THAT(entry.error, testing::HasSubstr("broken.las"));
    EXPECT_THAT(entry.error, testing::Not(testing::HasSubstr(folder_.path().string())));
}

/// With importers that do as a script of ours says; `started` counts those that have begun.
class LoaderOfImporters : public LoaderTest {
  protected:
    void SetUp() override {
        LoaderTest::SetUp();
        fs::create_directories(folder_ / "importers");
        // They hang without taking time. What they tell us of their start is a file, which the sandbox would not let them write.
        const fs::path program = folder_ / "importers" / "scancast-import-pcl";
        std::ofstream(program) << "#!/bin/sh\n: > \"$0.$$\"\nkill -STOP $$\n";
        fs::permissions(program, fs::perms::owner_all);
        for (const char* name : {"a", "b", "c"})
            std::ofstream(folder_ / (std::string(name) + ".pcd")) << "# .PCD v0.7\nVERSION 0.7\n";
    }
    LoaderOptions hanging(int silence) {
        LoaderOptions options = LoaderTest::options();
        options.import.importerDirectory = folder_ / "importers";
        options.import.importerSilenceSeconds = silence;
        options.import.importerSandbox = ImporterSandbox::Off;
        return options;
    }
    std::size_t started() const {
        return std::size_t(std::ranges::count_if(
            fs::directory_iterator(folder_ / "importers"),
            [](const auto& file) { return file.path().filename() != "scancast-import-pcl"; }));
    }
    template <class Condition>
    static bool comesTrue(const Condition& condition) {
        const auto end = std::chrono::steady_clock::now() + 60s;
        while (!condition() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(1ms);
        return condition();
    }
    CloudState state(std::string_view id) const { return catalog_.find(id)->state; }
};

TEST_F(LoaderOfImporters, NothingElseWaitsForOnesThatHangAndSomeRunAtOnce) {
    Loader loader({folder_ / "a.pcd", folder_ / "b.pcd", folder_ / "c.pcd", folder_ / "ground.xyz"}, catalog_,
                  hanging(600));
    EXPECT_TRUE(comesTrue([&] { return state("ground") == CloudState::Ready; }));
    EXPECT_TRUE(comesTrue([&] { return started() == 2; })) << "as many as there may be at once";
    for (const char* id : {"a", "b", "c"}) EXPECT_EQ(state(id), CloudState::Loading) << id;
    EXPECT_FALSE(loader.finished());
    // What comes later does not wait, either.
    ASSERT_TRUE(catalog_.addAs("later", "later"));
    ASSERT_TRUE(loader.load(*ScanInput::open(folder_ / "ground.xyz"), "later"));
    EXPECT_TRUE(comesTrue([&] { return state("later") == CloudState::Ready; }));
    EXPECT_EQ(started(), 2u);
    // And its end is not held up: those that hang are given up.
    loader.requestStop();
    EXPECT_TRUE(comesTrue([&] { return loader.finished(); }));
}

TEST_F(LoaderOfImporters, OnesThatHangAreStoppedAndTheNextOnesTurnComes) {
    std::mutex mutex;
    std::vector<std::string> failures;
    LoaderOptions options = hanging(1);
    options.importers = 1;
    options.onFailed = [&](const Error& error) {
        const std::lock_guard lock(mutex);
        failures.push_back(error.message);
    };
    Loader loader({folder_ / "a.pcd", folder_ / "b.pcd"}, catalog_, std::move(options));
    awaitEnd(loader);
    // Whose turn is first is whose file was looked at first: several threads look.
    const auto hangs = [](const char* file) {
        return testing::AllOf(
            testing::HasSubstr("scancast-import-pcl failed while reading"),
            testing::HasSubstr(std::string(file) + ": it hangs: it sent nothing for 1 seconds"));
    };
    EXPECT_THAT(failures, testing::UnorderedElementsAre(hangs("a.pcd"), hangs("b.pcd")));
    for (const char* id : {"a", "b"}) EXPECT_EQ(state(id), CloudState::Failed) << id;
}

}  // namespace
}  // namespace scancast
