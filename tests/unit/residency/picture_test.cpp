// Pictures of a cloud file under a memory limit against pictures of the same cloud in memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <glm/gtc/matrix_transform.hpp>

#include "renderer/image/encode.hpp"
#include "renderer/render.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/clouds/write_cloud.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

class CloudFilePictures : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        test::SyntheticSource source(200'000, test::ground, {.color = true});
        cloud_ = test::build(source, 512);
        ASSERT_TRUE(cloud_);
        path_ = fs::temp_directory_path() / ("scancast_pictures_" + std::to_string(::getpid()) + ".scan");
        test::writeCloud(*cloud_, path_);
    }
    static void TearDownTestSuite() {
        cloud_.reset();
        fs::remove(path_);
    }
    void SetUp() override {
        device_ = std::move(*createDevice({.backend = "cpu", .threads = 2, .eglDevice = -1}));
    }

    std::shared_ptr<const Cloud> open(std::uint64_t memoryLimit) {
        BlockCacheOptions options;
        options.memoryLimit = memoryLimit;
        options.grace = std::chrono::milliseconds(0);
        options.onDamaged = [this](const std::shared_ptr<const CloudFile>&, const Error& error) {
            const std::lock_guard lock(mutex_);
            damage_.push_back(error.message);
        };
        cache_ = BlockCache::create(options);
        auto opened = openCloud(path_, cache_);
        EXPECT_TRUE(opened) << opened.error().message;
        return opened ? *opened : nullptr;
    }
    static View view(double degrees, double nearer = 0.5) {
        View view = defaultView(*cloud_, 400, 300);
        view.quality.samples = 1;
        view.camera.target = (cloud_->bounds[0] + cloud_->bounds[1]) * 0.5;
        const glm::dmat4 turn = glm::rotate(glm::dmat4(1), glm::radians(degrees), view.camera.up);
        view.camera.eye = view.camera.target + nearer * glm::dvec3(turn * glm::dvec4(150, -150, 100, 0));
        return view;
    }
    Bytes png(const Cloud& cloud, const View& view) {
        const auto frame = render(*device_, cloud, view);
        EXPECT_TRUE(frame) << frame.error().message;
        if (!frame) return {};
        EXPECT_EQ(frame->stats.samplesMissing, 0u);
        return *encodePng(*frame, false);
    }

    static inline std::shared_ptr<const Cloud> cloud_;
    static inline fs::path path_;
    std::unique_ptr<Device> device_;
    std::shared_ptr<BlockCache> cache_;
    std::mutex mutex_;
    std::vector<std::string> damage_;
};

// Right because the other picture is made of the octree that the file was written from, without any store.
TEST_F(CloudFilePictures, WithWaitAreThoseOfTheCloudInMemory) {
    for (const std::uint64_t limit : {std::uint64_t(100) << 20, std::uint64_t(3) << 20}) {
        const auto opened = open(limit);
        ASSERT_TRUE(opened);
        for (int step = 0; step < 6; ++step) {
            View v = view(step * 50.0, step % 2 ? 0.5 : 0.1);
            v.quality.detail = 1;
            View bound = v;
            bound.quality.budget = opened->octree.store().capacity();
            EXPECT_EQ(png(*opened, v), png(*cloud_, bound)) << "limit " << limit << ", step " << step;
        }
        EXPECT_EQ(cache_->stats().blocksDamaged, 0u);
    }
    EXPECT_GT(cache_->stats().blocksEvicted, 0u);
}

// The cloud takes ten times the limit; memory is looked at after every frame, when nothing is held.
TEST_F(CloudFilePictures, AnOrbitStaysWithinTheLimit) {
    const std::uint64_t tables = cloud_->octree.nodes().size() * 700;
    const auto opened = open(tables + cloud_->octree.sampleCount() * sizeof(Sample) / 10);
    ASSERT_TRUE(opened);
    for (int frame = 0; frame < 120; ++frame) {
        View v = view(frame * 3.0, 0.3);
        v.quality.detail = 2;
        const auto drawn = render(*device_, *opened, v,
                                  {.wait = false, .requester = 1, .ahead = view(frame * 3.0 + 9).camera});
        ASSERT_TRUE(drawn) << drawn.error().message;
        EXPECT_GT(drawn->stats.samplesDrawn, 0u) << "frame " << frame;
        const BlockCacheStats stats = cache_->stats();
        ASSERT_LE(stats.bytes, stats.limit);
    }
    EXPECT_TRUE(damage_.empty());
}

