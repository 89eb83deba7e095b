// Cuts against brute force, over many views of several clouds.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/vector_relational.hpp>
#include <set>

#include "renderer/select/select.hpp"
#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/pictures/random_shapes.hpp"
#include "tests/support/pictures/random_views.hpp"

namespace scancast {
namespace {

constexpr std::uint64_t views = 120;

class Cuts : public testing::TestWithParam<bool> {
  protected:
    void SetUp() override {
        test::SyntheticSource source(60'000, GetParam() ? test::ground : test::ball, {});
        cloud_ = test::build(source, 300);
        ASSERT_TRUE(cloud_);
    }
    std::shared_ptr<const Cloud> cloud_;
};

// Right because it walks up from every leaf: the cut shows a leaf's surface once if exactly one of the leaf
// and its ancestors is drawn; twice is a doubled surface, never is a hole.
TEST_P(Cuts, CoverEveryLeafExactlyOnce) {
    const Octree& o = cloud_->octree;
    for (std::uint64_t v = 0; v < views; ++v) {
        const Viewpoint viewpoint = test::randomViewpoint(*cloud_, v);
        SelectOptions options;
        options.cull = false;
        options.detail = std::array{0.0, 0.5, 2.0, 10.0}[v % 4];
        if (v % 3 == 0) options.budget = 1000 + v * 400;
        const Cut cut = select(o, viewpoint, options);
        std::vector<bool> drawn(o.nodes().size());
        for (const CutRun& run : cut.runs) drawn[run.nodeIndex] = true;
        for (std::uint32_t leaf = 0; leaf < o.nodes().size(); ++leaf) {
            if (!o.node(leaf).isLeaf()) continue;
            int times = 0;
            for (std::uint32_t up = leaf; up != noNode; up = o.node(up).parent) times += drawn[up];
            ASSERT_EQ(times, 1) << "view " << v << ", leaf " << leaf;
        }
        EXPECT_EQ(cut.points, cloud_->points);
    }
}

/// Whether the splat of a sample touches the picture: its centre's depth lies in range, and the square of
/// half-size `reach` px around its projection meets the viewport. As docs/spec/passes.md §2.1 and
/// docs/spec/sprites.md §2 define it, nothing shared.
bool touches(const Viewpoint& v, const glm::dvec3& p, double growPx, double radius) {
    const glm::dvec3 inView(v.cloudToView * glm::dvec4(p, 1));
    const double depth = -inView.z;
    if (depth < v.near || depth > v.far) return false;
    const double reach = std::max(growPx, radius * v.q(depth));
    const double x = v.width * 0.5 + inView.x * v.q(depth), y = v.height * 0.5 - inView.y * v.q(depth);
    return x + reach >= 0 && x - reach <= v.width && y + reach >= 0 && y - reach <= v.height;
}

// Right because it projects every sample of the unculled cut by brute force: whatever touches the picture
// must be in the culled cut, and the culled cut must draw nothing that the unculled one does not.
TEST_P(Cuts, CulledShowTheSameAsNotCulled) {
    std::uint64_t visible = 0, culledNodes = 0;
    for (std::uint64_t v = 0; v < views; ++v) {
        const Viewpoint viewpoint = test::randomViewpoint(*cloud_, v);
        SelectOptions options;
        options.detail = 1 + double(v % 5);
        options.growPx = std::array{1.0, 2.5, 25.0}[v % 3];
        options.growSpacings = std::array{0.0, 1.0, 3.0}[v / 3 % 3];
        const Cut culled = select(cloud_->octree, viewpoint, options);
        options.cull = false;
        const Cut full = select(cloud_->octree, viewpoint, options);
        std::set<std::uint32_t> kept;
        for (const CutRun& run : culled.runs) kept.insert(run.nodeIndex);
        culledNodes += culled.nodesCulled;
        std::size_t found = 0;
        for (const CutRun& run : full.runs) {
            const bool isKept = kept.contains(run.nodeIndex);
            found += isKept;
            if (isKept) continue;
            for (const Sample& s : test::samples(cloud_->octree, *run.node))
                ASSERT_FALSE(touches(viewpoint, position(*run.node, s), options.growPx,
                                     options.growSpacings * run.node->spacing))
                    << "view " << v << ", node " << run.nodeIndex;
        }
        EXPECT_EQ(found, kept.size());
        visible += culled.samples;
    }
    EXPECT_GT(visible, 0u);
    EXPECT_GT(culledNodes, 100u);
}

// Right because it asks of every sample of the unclipped cut whether it lies in what is left, by the definition of shapes:
// nothing that does may be missing, and what crosses nothing must not be there.
TEST_P(Cuts, ClippedLackNothingThatIsLeft) {
    std::uint64_t clipped = 0, visible = 0;
    const glm::dvec3 extent = cloud_->bounds[1] - cloud_->bounds[0];
    for (std::uint64_t v = 0; v < views; ++v) {
        const Viewpoint viewpoint = test::randomViewpoint(*cloud_, v);
        const ClipShapes shapes =
            test::randomShapes(v, (cloud_->bounds[0] + cloud_->bounds[1]) * 0.5, 0.5 * extent.x);
        SelectOptions options;
        options.detail = 1 + double(v % 5);
        const Cut full = select(cloud_->octree, viewpoint, options);
        options.shapes = clipRegions(shapes, cloud_->origin);
        if (v % 4 == 0)
            options.clip = ClipBox{cloud_->bounds[0] - cloud_->origin + extent * 0.2,
                                   cloud_->bounds[1] - cloud_->origin};
        const Cut cut = select(cloud_->octree, viewpoint, options);
        std::set<std::uint32_t> kept;
        for (const CutRun& run : cut.runs) kept.insert(run.nodeIndex);
        EXPECT_GE(cut.nodesCulled, cut.nodesClipped);
        clipped += cut.nodesClipped;
        visible += cut.runs.size();
        for (const CutRun& run : full.runs) {
            if (kept.contains(run.nodeIndex)) continue;
            for (const Sample& s : test::samples(cloud_->octree, *run.node)) {
                const glm::dvec3 p = position(*run.node, s);
                const bool inBox = !options.clip || (glm::all(glm::greaterThanEqual(p, options.clip->min)) &&
                                                     glm::all(glm::lessThanEqual(p, options.clip->max)));
                ASSERT_FALSE(inBox && contains(shapes, p + cloud_->origin))
                    << "view " << v << ", node " << run.nodeIndex;
            }
        }
        for (const CutRun& run : cut.runs)
            ASSERT_NE(
                options.shapes.overlap(run.node->boxMin - run.node->step, run.node->boxMax + run.node->step),
                Overlap::None);
    }
    EXPECT_GT(clipped, 100u);
    EXPECT_GT(visible, 100u);
}

// Right by definition: full detail is all leaves, whatever the view, and so is brute force.
TEST_P(Cuts, FullDetailIsEveryLeafSample) {
    for (std::uint64_t v = 0; v < views; ++v) {
        const Viewpoint viewpoint = test::randomViewpoint(*cloud_, v);
        SelectOptions options;
        options.detail = 0;
        options.cull = false;
        const Cut fine = select(cloud_->octree, viewpoint, options);
        options = {};
        options.bruteForce = true;
        const Cut brute = select(cloud_->octree, viewpoint, options);
        ASSERT_EQ(fine.samples, cloud_->points);
        ASSERT_EQ(fine.runs.size(), brute.runs.size());
        for (std::size_t i = 0; i < fine.runs.size(); ++i)
            ASSERT_EQ(fine.runs[i].nodeIndex, brute.runs[i].nodeIndex);
    }
}

/// Algorithm 3 as the paper writes it, without a queue: look through all nodes drawn so far for the coarsest,
/// replace it by its children, until the next replacement would not fit.
std::set<std::uint32_t> refineByHand(const Octree& o, const Viewpoint& viewpoint, double detail,
                                     std::uint64_t budget) {
    std::set<std::uint32_t> drawn{0};
    for (;;) {
        std::uint64_t samples = 0;
        std::uint32_t coarsest = noNode;
        double spacing = detail;
        for (const std::uint32_t i : drawn) {
            const Node& n = o.node(i);
            samples += n.sampleCount;
            const double distance = glm::length(n.center - viewpoint.eye()) - n.radius;
            const double px = n.meanSpacing * viewpoint.q(std::max(viewpoint.near, distance));
            if (!n.isLeaf() && px > spacing)
                spacing = px, coarsest = i;  // the set is ordered: ties to the smaller
        }
        if (coarsest == noNode) return drawn;
        const Node& n = o.node(coarsest);
        std::uint64_t after = samples - n.sampleCount;
        for (std::uint32_t c = 0; c < n.childCount; ++c) after += o.node(n.firstChild + c).sampleCount;
        if (after > std::max(budget, samples)) return drawn;
        drawn.erase(coarsest);
        for (std::uint32_t c = 0; c < n.childCount; ++c) drawn.insert(n.firstChild + c);
    }
}

// Right because it is the algorithm's plain text, with a search instead of a queue.
TEST_P(Cuts, ABudgetGoesToTheCoarsestNodesFirst) {
    const Octree& o = cloud_->octree;
    for (std::uint64_t v = 0; v < views; ++v) {
        const Viewpoint viewpoint = test::randomViewpoint(*cloud_, v);
        SelectOptions options;
        options.detail = v % 2 ? 0.0 : 3.0;
        options.cull = false;
        options.budget = 3000 + v * 300;
        const Cut cut = select(o, viewpoint, options);
        std::set<std::uint32_t> drawn;
        for (const CutRun& run : cut.runs) drawn.insert(run.nodeIndex);
        ASSERT_EQ(drawn, refineByHand(o, viewpoint, options.detail, *options.budget)) << "view " << v;
    }
}

/// A ball with normals, seen from a number's direction and distance, outside and inside, in both projections.
Viewpoint lookAtBall(const Cloud& cloud, std::uint64_t number) {
    View view = test::randomView(cloud, number);
    view.camera.target = glm::dvec3(0);
    const glm::dvec3 from(test::uniform(number, 1) - 0.5, test::uniform(number, 2) - 0.5,
                          test::uniform(number, 3) - 0.5);
    view.camera.eye = glm::normalize(from) * (5 + 60 * test::uniform(number, 4));
    return Viewpoint::create(view, cloud.origin, cloud.bounds).value();
}

std::shared_ptr<const Cloud> ballWithNormals() {
    test::SyntheticSource source(60'000, test::ball, {.normal = true});
    return test::build(source, 300);
}

// Right because it decodes every normal of every culled node and asks whether its front is turned to the eye,
// which knows nothing of cones and spheres.
TEST(BackFaces, CulledNodesShowNoFront) {
    const auto cloud = ballWithNormals();
    ASSERT_TRUE(cloud);
    std::uint64_t facingAway = 0;
    for (std::uint64_t v = 0; v < views; ++v) {
        const Viewpoint viewpoint = lookAtBall(*cloud, v);
        SelectOptions options;
        options.detail = 1 + double(v % 5);
        options.cull = false;
        const Cut all = select(cloud->octree, viewpoint, options);
        options.cullBackFaces = true;
        const Cut culled = select(cloud->octree, viewpoint, options);
        std::set<std::uint32_t> kept;
        for (const CutRun& run : culled.runs) kept.insert(run.nodeIndex);
        facingAway += culled.nodesFacingAway;
        for (const CutRun& run : all.runs) {
            if (kept.contains(run.nodeIndex)) continue;
            for (const Sample& s : test::samples(cloud->octree, *run.node)) {
                const glm::dvec3 sight = viewpoint.projection == Projection::Orthographic
                                             ? viewpoint.direction()
                                             : position(*run.node, s) - viewpoint.eye();
                ASSERT_GT(glm::dot(sight, glm::dvec3(decodeNormal(s.normal))), 0)
                    << "view " << v << ", node " << run.nodeIndex;
            }
        }
    }
    EXPECT_GT(facingAway, views);
}

// Right because a convex body's far half lies behind its near half: of a closed ball, no sample of a culled
// node is the nearest one on its line of sight; the ball's own equation says where that is.
TEST(BackFaces, CulledNodesLieBehindTheFront) {
    const auto cloud = ballWithNormals();
    ASSERT_TRUE(cloud);
    std::uint64_t tested = 0;
    for (std::uint64_t v = 0; v < views; ++v) {
        const Viewpoint viewpoint = lookAtBall(*cloud, v);
        const bool parallel = viewpoint.projection == Projection::Orthographic;
        const glm::dvec3 eye = viewpoint.eye();
        if (!parallel && glm::length(eye + cloud->origin) < 11)
            continue;  // inside, every wall is a back face
        SelectOptions options;
        options.detail = 2;
        options.cull = false;
        const Cut all = select(cloud->octree, viewpoint, options);
        options.cullBackFaces = true;
        std::set<std::uint32_t> kept;
        for (const CutRun& run : select(cloud->octree, viewpoint, options).runs) kept.insert(run.nodeIndex);
        for (const CutRun& run : all.runs) {
            if (kept.contains(run.nodeIndex)) continue;
            for (const Sample& s : test::samples(cloud->octree, *run.node)) {
                const glm::dvec3 p = position(*run.node, s) + cloud->origin;
                const glm::dvec3 sight =
                    parallel ? viewpoint.direction() : glm::normalize(p - eye - cloud->origin);
                // The line p + t·sight meets the sphere once more, nearer to the eye, at t = -2 p·sight; at
                // the rim, normals that are rounded by up to 0.95° leave 10 · sin 0.95° to argue about.
                ASSERT_GT(glm::dot(p, sight), -0.17) << "view " << v << ", node " << run.nodeIndex;
                ++tested;
            }
        }
    }
    EXPECT_GT(tested, 10'000u);
}

INSTANTIATE_TEST_SUITE_P(Clouds, Cuts, testing::Bool(),
                         [](const auto& p) { return std::string(p.param ? "ground" : "ball"); });

}  // namespace
}  // namespace scancast
