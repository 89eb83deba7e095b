// The cache with its threads, on files that are slow, stuck or damaged.
#include "renderer/residency/block_cache.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <mutex>

#include "renderer/cloud/curvature.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "renderer/residency/provide.hpp"
#include "tests/support/clouds/fake_cloud_file.hpp"
#include "tests/support/failing_allocation.hpp"

namespace scancast {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t samples = 1000;
constexpr std::uint64_t blockBytes = samples * sizeof(Sample) + 128;

std::shared_ptr<test::FakeCloudFile> file(int levels = 5) {
    return std::make_shared<test::FakeCloudFile>(11, levels, samples);
}

BlockCacheOptions roomFor(std::uint64_t blocks, const CloudFile& of, int threads = 2) {
    BlockCacheOptions options;
    const std::uint64_t tables = of.nodes().size() * 1024;  // more than the nodes' tables take
    options.memoryLimit = blocks * blockBytes + tables;
    options.threads = threads;
    options.grace = 0ms;
    return options;
}

Cut cutOf(const Octree& octree, std::uint32_t first, std::uint32_t count) {
    Cut cut;
    for (std::uint32_t node = first; node < first + count; ++node) {
        CutRun run;
        run.node = &octree.node(node);
        run.nodeIndex = node;
        run.projected = 1;
        cut.runs.push_back(run);
    }
    number(cut);
    return cut;
}

/// Waits for something that other threads do; a hang fails, not blocks.
template <class Condition>
bool soon(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + 20s;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(1ms);
    }
    return true;
}

TEST(BlockCache, LoadsWhatIsRequestedInTheBackground) {
    const auto scan = file();
    const auto cache = BlockCache::create(roomFor(1000, *scan));
    const auto store = cache->add(scan);
    const auto last = std::uint32_t(scan->nodes().size() - 1);
    store->request(1, {{last, 1}, {last - 1, 2}});
    EXPECT_TRUE(soon([&] { return store->find(last) && store->find(last - 1); }));
    EXPECT_EQ(store->find(last)->samples[5].x, std::uint16_t(last));
    EXPECT_EQ(store->find(last)->samples.size(), samples);
    EXPECT_GE(cache->stats().blocksLoaded, 2u);
}

TEST(BlockCache, TheRootComesByItselfAndStays) {
    const auto scan = file();
    const auto cache = BlockCache::create(roomFor(12, *scan));
    const auto store = cache->add(scan);
    EXPECT_TRUE(soon([&] { return store->find(0).has_value(); }));
    for (std::uint32_t node = 1; node < 100; ++node) {
        ASSERT_TRUE(store->load(node));
        ASSERT_TRUE(store->find(0));
        ASSERT_LE(cache->stats().bytes, cache->stats().limit);
    }
    EXPECT_GT(cache->stats().blocksEvicted, 50u);
}

TEST(BlockCache, WaitingLoadsSeveralBlocksAtATime) {
    const auto scan = file();
    scan->setDelay(2ms);
    const auto cache = BlockCache::create(roomFor(1000, *scan, 3));
    const auto store = cache->add(scan);
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t node = 10; node < 90; ++node) nodes.push_back(node);
    const auto runs = store->loadAll(nodes);
    ASSERT_EQ(runs.size(), nodes.size());
    for (std::size_t i = 0; i < runs.size(); ++i) {
        ASSERT_TRUE(runs[i]);
        EXPECT_EQ(runs[i]->samples[0].x, nodes[i]);
    }
    EXPECT_GE(scan->mostReaders(), 3);
}

TEST(BlockCache, NobodyReadsABlockTwice) {
    const auto scan = file();
    scan->setDelay(200us);
    const auto cache = BlockCache::create(roomFor(1000, *scan));
    const auto store = cache->add(scan);
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t node = 0; node < 60; ++node) nodes.push_back(node);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&] {
            for (const auto& run : store->loadAll(nodes)) EXPECT_TRUE(run);
        });
    for (std::thread& thread : threads) thread.join();
    auto reads = scan->reads();
    std::sort(reads.begin(), reads.end());
    EXPECT_EQ(std::adjacent_find(reads.begin(), reads.end()), reads.end());
}

