// Octrees made for views: shared by who asks the same, forgotten in turn, within the one memory limit, and no longer there than the
// cloud is.
#include <gtest/gtest.h>

#include "protocol/view/view_words.hpp"
#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/build/ingest.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "renderer/residency/pictured_octree.hpp"
#include "tests/support/clouds/column_source.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

Style styleOf(const std::string& filter, const std::string& color = "rgb") {
    View view;
    EXPECT_TRUE(applyWord(view, "filter", filter));
    EXPECT_TRUE(applyWord(view, "color", color));
    return view.style;
}

class PicturedOctrees : public ::testing::Test {
  protected:
    void SetUp() override {
        IngestOptions options;
        options.shape.leafPoints = 500;
        options.shape.surfels = false;
        options.output = folder_ / "a.scan";
        std::vector<std::unique_ptr<PointSource>> sources;
        sources.push_back(std::make_unique<ColumnSource>(15'000, ground));
        ASSERT_TRUE(ingest(std::move(sources), options, {}, {}));
        BlockCacheOptions room;
        room.memoryLimit = 8 << 20;
        cache_ = BlockCache::create(room);
        cloud_ = openCloud(folder_ / "a.scan", cache_).value();
    }
    static std::uint64_t samplesIn(const Octree& octree) {
        std::uint64_t samples = 0;
        for (std::uint32_t i = 0; i < octree.nodes().size(); ++i)
            if (octree.node(i).isLeaf()) samples += octree.run(i).value().samples.size();
        return samples;
    }

    TemporaryFolder folder_;
    std::shared_ptr<BlockCache> cache_;
    std::shared_ptr<const Cloud> cloud_;
};

TEST_F(PicturedOctrees, AreNoneWhereNothingIsAsked) {
    EXPECT_EQ(picturedOctree(*cloud_, Style()).value(), nullptr);
    EXPECT_EQ(filteredCloud(cloud_, Style()).value(), cloud_);
}

TEST_F(PicturedOctrees, HaveWhatPasses) {
    std::uint64_t expected = 0;
    for (std::uint64_t i = 0; i < 15'000; ++i) expected += returnsOf(i) <= 2 && amountOf(i) >= 50;
    const auto octree = picturedOctree(*cloud_, styleOf("returns:..2;amount:50..")).value();
    ASSERT_TRUE(octree);
    EXPECT_EQ(samplesIn(*octree), expected);
    EXPECT_NE(octree->source(), cloud_->octree.source());
}

TEST_F(PicturedOctrees, AreSharedByTheSameWordsAndForgottenInTurn) {
    const auto first = picturedOctree(*cloud_, styleOf("amount:0..")).value();
    EXPECT_EQ(picturedOctree(*cloud_, styleOf("amount:0..")).value(), first);
    EXPECT_NE(picturedOctree(*cloud_, styleOf("amount:0..", "column:amount")).value(), first);
    const std::weak_ptr<const Octree> unused = picturedOctree(*cloud_, styleOf("amount:1..")).value();
    EXPECT_FALSE(unused.expired());
    for (int step = 0; step < int(DerivedOctrees::mostKept); ++step)
        (void)picturedOctree(*cloud_, styleOf("amount:" + std::to_string(2 + step) + "..")).value();
    EXPECT_TRUE(unused.expired());
    EXPECT_GT(samplesIn(*first), 0u) << "whoever draws it has it";
}

TEST_F(PicturedOctrees, StayWithinTheLimit) {
    std::vector<std::shared_ptr<const Octree>> held;
    for (int step = 0; step < 20; ++step) {
        const auto octree = picturedOctree(*cloud_, styleOf("amount:" + std::to_string(step) + "..")).value();
        samplesIn(*octree);
        if (step % 4 == 0) held.push_back(octree);
        EXPECT_LE(cache_->stats().bytes, cache_->stats().limit);
    }
}

TEST_F(PicturedOctrees, GoWithTheCloud) {
    const auto octree = picturedOctree(*cloud_, styleOf("amount:0..")).value();
    auto kept = filteredCloud(cloud_, styleOf("amount:0..")).value();
    const std::weak_ptr<const Octree> other = picturedOctree(*cloud_, styleOf("amount:7..")).value();
    cloud_.reset();
    EXPECT_FALSE(other.expired()) << "its filtered self holds it";
    EXPECT_GT(samplesIn(kept->octree), 0u);
    kept.reset();
    EXPECT_TRUE(other.expired());
    (void)samplesIn(*octree);  // of the file; nothing is at hand any more
}

TEST_F(PicturedOctrees, OfCloudsInMemoryAreCopiesThatDoNotKeepThem) {
    ColumnSource source(15'000, ground);
    BuildOptions building;
    building.shape.leafPoints = 500;
    building.shape.surfels = false;
    std::shared_ptr<const Cloud> cloud = buildCloud(source, building, {}).value();
    std::uint64_t expected = 0;
    for (std::uint64_t i = 0; i < 15'000; ++i) expected += intensityOf(i) >= 1000 && classOf(i) == 3;
    const auto octree = picturedOctree(*cloud, styleOf("intensity:1000..;classification:3..3")).value();
    EXPECT_EQ(samplesIn(*octree), expected);
    const auto refused = picturedOctree(*cloud, styleOf("amount:0.."));
    ASSERT_FALSE(refused) << "columns are a file's";
    EXPECT_EQ(refused.error().code, ErrorCode::Unsupported);
    const std::weak_ptr<const Cloud> gone = cloud;
    cloud.reset();
    EXPECT_TRUE(gone.expired());
}

}  // namespace
}  // namespace scancast::test