TEST_F(CloudFilePictures, WithoutWaitingEndWhereWaitingDoes) {
    const auto opened = open(std::uint64_t(100) << 20);
    ASSERT_TRUE(opened);
    const View v = view(20);
    std::uint64_t missing = 1;
    for (int tries = 0; missing > 0 && tries < 2000; ++tries) {
        const auto drawn = render(*device_, *opened, v, {.wait = false, .requester = 7});
        ASSERT_TRUE(drawn);
        missing = drawn->stats.samplesMissing;
        if (missing == 0) {
            EXPECT_EQ(*encodePng(*drawn, false), png(*cloud_, v));
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    EXPECT_EQ(missing, 0u);
}

TEST_F(CloudFilePictures, ADamagedBlockHidesNothingElse) {
    const fs::path broken = path_.string() + ".broken";
    fs::copy_file(path_, broken, fs::copy_options::overwrite_existing);
    std::uint64_t at = 0;
    {
        const auto file = CloudFile::open(broken);
        ASSERT_TRUE(file);
        std::uint32_t leaf = 0;
        while (!(*file)->nodes()[leaf].node.isLeaf()) ++leaf;
        at = (*file)->nodes()[leaf].samples.offset + (*file)->nodes()[leaf].samples.bytes / 2;
    }
    {
        std::fstream bytes(broken, std::ios::binary | std::ios::in | std::ios::out);
        bytes.seekg(std::streamoff(at));
        const char turned = char(~bytes.get());
        bytes.seekp(std::streamoff(at));
        bytes.put(turned);
    }
    const fs::path sound = std::exchange(path_, broken);
    const auto opened = open(std::uint64_t(100) << 20);
    path_ = sound;
    ASSERT_TRUE(opened);
    View v = view(0, 1);
    v.quality.detail = 0;
    for (int i = 0; i < 3; ++i) {
        const auto drawn = render(*device_, *opened, v);
        ASSERT_TRUE(drawn) << drawn.error().message;
        EXPECT_EQ(drawn->stats.nodesDamaged, 1u);
        EXPECT_GT(drawn->stats.samplesDrawn, cloud_->points * 9 / 10);
    }
    v.style.light.sun = {30, 40};
    v.style.light.shadow = 0.5;
    const auto shaded = render(*device_, *opened, v);
    ASSERT_TRUE(shaded) << shaded.error().message;
    EXPECT_EQ(shaded->stats.nodesDamaged, 1u) << "the viewer and the sun lack the same block";
    const std::lock_guard lock(mutex_);
    ASSERT_EQ(damage_.size(), 1u) << "told once";
    EXPECT_THAT(damage_[0], testing::HasSubstr("node"));
    fs::remove(broken);
}

TEST_F(CloudFilePictures, BruteForceBeyondTheLimitIsRefused) {
    const auto opened = open(std::uint64_t(2) << 20);
    ASSERT_TRUE(opened);
    const auto drawn = render(*device_, *opened, view(0), {.bruteForce = true});
    ASSERT_FALSE(drawn);
    EXPECT_EQ(drawn.error().code, ErrorCode::ResourceLimit);
}

TEST_F(CloudFilePictures, FilesAreKnownByTheirFirstBytes) {
    EXPECT_TRUE(isCloudFileAt(path_));
    EXPECT_FALSE(isCloudFileAt(path_.parent_path()));
    EXPECT_FALSE(isCloudFileAt("/nowhere/at/all.scan"));
}

}  // namespace
}  // namespace scancast
