#include "renderer/select/select.hpp"

#include <gtest/gtest.h>

#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/pictures/random_views.hpp"

namespace scancast {
namespace {

class Select : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        test::SyntheticSource source(100'000, test::ground, {});
        cloud_ = test::build(source, 512);
    }
    static void TearDownTestSuite() { cloud_.reset(); }
    void SetUp() override {
        ASSERT_TRUE(cloud_);
        View view;
        view.camera = cloud_->defaultCamera(16.0 / 9);
        viewpoint_ = Viewpoint::create(view, cloud_->origin, cloud_->bounds).value();
    }

    static inline std::shared_ptr<const Cloud> cloud_;
    Viewpoint viewpoint_;
};

TEST_F(Select, NothingFromAnEmptyOctree) {
    const Cut cut = select(Octree(), viewpoint_, {});
    EXPECT_TRUE(cut.runs.empty());
    EXPECT_EQ(cut.samples, 0u);
}

TEST_F(Select, OrdinalsAreDenseAndRunsInOrderOfNodes) {
    for (const bool budget : {false, true}) {
        SelectOptions options;
        if (budget) options.budget = 50'000;
        const Cut cut = select(cloud_->octree, viewpoint_, options);
        ASSERT_GT(cut.runs.size(), 3u);
        std::uint64_t next = 0;
        for (std::size_t i = 0; i < cut.runs.size(); ++i) {
            EXPECT_EQ(cut.runs[i].firstOrdinal, next);
            EXPECT_EQ(cut.runs[i].node, &cloud_->octree.node(cut.runs[i].nodeIndex));
            EXPECT_TRUE(cut.runs[i].samples.empty());
            if (i > 0) {
                EXPECT_LT(cut.runs[i - 1].nodeIndex, cut.runs[i].nodeIndex);
            }
            next += cut.runs[i].node->sampleCount;
        }
        EXPECT_EQ(cut.samples, next);
    }
}

TEST_F(Select, RefinesUntilTheSpacingIsSmallEnough) {
    for (const double detail : {0.7, 2.0, 5.0, 20.0}) {
        SelectOptions options;
        options.detail = detail;
        const Cut cut = select(cloud_->octree, viewpoint_, options);
        for (const CutRun& run : cut.runs) {
            const double distance = glm::length(run.node->center - viewpoint_.eye()) - run.node->radius;
            const double px = run.node->meanSpacing * viewpoint_.q(std::max(viewpoint_.near, distance));
            EXPECT_TRUE(px <= detail || run.node->isLeaf());
            EXPECT_LE(px, cut.spacingReached * (1 + 1e-12));
        }
    }
}

TEST_F(Select, MoreDetailMeansMoreSamples) {
    std::uint64_t before = 0;
    for (const double detail : {100.0, 20.0, 5.0, 2.0, 1.0, 0.0}) {
        SelectOptions options;
        options.detail = detail;
        const Cut cut = select(cloud_->octree, viewpoint_, options);
        EXPECT_GE(cut.samples, before);
        before = cut.samples;
    }
    EXPECT_EQ(before, cloud_->points);
}

TEST_F(Select, ABudgetIsKeptOrTheRootIsDrawn) {
    const std::uint64_t root = cloud_->octree.node(0).sampleCount;
    for (const std::uint64_t budget : {0ull, 1ull, 5'000ull, 30'000ull, 90'000ull, 10'000'000ull}) {
        SelectOptions options;
        options.detail = 0;
        options.budget = budget;
        const Cut cut = select(cloud_->octree, viewpoint_, options);
        EXPECT_LE(cut.samples, std::max(budget, root));
        EXPECT_EQ(cut.budgetReached, cut.samples < cloud_->points);
        if (budget < root) {
            EXPECT_EQ(cut.runs.size(), 1u);
        }
    }
}

TEST_F(Select, AGenerousBudgetChangesNothing) {
    for (std::uint64_t view = 0; view < 40; ++view) {
        const Viewpoint viewpoint = test::randomViewpoint(*cloud_, view);
        SelectOptions options;
        const Cut free = select(cloud_->octree, viewpoint, options);
        options.budget = 1'000'000'000;
        const Cut bound = select(cloud_->octree, viewpoint, options);
        ASSERT_EQ(free.runs.size(), bound.runs.size());
        for (std::size_t i = 0; i < free.runs.size(); ++i)
            EXPECT_EQ(free.runs[i].nodeIndex, bound.runs[i].nodeIndex);
        EXPECT_EQ(free.spacingReached, bound.spacingReached);
        EXPECT_EQ(free.nodesRefined, bound.nodesRefined);
        EXPECT_FALSE(bound.budgetReached);
    }
}

TEST_F(Select, LooksAwayAndDrawsNothing) {
    View view;
    view.camera = cloud_->defaultCamera(1);
    view.camera.target = view.camera.eye + (view.camera.eye - view.camera.target);
    const auto viewpoint = Viewpoint::create(view, cloud_->origin, cloud_->bounds);
    ASSERT_TRUE(viewpoint);
    const Cut cut = select(cloud_->octree, *viewpoint, {});
    EXPECT_TRUE(cut.runs.empty());
    EXPECT_EQ(cut.nodesCulled, 1u);
    SelectOptions all;
    all.cull = false;
    EXPECT_FALSE(select(cloud_->octree, *viewpoint, all).runs.empty());
}

}  // namespace
}  // namespace scancast