TEST(BlockCache, WhoWaitsIsNotHeldUpByRequests) {
    const auto scan = file(6);
    scan->setDelay(1ms);
    const auto cache = BlockCache::create(roomFor(5000, *scan, 1));
    const auto store = cache->add(scan);
    std::vector<BlockRequest> requests;
    for (std::uint32_t node = 100; node < 1100; ++node) requests.push_back({node, 1e6});
    store->request(1, requests);
    ASSERT_TRUE(store->load(50));
    EXPECT_LT(scan->reads().size(), 500u);
}

TEST(BlockCache, RequestsOfOneSessionDoNotStarveAnothers) {
    const auto scan = file(6);
    scan->setOpen(false);
    const auto cache = BlockCache::create(roomFor(5000, *scan, 1));
    const auto store = cache->add(scan);
    ASSERT_TRUE(scan->waitReads(1, true));  // the only loader thread is stuck with the root
    std::vector<BlockRequest> many;
    for (std::uint32_t node = 500; node < 900; ++node) many.push_back({node, 1e6});
    store->request(1, many);
    store->request(2, {{400, 1}, {401, 0.5}});
    scan->setOpen(true);
    ASSERT_TRUE(soon([&] { return store->find(401).has_value(); }));
    const auto reads = scan->reads();
    const auto position = std::find(reads.begin(), reads.end(), 401u) - reads.begin();
    EXPECT_LT(position, 30) << "behind a few turns, not behind 400 requests";
}

TEST(BlockCache, SupersededRequestsAreNotLoaded) {
    const auto scan = file(6);
    scan->setOpen(false);
    const auto cache = BlockCache::create(roomFor(5000, *scan, 1));
    const auto store = cache->add(scan);
    ASSERT_TRUE(scan->waitReads(1, true));
    store->request(1, {{500, 1}, {501, 1}, {502, 1}});
    store->request(1, {{600, 1}});
    scan->setOpen(true);
    ASSERT_TRUE(soon([&] { return store->find(600).has_value() && cache->stats().requests == 0; }));
    EXPECT_FALSE(store->find(500));
    EXPECT_FALSE(store->find(502));
}

TEST(BlockCache, ADamagedBlockIsToldOnceAndTheRestIsThere) {
    const auto scan = file();
    scan->damage(7);
    std::mutex mutex;
    std::vector<std::string> told;
    BlockCacheOptions options = roomFor(1000, *scan);
    options.onDamaged = [&](const std::shared_ptr<const CloudFile>& from, const Error& error) {
        const std::lock_guard lock(mutex);
        told.push_back(from->path().string() + ": " + error.message);
    };
    const auto cache = BlockCache::create(options);
    const auto store = cache->add(scan);
    for (int i = 0; i < 3; ++i) {
        const auto run = store->load(7);
        ASSERT_FALSE(run);
        EXPECT_EQ(run.error().code, ErrorCode::Malformed);
        EXPECT_THAT(run.error().message, testing::HasSubstr("4711"));
    }
    EXPECT_TRUE(store->damaged(7));
    EXPECT_FALSE(store->damaged(8));
    EXPECT_TRUE(store->load(8));
    const Octree octree = test::octreeOf(*scan, store);
    const auto cut = provide(octree, cutOf(octree, 5, 10));
    ASSERT_TRUE(cut);
    EXPECT_EQ(cut->damaged.size(), 1u);
    EXPECT_EQ(cache->stats().blocksDamaged, 1u);
    const std::lock_guard lock(mutex);
    ASSERT_EQ(told.size(), 1u);
    EXPECT_THAT(told[0], testing::HasSubstr("fake.scan: node 7 at byte 4711"));
}

TEST(BlockCache, CurvaturesComeWithTheirSamplesOrNeitherDoes) {
    const auto scan = file(3);
    scan->addCurvatures();
    scan->damageCurvatures(4);
    const auto cache = BlockCache::create(roomFor(1000, *scan));
    const auto store = cache->add(scan);
    for (const std::uint32_t node : {0u, 1u, 2u, 3u}) {
        const auto run = store->load(node);
        ASSERT_TRUE(run) << run.error().message;
        ASSERT_EQ(run->beside.size(), run->samples.size());
        const CurvatureCode code = node % 3 == 2 ? 0 : node + 1;
        EXPECT_TRUE(std::ranges::all_of(run->beside, [&](CurvatureCode c) { return c == code; }))
            << "node " << node << (code ? "" : ", which has none, is flat");
    }
    const auto damaged = store->load(4);
    ASSERT_FALSE(damaged);
    EXPECT_THAT(damaged.error().message, testing::HasSubstr("4712"));
    EXPECT_TRUE(store->damaged(4));
}

