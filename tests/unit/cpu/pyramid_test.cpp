// The kernels of docs/spec/pyramid.md §1 against the page's definitions in double
// (tests/support/pyramid_reference), on pictures full of accidents.
#include <gtest/gtest.h>

#include <cstring>
#include <glm/geometric.hpp>

#include "tests/support/pictures/point_accidents.hpp"
#include "tests/support/pictures/pyramid_reference.hpp"

namespace scancast::test {
namespace {

TEST(HidePoints, FollowsItsDefinition) {
    PyramidRunner runner;
    std::int64_t pixels = 0, hidden = 0, byAngles = 0, borderline = 0;
    for (const AccidentCase& c : accidentCases) {
        for (const float threshold : {0.1f, 0.02f, 0.3f}) {
            PointScreen s = accidents(c.width, c.height, c.perspective, c.cover, 7);
            runner.hidePoints(s, hiding(c, threshold));
            const ReferenceHidden expected = referenceHidden(s, hiding(c, threshold));
            for (int y = 0; y < s.height; ++y) {
                for (int x = 0; x < s.width; ++x) {
                    const std::size_t i = s.at(x, y);
                    ++pixels;
                    hidden += expected.labels[i] == 0 ? 1 : 0;
                    byAngles += expected.occlusion[i] > 0.01 && expected.occlusion[i] < 0.12 ? 1 : 0;
                    if (std::abs(expected.occlusion[i] - double(threshold)) < 1e-5) {
                        ++borderline;
                        continue;
                    }
                    ASSERT_EQ(s.labels[i], expected.labels[i])
                        << x << ", " << y << " of " << c.width << " x " << c.height << ", threshold "
                        << threshold << ", mean occlusion " << expected.occlusion[i];
                }
            }
        }
    }
    EXPECT_LT(borderline, pixels / 1000);
    // All ways to decide were taken.
    EXPECT_GT(hidden, pixels / 10);
    EXPECT_GT(pixels - hidden, pixels / 10);
    EXPECT_GT(byAngles, pixels / 20);
}

TEST(HidePoints, FollowsItsDefinitionInFixedNeighbourhoods) {
    PyramidRunner runner;
    std::int64_t hidden = 0, others = 0;
    for (const AccidentCase& c : accidentCases) {
        for (const float px : {1.0f, 6.0f, 20.0f}) {
            HiddenPointsPass pass = hiding(c);
            PointScreen s = accidents(c.width, c.height, c.perspective, c.cover, 7);
            runner.hidePoints(s, pass);
            const std::vector<std::uint8_t> adaptive = s.labels;
            pass.fixedPx = px;
            runner.hidePoints(s, pass);
            const ReferenceHidden expected = referenceHidden(s, pass);
            for (std::size_t i = 0; i < s.labels.size(); ++i) {
                hidden += s.labels[i] == 0 ? 1 : 0;
                others += s.labels[i] != adaptive[i] ? 1 : 0;
                if (std::abs(expected.occlusion[i] - double(pass.threshold)) < 1e-5) continue;
                ASSERT_EQ(s.labels[i], expected.labels[i]) << i << " of " << c.width << ", " << px << " px";
            }
        }
    }
    EXPECT_GT(hidden, 1000);
    EXPECT_GT(others, 1000) << "it says something";
}

TEST(HidePoints, NeverHidesWithoutPoints) {
    PyramidRunner runner;
    PointScreen s(90, 60, true, 80);
    HiddenPointsPass pass;
    pass.spacing = 0.1f;
    runner.hidePoints(s, pass);
    for (const std::uint8_t label : s.labels) ASSERT_EQ(label, 2);
}

TEST(PullPush, FollowsItsDefinition) {
    PyramidRunner runner;
    for (const AccidentCase& c : accidentCases) {
        PointScreen s = accidents(c.width, c.height, c.perspective, c.cover, 8);
        runner.hidePoints(s, hiding(c));
        const ReferenceFilled expected = referenceFilled(s);
        const PointScreen before = s;
        runner.fill(s, {});
        for (std::size_t i = 0; i < s.depth.size(); ++i) {
            if (before.labels[i] != 0) {
                ASSERT_EQ(s.rgba[i], before.rgba[i]);
                ASSERT_EQ(s.depth[i], before.depth[i]);
                continue;
            }
            ASSERT_NEAR(double(s.depth[i]) / expected.levels[0].depth[i], 1, 1e-5);
            ASSERT_EQ(s.rgba[i] >> 24, 255u);
            const glm::dvec3 color = expected.levels[0].color[i];
            for (int k = 0; k < 3; ++k) ASSERT_NEAR(double(s.rgba[i] >> (8 * k) & 255), color[k], 0.51);
        }
    }
}

TEST(DepthNormals, FollowTheirDefinition) {
    PyramidRunner runner;
    for (const AccidentCase& c : accidentCases) {
        PointScreen s = accidents(c.width, c.height, c.perspective, c.cover, 9);
        runner.hidePoints(s, hiding(c));
        const ReferenceFilled filled = referenceFilled(s);
        runner.fill(s, {});
        DepthNormalsPass pass;
        pass.spacing = c.spacing;
        pass.detail = c.detail;
        const std::vector<glm::dvec3> expected = referenceNormals(s, filled, pass);
        runner.findNormals(s, pass);
        std::int64_t wrong = 0, shown = 0;
        for (std::size_t i = 0; i < s.depth.size(); ++i) {
            ASSERT_EQ(s.normals[i] == 0, std::isinf(s.depth[i]));
            if (s.normals[i] == 0) continue;
            const glm::dvec3 n = normalOf(s.normals[i]);
            ++shown;
            // A picture of one texel has no slope: undefined here, facing the viewer there.
            if (std::isnan(expected[i].x)) {
                ASSERT_GT(n.z, 0.999);
                continue;
            }
            wrong += glm::dot(n, expected[i]) > std::cos(0.002) ? 0 : 1;
        }
        // Between two opposite slopes a mean is nearly nothing, and rounding turns it.
        EXPECT_LE(wrong, shown / 500) << c.width << " x " << c.height << ", " << c.perspective;
    }
}

TEST(DepthNormals, OfATiltedPlaneAreExact) {
    // Perspective or not, a plane's depths are known at every pixel, so differences span the plane itself.
    PyramidRunner runner;
    const glm::dvec3 normal = glm::normalize(glm::dvec3{0.4, -0.3, 1});
    for (const bool perspective : {true, false}) {
        PointScreen s(160, 120, perspective, perspective ? 140 : 20);
        for (int y = 0; y < s.height; ++y) {
            for (int x = 0; x < s.width; ++x) {
                // n · p = n · (0, 0, -10)
                const ScreenPoint ray = s.through(x, y);
                const double depth = perspective
                                         ? 10 * normal.z / (normal.z - normal.x * ray.x - normal.y * ray.y)
                                         : 10 + (normal.x * ray.x + normal.y * ray.y) / normal.z;
                s.depth[s.at(x, y)] = static_cast<float>(depth);
                s.labels[s.at(x, y)] = 1;
            }
        }
        HiddenPointsPass hide;
        hide.spacing = 0.01f;
        hide.detail = 0;
        hide.minGap = 5;
        runner.hidePoints(s, hide);
        runner.fill(s, {});
        DepthNormalsPass pass;
        pass.spacing = perspective ? 0.12f : 0.08f;
        pass.detail = 0;
        runner.findNormals(s, pass);
        for (int y = 8; y < 112; ++y) {
            for (int x = 8; x < 152; ++x) {
                const glm::dvec3 n = normalOf(s.normals[s.at(x, y)]);
                ASSERT_LT(std::acos(std::min(1.0, glm::dot(n, normal))), 0.01) << x << ", " << y;
            }
        }
    }
}

TEST(Pyramid, SameBytesOnAnyNumberOfThreadsAndAnySimdLevel) {
    for (const AccidentCase& c : accidentCases) {
        std::vector<PointScreen> results;
        for (const cpu::SimdLevel& level : cpu::simdLevels()) {
            if (!level.available()) continue;
            for (const int threads : {1, 2, 5}) {
                PyramidRunner runner(threads, &level);
                PointScreen s = accidents(c.width, c.height, c.perspective, c.cover, 10);
                runner.run(s, c.spacing, c.detail);
                results.push_back(std::move(s));
            }
        }
        ASSERT_GE(results.size(), 3u);
        for (const PointScreen& s : results) {
            ASSERT_EQ(s.labels, results[0].labels);
            ASSERT_EQ(s.rgba, results[0].rgba);
            ASSERT_EQ(0, std::memcmp(s.depth.data(), results[0].depth.data(), 4 * s.depth.size()));
            ASSERT_EQ(s.normals, results[0].normals);
        }
    }
}

TEST(Pyramid, PicturesDoNotDependOnEarlierOnes) {
    PyramidRunner used;
    for (const AccidentCase& c : accidentCases) {
        PointScreen s = accidents(c.width, c.height, c.perspective, c.cover, 11), t = s;
        used.run(s, c.spacing, c.detail);
        PyramidRunner fresh;
        fresh.run(t, c.spacing, c.detail);
        ASSERT_EQ(s.rgba, t.rgba);
        ASSERT_EQ(s.normals, t.normals);
    }
}

TEST(Pyramid, HostileNumbersEndInASanePicture) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    PyramidRunner runner;
    for (const float spacing : {0.0f, 1e-30f, 1e30f, inf, nan, -1.0f}) {
        for (const float detail : {0.0f, 1e20f, nan}) {
            for (const double pixels : {1e-6, 1.0, 1e12}) {
                PointScreen s = accidents(70, 50, true, 0.4, 12);
                s.pixelsPerUnit = pixels;
                s.depth[40] = std::numeric_limits<float>::denorm_min();
                s.depth[70 * 20 + 30] = 1e38f;
                runner.run(s, spacing, detail);
                for (std::size_t i = 0; i < s.depth.size(); ++i) {
                    ASSERT_LE(s.labels[i], 2);
                    ASSERT_EQ(s.rgba[i] >> 24, 255u);
                }
            }
        }
    }
}

}  // namespace
}  // namespace scancast::test
