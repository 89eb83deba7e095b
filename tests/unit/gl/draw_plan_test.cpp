#include "renderer/device/gl/draw_plan.hpp"

#include <gtest/gtest.h>

#include "tests/support/analytic_cut.hpp"

namespace scancast::gl {
namespace {

using test::AnalyticCloud;
using test::AnalyticPoint;

const PassList sprites{NearestPass{}, ResolvePass{}};
const PassList lit{NearestPass{}, ResolvePass{}, EyeDomePass{}};

AnalyticCloud ball(int count, std::uint32_t leafPoints) {
    test::Numbers numbers(1);
    std::vector<AnalyticPoint> points;
    for (int i = 0; i < count; ++i) points.push_back({numbers.onSphere(), numbers.color()});
    return AnalyticCloud(points, 0.1, leafPoints);
}

struct Scene {
    explicit Scene(const AnalyticCloud& cloud) {
        drawing.viewpoint = &viewpoint;
        drawing.cut = &cloud.cut();
        drawing.passes = sprites;
        drawing.window = {0, 0, 64, 48};
        drawing.jitter = noJitter;
    }
    Viewpoint viewpoint = test::lookAt({0, -4, 0}, {0, 0, 0}, 64, 48);
    glm::dvec2 noJitter[1] = {{0, 0}};
    Drawing drawing;
};

/// Oracle: whatever the page size, pages and chunks name every sample of the cut exactly once, with its own
/// run.
TEST(DrawPlan, PagesHoldEverySampleOnce) {
    const AnalyticCloud cloud = ball(10007, 3000);
    const Scene scene(cloud);
    for (const std::size_t pageSamples : {768u, 1024u, 4097u, 100000u}) {
        GlLimits limits;
        limits.storageBlockBytes = pageSamples * sizeof(Sample);
        const auto plan = planDrawing(scene.drawing, limits);
        ASSERT_TRUE(plan) << plan.error().message;
        std::vector<const Sample*> seen;
        for (const SamplePage& page : plan->pages) {
            EXPECT_LE(page.samples * sizeof(Sample), limits.storageBlockBytes);
            std::vector<const Sample*> content;
            for (const auto& segment : page.segments) {
                for (const Sample& s : segment) content.push_back(&s);
            }
            ASSERT_EQ(content.size(), page.samples);
            std::uint32_t expectedFirst = 0;
            for (std::uint32_t c = 0; c < page.chunks; ++c) {
                const uvec4 range = plan->chunks[page.firstChunk + c].range;
                EXPECT_EQ(range.x, expectedFirst);
                EXPECT_LE(range.y, chunkSamples);
                const auto& run = cloud.cut().runs[range.z].samples;
                for (std::uint32_t i = 0; i < range.y; ++i) {
                    const Sample* s = content[range.x + i];
                    EXPECT_TRUE(s >= run.data() && s < run.data() + run.size());
                    seen.push_back(s);
                }
                expectedFirst += range.y;
            }
            EXPECT_EQ(expectedFirst, page.samples);
        }
        std::size_t at = 0;
        for (const CutRun& run : cloud.cut().runs) {
            for (const Sample& s : run.samples) {
                ASSERT_LT(at, seen.size());
                ASSERT_EQ(seen[at++], &s);
            }
        }
        EXPECT_EQ(at, seen.size());
    }
}

TEST(DrawPlan, EyeDomeLightingLooksBeyondTheWindowButNotBeyondThePicture) {
    const AnalyticCloud cloud = ball(10, 100);
    Scene scene(cloud);
    scene.drawing.passes = lit;
    scene.drawing.window = {0, 10, 64, 20};
    const auto plan = planDrawing(scene.drawing, {});
    ASSERT_TRUE(plan);
    EXPECT_EQ(plan->pass.area, ivec4(0, 8, 64, 24));
    EXPECT_EQ(plan->background.size(), 24u);
    EXPECT_EQ(plan->eyeDome->window, ivec4(0, 10, 64, 20));
}

TEST(DrawPlan, RunsOutsideTheClipBoxAreLeftOut) {
    const AnalyticCloud cloud = ball(1000, 100);
    Scene scene(cloud);
    scene.drawing.filter.clip = ClipBox{{5, 5, 5}, {6, 6, 6}};
    const auto nothing = planDrawing(scene.drawing, {});
    ASSERT_TRUE(nothing);
    EXPECT_TRUE(nothing->runs.empty());
    EXPECT_TRUE(nothing->pages.empty());
    scene.drawing.filter.clip = ClipBox{{-2, -2, -2}, {2, 2, 2}};
    EXPECT_EQ(planDrawing(scene.drawing, {})->runs.size(), cloud.cut().runs.size());
}

/// Oracle: octree.hpp's position() in double, moved to the view and projected by Viewpoint.
TEST(DrawPlan, RunsPlaceSamplesWhereTheViewpointProjectsThem) {
    const AnalyticCloud cloud = ball(500, 100);
    for (const bool perspective : {true, false}) {
        Scene scene(cloud);
        if (!perspective) scene.viewpoint = test::lookAtOrthographic({1, -4, 2}, {0, 0, 0}, 64, 48, 3);
        const auto plan = planDrawing(scene.drawing, {});
        ASSERT_TRUE(plan);
        for (std::size_t r = 0; r < plan->runs.size(); ++r) {
            const CutRun& run = cloud.cut().runs[r];
            for (const Sample& s : run.samples) {
                const glm::dvec3 expected = scene.viewpoint.project(
                    glm::dvec3(scene.viewpoint.cloudToView * glm::dvec4(position(*run.node, s), 1)));
                const glm::dvec4 words(s.x, s.y, s.z, 1);
                const auto row = [&](int i) {
                    return glm::dot(glm::dvec4(plan->runs[r].toPicture[i]), words);
                };
                const double divisor = perspective ? row(2) : 1;
                EXPECT_NEAR(row(2), expected.z, 1e-5);
                EXPECT_NEAR(32 + row(0) / divisor, expected.x, 1e-4);
                EXPECT_NEAR(24 + row(1) / divisor, expected.y, 1e-4);
            }
        }
    }
}

}  // namespace
}  // namespace scancast::gl