/// Each in its bytes of one word, in whatever order the planes are, and one without the other.
TEST(BlockCache, NearInfraredStandsAboveCurvatures) {
    const auto both = file(3), alone = file(3);
    both->addNearInfrared();
    both->addCurvatures();
    alone->addNearInfrared();
    const auto cache = BlockCache::create(roomFor(1000, *both));
    const auto first = cache->add(both), second = cache->add(alone);
    for (const std::uint32_t node : {0u, 1u, 2u, 3u}) {
        const BesideWord infrared =
            node % 3 == 2 ? 0 : BesideWord(test::FakeCloudFile::infraredOf(node)) << 24;
        const BesideWord bent = node % 3 == 2 ? 0 : node + 1;
        for (const auto& [store, word] : {std::pair(first, infrared | bent), std::pair(second, infrared)}) {
            const auto run = store->load(node);
            ASSERT_TRUE(run) << run.error().message;
            ASSERT_EQ(run->beside.size(), run->samples.size());
            EXPECT_TRUE(std::ranges::all_of(run->beside, [&](BesideWord w) { return w == word; })) << node;
        }
    }
}

// Right because a sample then takes a quarter more.
TEST(BlockCache, CurvaturesCount) {
    const auto with = file(3), without = file(3);
    with->addCurvatures();
    const auto first = BlockCache::create(roomFor(1000, *with)),
               second = BlockCache::create(roomFor(1000, *with));
    const auto bent = first->add(with), flat = second->add(without);
    // All of them, since the upper levels come by themselves, sooner or later.
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t node = 0; node < with->nodes().size(); ++node) nodes.push_back(node);
    for (const auto& store : {bent, flat})
        for (const auto& run : store->loadAll(nodes)) ASSERT_TRUE(run);
    EXPECT_EQ(bent->bytesResident() - flat->bytesResident(), nodes.size() * samples * sizeof(CurvatureCode));
    EXPECT_LT(bent->capacity(), flat->capacity());
}

TEST(BlockCache, AWaitCanBeAbandoned) {
    const auto scan = file();
    const auto cache = BlockCache::create(roomFor(1000, *scan, 1));
    const auto store = cache->add(scan);
    ASSERT_TRUE(store->load(0));
    scan->setDelay(1ms);
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t node = 1; node < 200; ++node) nodes.push_back(node);
    std::stop_source stop;
    std::thread stopper([&] {
        scan->waitReads(10);
        stop.request_stop();
    });
    const auto runs = store->loadAll(nodes, stop.get_token());
    stopper.join();
    EXPECT_TRUE(std::any_of(runs.begin(), runs.end(), [](const auto& run) {
        return !run && run.error().code == ErrorCode::Cancelled;
    }));
    scan->setDelay(0us);
    for (const auto& run : store->loadAll(nodes)) EXPECT_TRUE(run) << "nothing is left half-loaded";
}

TEST(BlockCache, AStuckReadEndsWithTheWaitOfWhoDidNotStartIt) {
    const auto scan = file();
    const auto cache = BlockCache::create(roomFor(1000, *scan, 1));
    const auto store = cache->add(scan);
    ASSERT_TRUE(soon([&] { return store->find(0) && cache->stats().requests == 0; }));
    // The last of the upper levels may still be read, although it waits no more; once what was asked for after it is
    // there, the only thread has nothing to do.
    const auto node = std::uint32_t(scan->nodes().size() - 1);
    store->request(1, {{node - 1, 1}});
    ASSERT_TRUE(soon([&] { return store->find(node - 1).has_value(); }));
    const std::shared_ptr<void> opened(nullptr, [&](const void*) { scan->setOpen(true); });  // whatever fails
    scan->setOpen(false);
    store->request(1, {{node, 1}});
    ASSERT_TRUE(soon([&] { return cache->stats().requests == 0; }));
    std::stop_source stop;
    std::thread stopper([&] {
        std::this_thread::sleep_for(20ms);
        stop.request_stop();
    });
    const auto run = store->load(node, stop.get_token());
    stopper.join();
    ASSERT_FALSE(run);
    EXPECT_EQ(run.error().code, ErrorCode::Cancelled);
    scan->setOpen(true);
    EXPECT_TRUE(store->load(node));
}

