// Cuts whose levels fade, against what a cut must be, over many views of several clouds.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "renderer/select/select.hpp"
#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/pictures/random_views.hpp"

namespace scancast {
namespace {

constexpr std::uint64_t fadingViews = 120;

class FadingCuts : public testing::TestWithParam<bool> {
  protected:
    void SetUp() override {
        test::SyntheticSource source(60'000, GetParam() ? test::ground : test::ball, {});
        cloud_ = test::build(source, 300);
        ASSERT_TRUE(cloud_);
    }
    std::shared_ptr<const Cloud> cloud_;
};

// Right because it walks up from every leaf: a hole is a leaf that no whole run covers, two whole runs a
// doubled surface.
TEST_P(FadingCuts, CoverEveryLeafByAWholeRun) {
    const Octree& o = cloud_->octree;
    std::uint64_t partial = 0;
    for (std::uint64_t v = 0; v < fadingViews; ++v) {
        const Viewpoint viewpoint = test::randomViewpoint(*cloud_, v);
        SelectOptions options;
        options.cull = false;
        options.detail = std::array{0.0, 0.5, 2.0, 10.0}[v % 4];
        options.fade = std::array{0.1, 0.5, 2.0}[v % 3];
        if (v % 5 == 0) options.budget = 1000 + v * 400;
        const Cut cut = select(o, viewpoint, options);
        std::vector<const CutRun*> drawn(o.nodes().size());
        for (const CutRun& run : cut.runs) {
            drawn[run.nodeIndex] = &run;
            partial += run.share < 1;
            ASSERT_GT(run.share, 0);
            ASSERT_LE(run.share, 1);
        }
        for (std::uint32_t leaf = 0; leaf < o.nodes().size(); ++leaf) {
            if (!o.node(leaf).isLeaf()) continue;
            int whole = 0;
            for (std::uint32_t up = leaf; up != noNode; up = o.node(up).parent) {
                if (!drawn[up]) continue;
                whole += drawn[up]->share == 1;
            }
            ASSERT_EQ(whole, 1) << "view " << v << ", leaf " << leaf;
        }
        EXPECT_EQ(cut.points, cloud_->points);
    }
    EXPECT_GT(partial, fadingViews);
}

// Right by definition: as the band closes, what is left of a cut that fades is the cut that switches.
TEST_P(FadingCuts, WithoutABandAreTheCutsThatSwitch) {
    for (std::uint64_t v = 0; v < fadingViews; ++v) {
        const Viewpoint viewpoint = test::randomViewpoint(*cloud_, v);
        SelectOptions options;
        options.detail = std::array{0.5, 2.0, 10.0}[v % 3];
        const Cut sharp = select(cloud_->octree, viewpoint, options);
        options.fade = 1e-13;
        const Cut faded = select(cloud_->octree, viewpoint, options);
        ASSERT_EQ(sharp.runs.size(), faded.runs.size());
        for (std::size_t i = 0; i < sharp.runs.size(); ++i) {
            ASSERT_EQ(sharp.runs[i].nodeIndex, faded.runs[i].nodeIndex);
            ASSERT_EQ(faded.runs[i].share, 1);
        }
    }
}

// Right because a cut that is not culled is known to cover everything: culling may only leave out runs, and
// must change nothing in those that stay.
TEST_P(FadingCuts, CullingOnlyLeavesRunsOut) {
    for (std::uint64_t v = 0; v < fadingViews; ++v) {
        const Viewpoint viewpoint = test::randomViewpoint(*cloud_, v);
        SelectOptions options;
        options.detail = 1 + double(v % 5);
        options.fade = 0.5;
        const Cut culled = select(cloud_->octree, viewpoint, options);
        options.cull = false;
        const Cut full = select(cloud_->octree, viewpoint, options);
        auto at = full.runs.begin();
        std::uint32_t ordinal = 0;
        for (const CutRun& run : culled.runs) {
            while (at != full.runs.end() && at->nodeIndex != run.nodeIndex) ++at;
            ASSERT_NE(at, full.runs.end()) << "view " << v;
            EXPECT_EQ(at->share, run.share);
            EXPECT_EQ(at->covered, run.covered);
            ASSERT_EQ(run.firstOrdinal, ordinal);
            ordinal += run.node->sampleCount;
        }
    }
}

// Right by counting: every sample of a run takes memory, whatever its share.
TEST_P(FadingCuts, KeepABudget) {
    const std::uint64_t root = cloud_->octree.node(0).sampleCount;
    std::uint64_t reached = 0, better = 0;
    for (std::uint64_t v = 0; v < fadingViews; ++v) {
        const Viewpoint viewpoint = test::randomViewpoint(*cloud_, v);
        SelectOptions options;
        options.detail = v % 2 ? 0.0 : 1.0;
        options.fade = 0.5;
        options.budget = 500 + v * 400;
        const Cut cut = select(cloud_->octree, viewpoint, options);
        std::uint64_t samples = 0;
        for (const CutRun& run : cut.runs) samples += run.node->sampleCount;
        EXPECT_EQ(samples, cut.samples);
        EXPECT_LE(samples, std::max(*options.budget, root));
        reached += cut.budgetReached;
        better += cut.budgetReached && samples > *options.budget / 2;
    }
    EXPECT_GT(reached, fadingViews / 4);
    EXPECT_GT(better, reached / 2) << "budgets are to be used";
}

// Right by definition: full detail is all leaves, whatever the band.
TEST_P(FadingCuts, FullDetailIsEveryLeafWhole) {
    SelectOptions options;
    options.detail = 0;
    options.fade = 0.5;
    options.cull = false;
    const Cut cut = select(cloud_->octree, test::randomViewpoint(*cloud_, 1), options);
    EXPECT_EQ(cut.samples, cloud_->points);
    for (const CutRun& run : cut.runs) {
        EXPECT_TRUE(run.node->isLeaf());
        EXPECT_EQ(run.share, 1);
        EXPECT_FALSE(run.covered);
    }
}

INSTANTIATE_TEST_SUITE_P(Clouds, FadingCuts, testing::Bool(),
                         [](const auto& p) { return std::string(p.param ? "ground" : "ball"); });

}  // namespace
}  // namespace scancast