// So final pictures of other clouds need not wait for it (server/scheduler/turns.hpp).
TEST(BlockCache, AWaitForAServerThatHangsCanBeCalledOffAndHoldsNobodyElse) {
    const auto far = file(), near = file();
    far->beRemote();
    const auto cache = BlockCache::create(roomFor(1000, *far, 1));
    const auto remote = cache->add(far), local = cache->add(near);
    ASSERT_TRUE(soon([&] { return remote->find(0) && cache->stats().requests == 0; }));
    const std::shared_ptr<void> opened(nullptr, [&](const void*) { far->setOpen(true); });  // whatever fails
    far->setOpen(false);
    const auto node = std::uint32_t(far->nodes().size() - 1);
    const std::size_t before = far->reads().size();
    std::stop_source stop;
    std::thread stopper([&] {
        far->waitReads(before + 1, true);
        EXPECT_TRUE(local->load(node)) << "another's are read meanwhile";
        stop.request_stop();
    });
    const auto run = remote->load(node, stop.get_token());  // by a thread of the cache's, not by this one
    stopper.join();
    ASSERT_FALSE(run);
    EXPECT_EQ(run.error().code, ErrorCode::Cancelled);
    EXPECT_FALSE(remote->isAway());
    far->setAway(true);
    EXPECT_TRUE(remote->isAway() && !local->isAway());
    far->setOpen(true);
    EXPECT_TRUE(remote->load(node));
}

TEST(BlockCache, ShuttingDownWhileLoadingEndsEveryWait) {
    const auto scan = file(6);
    scan->setDelay(1ms);
    auto cache = BlockCache::create(roomFor(5000, *scan));
    auto store = cache->add(scan);
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t node = 1; node < 1000; ++node) nodes.push_back(node);
    std::thread waiter([&] {
        const auto runs = store->loadAll(nodes);
        EXPECT_FALSE(runs.back());
    });
    store->request(1, {{1500, 1}, {1501, 1}});
    ASSERT_TRUE(scan->waitReads(20));
    cache->stop();
    waiter.join();
    store.reset();
    cache.reset();
}

TEST(BlockCache, ARunOutlivesStoreAndCache) {
    const auto scan = file();
    auto cache = BlockCache::create(roomFor(100, *scan));
    auto store = cache->add(scan);
    auto run = store->load(3);
    ASSERT_TRUE(run);
    store.reset();
    cache.reset();
    EXPECT_EQ(run->samples[999].x, 3);
}

// A cloud ten times the limit, looked at by two sessions that move and one that waits for complete pictures.
// Memory is looked at after every step: beyond the limit is only what pictures hold.
TEST(BlockCache, ACloudTenTimesTheLimitStaysWithinIt) {
    const auto scan = file(6);
    const std::uint64_t blocks = scan->nodes().size();
    ASSERT_GT(blocks, 400u);
    BlockCacheOptions options = roomFor(blocks / 10, *scan);
    const auto cache = BlockCache::create(options);
    const Octree octree = test::octreeOf(*scan, cache->add(scan));
    const auto visible = std::uint32_t(blocks / 20);
    std::atomic<bool> failed{false};
    std::atomic<std::uint64_t> held{0};
    const auto orbit = [&](std::uint64_t who, bool wait) {
        for (std::uint32_t step = 0; step < 150 && !failed; ++step) {
            const auto first = std::uint32_t((step * 3 + who * blocks / 3) % (blocks - visible));
            held += visible * blockBytes;
            {
                const auto cut =
                    provide(octree, cutOf(octree, first, visible), {.wait = wait, .requester = who});
                if (!cut || (wait && cut->nodesMissing > 0)) failed = true;
                if (cut && cut->runs.empty()) failed = true;
                for (const CutRun& run : cut->runs)
                    if (run.samples[0].x != std::uint16_t(run.nodeIndex)) failed = true;
                const BlockCacheStats stats = cache->stats();
                if (stats.bytes > stats.limit + held + 3 * blockBytes) failed = true;
            }
            held -= visible * blockBytes;
        }
    };
    ASSERT_TRUE(octree.store().load(0));
    std::thread a([&] { orbit(1, false); }), b([&] { orbit(2, false); }), c([&] { orbit(3, true); });
    a.join(), b.join(), c.join();
    EXPECT_FALSE(failed);
    EXPECT_GT(cache->stats().blocksEvicted, blocks / 10);
    ASSERT_TRUE(octree.run(1));  // with nothing held, one more load brings it back
    EXPECT_LE(cache->stats().bytes, cache->stats().limit);
}

TEST(BlockCache, CapacityDependsOnLimitAndCloudAlone) {
    const auto scan = file();
    const auto options = roomFor(200, *scan);
    const auto cache = BlockCache::create(options);
    const auto store = cache->add(scan);
    const std::uint64_t before = store->capacity();
    EXPECT_GT(before, 0u);
    EXPECT_LE(before * sizeof(Sample), options.memoryLimit * 3 / 4);
    const auto more = cache->reserve(1000000);
    EXPECT_EQ(store->capacity(), before);
    EXPECT_GE(cache->stats().bytes, 1000000u);
}

// Whatever the one loader thread is doing - nothing, or reading a request of somebody's - when two ask for
// something: a request, a block of their own, or the very block that is being read. Everybody gets it.
TEST(BlockCache, EveryPairIsServedWhateverTheLoaderIsDoing) {
    const auto last = std::uint32_t(file()->nodes().size() - 1);  // far from those that stay in memory
    const std::uint32_t read = last, own = last - 10;
    const auto ask = [&](SampleStore& store, int kind, std::uint32_t who) {
        if (kind == 0) {
            store.request(who, {{own + who, 1}});
            return soon([&] { return store.find(own + who).has_value(); });
        }
        return store.load(kind == 1 ? own + who : read).has_value();
    };
    for (const bool reading : {false, true}) {
        for (int pair = 0; pair < 9; ++pair) {
            const auto scan = file();
            const auto cache = BlockCache::create(roomFor(1000, *scan, 1));
            const auto store = cache->add(scan);
            ASSERT_TRUE(soon([&] { return cache->stats().requests == 0 && store->find(0); }));
            if (reading) {
                scan->setOpen(false);
                const auto before = scan->reads().size();
                store->request(7, {{read, 1}});
                ASSERT_TRUE(scan->waitReads(before + 1, true));
            }
            std::atomic<bool> a{false}, b{false};
            std::thread first([&] { a = ask(*store, pair / 3, 1); });
            std::thread second([&] { b = ask(*store, pair % 3, 2); });
            scan->setOpen(true);
            first.join();
            second.join();
            EXPECT_TRUE(a && b) << "pair " << pair << (reading ? " while it reads" : "");
        }
    }
}

// Of all the allocations that loading causes, each in turn fails: whoever waits gets an answer, and the cache
// goes on.
TEST(BlockCache, EveryAllocationMayFail) {
    const auto scan = file();
    const auto last = std::uint32_t(scan->nodes().size() - 1);  // far from those that stay in memory
    const std::vector<std::uint32_t> nodes{last - 1, last - 2, last - 3};
    bool happened = true;
    std::uint64_t nth = 0;
    while (happened) {
        BlockCacheOptions options = roomFor(1000, *scan, 1);
        options.onDamaged = [](const std::shared_ptr<const CloudFile>&, const Error& error) {
            throw std::runtime_error("who would listen to this: " + error.message);
        };
        const auto cache = BlockCache::create(options);
        const auto store = cache->add(scan);
        {
            const test::FailingAllocation fails(++nth);
            store->request(1, {{last - 4, 1}, {last - 5, 2}});
            for (const auto& run : store->loadAll(nodes))
                EXPECT_TRUE(run || run.error().code == ErrorCode::ResourceLimit) << nth;
            ASSERT_TRUE(soon([&] { return cache->stats().requests == 0; })) << nth;
            happened = fails.happened();
        }
        ASSERT_TRUE(store->load(last)) << nth;
    }
    EXPECT_GT(nth, 5U);
}

TEST(OpenCloud, RefusesABlockThatIsLargerThanMemoryWithItsSize) {
    // Constant planes pack well: a file of some hundred kilobytes may say this.
    const auto file = std::make_shared<test::FakeCloudFile>(1, 1, 140'000'000);
    const auto refused =
        openCloud(file, BlockCache::create({.memoryLimit = 512 << 20, .threads = 1, .onDamaged = {}}));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::ResourceLimit);
    for (const char* said : {"140000000 samples", "2800 MB", "402 MB", "--memory-limit"})
        EXPECT_NE(refused.error().message.find(said), std::string::npos) << refused.error().message;
}

}  // namespace
}  // namespace scancast
