// Voronoi rasterization of oriented discs: docs/spec/voronoi.md §2.
#include <gtest/gtest.h>

#include "tests/oracle/device/surfel_scenes.hpp"
#include "tests/support/pictures/devices.hpp"

namespace scancast::test {
namespace {

class VoronoiSurfels : public OnDevice {};
SCANCAST_ON_DEVICES(VoronoiSurfels, "egl");

/// Of the covered pixels, the share for which `right` holds (x, y, number of the point there).
template <class Right>
double shareOf(const Frame& frame, const Right& right) {
    std::size_t covered = 0, good = 0;
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            if (std::isinf(depth(frame, x, y))) continue;
            ++covered;
            good += right(x, y, number(pixel(frame, x, y))) ? 1 : 0;
        }
    }
    EXPECT_GT(covered, frame.depth.size() / 5);
    return double(good) / double(covered);
}

/// Distances of a place to the nearest and second nearest of the points, and which they are.
struct TwoNearest {
    std::size_t first = 0, second = 0;
    double distance = 1e300, other = 1e300;
};

TwoNearest twoNearest(const std::vector<AnalyticPoint>& points, const glm::dvec3& place) {
    TwoNearest t;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 away = points[i].position - place;
        const double d = glm::dot(away, away);
        if (d < t.distance) {
            t.second = t.first;
            t.other = t.distance;
            t.first = i;
            t.distance = d;
        } else if (d < t.other) {
            t.second = i;
            t.other = d;
        }
    }
    return t;
}

// Right because on a plane the cell of a point is what lies nearer to it than to any other, by brute force.
TEST_P(VoronoiSurfels, CellsOfAPlaneBelongToTheNearestCentre) {
    std::size_t next = 0;
    std::vector<AnalyticPoint> points =
        planeOf(1.6, 1.6, 0.08, [&](double, double) { return numbered(++next); });
    for (AnalyticPoint& p : points) p.surfel = surfelOf({0, 0, 1}, 1.27 * 0.08);
    const AnalyticCloud cloud(points, 0.08);
    for (const Viewpoint& view :
         {lookAt({0, 0, 2}, {0, 0, 0}, 240, 180, 50), lookAt({0, 0, 3}, {0, 0, 0}, 512, 384, 40),
          lookAtOrthographic({0, 0, 2}, {0, 0, 0}, 300, 300, 2.4)}) {
        const Frame frame = draw(*device_, view, cloud, voronoiPasses(false));
        const double share = shareOf(frame, [&](int x, int y, std::size_t n) {
            const Ray ray = rayThrough(view, x + 0.5, y + 0.5);
            const TwoNearest t =
                twoNearest(points, ray.origin - ray.direction * (ray.origin.z / ray.direction.z));
            return n == t.first + 1;
        });
        EXPECT_GE(share, 0.995);
    }
}

// Right because geodesic order on a sphere is the order of angles, so of straight distances, by brute force.
TEST_P(VoronoiSurfels, CellsOfASphereBelongToOneOfTheTwoNearest) {
    const std::vector<AnalyticPoint> points = sphereOf(8000);
    const AnalyticCloud cloud(points, 0.04);
    for (const Viewpoint& view :
         {lookAt({2.6, 0.5, 0.4}, {0, 0, 0}, 160, 120, 50), lookAt({-1, 2.2, 1}, {0, 0, 0}, 320, 240, 50),
          lookAtOrthographic({1, -3, 2}, {0, 0, 0}, 240, 240, 2.2)}) {
        const Frame frame = draw(*device_, view, cloud, voronoiPasses(false), true);
        const double share = shareOf(frame, [&](int x, int y, std::size_t n) {
            const Ray ray = rayThrough(view, x + 0.5, y + 0.5);
            const double along = -glm::dot(ray.origin, ray.direction);
            const glm::dvec3 closest = ray.origin + ray.direction * along;
            const double rest = 1 - glm::dot(closest, closest);
            // Beyond the outline there is no place on the sphere to be right about.
            if (rest < 0) return true;
            const glm::dvec3 hit = closest - ray.direction * std::sqrt(rest);
            const TwoNearest t = twoNearest(points, hit);
            return n == t.first + 1 || n == t.second + 1;
        });
        EXPECT_GE(share, 0.99);
    }
}

/// Share of the cube's covered pixels that show another face than the ray meets.
double wrongFaces(const Viewpoint& view, const Frame& frame) {
    std::size_t covered = 0, wrong = 0;
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            const int face = faceHit(rayThrough(view, x + 0.5, y + 0.5));
            if (face < 0 || std::isinf(depth(frame, x, y))) continue;
            ++covered;
            wrong += pixel(frame, x, y)[0] != 40 + 30 * face ? 1 : 0;
        }
    }
    EXPECT_GT(covered, frame.depth.size() / 8);
    return double(wrong) / double(covered);
}

std::vector<Viewpoint> aroundTheCube() {
    return {lookAt({4, -3, 3}, {0, 0, 0}, 300, 300, 40), lookAt({3, -4, 2}, {0, 0, 0}, 640, 480, 40),
            lookAtOrthographic({4, -5, 4}, {0, 0, 0}, 400, 400, 4)};
}

// Right because it is known which face a ray meets. Discs' flaps hide a strip of 0.8 spacings beside each
// crease; cells end where both sides' centres are equally far, which is at the crease but for the disorder
// of the samples.
TEST_P(VoronoiSurfels, CreasesStaySharp) {
    for (const double spacing : {0.05, 0.1}) {
        const AnalyticCloud cloud(cubeOf(spacing), spacing);
        for (const Viewpoint& view : aroundTheCube()) {
            const double cells = wrongFaces(view, draw(*device_, view, cloud, voronoiPasses(false), true));
            const double discs = wrongFaces(view, draw(*device_, view, cloud, discPasses(), true));
            EXPECT_LE(cells, 0.5 * discs) << spacing << ": " << discs;
            EXPECT_LE(cells, 0.5 * spacing) << spacing;
        }
    }
}

// Right because the field is blended inside the cells only: which pixels are drawn, and how deep, is the
// same.
TEST_P(VoronoiSurfels, SmoothCoversWhatFlatCovers) {
    const AnalyticCloud cloud(sphereOf(3000), 0.065);
    const Viewpoint view = lookAt({2.6, 0.5, 0.4}, {0, 0, 0}, 320, 240, 50);
    const Frame flat = draw(*device_, view, cloud, voronoiPasses(false));
    const Frame smooth = draw(*device_, view, cloud, voronoiPasses(true));
    EXPECT_EQ(flat.depth, smooth.depth);
    EXPECT_NE(flat.rgba, smooth.rgba);
}

// Right because the colours are the positions themselves: a field that interpolates shows, at a pixel, about
// the position that its ray meets, between its neighbours' and not one of them.
TEST_P(VoronoiSurfels, SmoothInterpolatesBetweenTheCentres) {
    std::vector<AnalyticPoint> points = planeOf(1.6, 1.6, 0.1, [](double x, double y) {
        return Rgb8{std::uint8_t(127.5 + 75 * x), std::uint8_t(127.5 + 75 * y), 0};
    });
    for (AnalyticPoint& p : points) p.surfel = surfelOf({0, 0, 1}, 0.127);
    const AnalyticCloud cloud(points, 0.1);
    const Viewpoint view = lookAt({0.3, -0.8, 1.5}, {0, 0, 0}, 320, 240, 50);
    const auto error = [&](const Frame& frame) {
        double sum = 0;
        std::size_t count = 0;
        for (int y = 0; y < frame.height; ++y) {
            for (int x = 0; x < frame.width; ++x) {
                const Ray ray = rayThrough(view, x + 0.5, y + 0.5);
                const glm::dvec3 hit = ray.origin - ray.direction * (ray.origin.z / ray.direction.z);
                if (std::max(std::abs(hit.x), std::abs(hit.y)) > 1.3) continue;
                sum += std::pow(pixel(frame, x, y)[0] - (127 + 75 * hit.x), 2);
                ++count;
            }
        }
        return std::sqrt(sum / double(count));
    };
    const double smooth = error(draw(*device_, view, cloud, voronoiPasses(true)));
    const double flat = error(draw(*device_, view, cloud, voronoiPasses(false)));
    EXPECT_LE(smooth, 0.5 * flat) << flat;
}

/// Drawn pixels inside and outside the cube's outline.
struct Drawn {
    std::size_t inside = 0, outside = 0;
};

Drawn drawnOf(const Viewpoint& view, const Frame& frame) {
    Drawn drawn;
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            if (std::isinf(depth(frame, x, y))) continue;
            const bool hit = faceHit(rayThrough(view, x + 0.5, y + 0.5)) >= 0;
            ++(hit ? drawn.inside : drawn.outside);
        }
    }
    return drawn;
}

// Right because the cube's outline is known: what is drawn outside is the scalloped rim that the paper's
// option clips, and nothing else may go.
TEST_P(VoronoiSurfels, BackFacingDiscsClipTheSilhouette) {
    const AnalyticCloud cloud(cubeOf(0.1), 0.1);
    for (const Viewpoint& view : aroundTheCube()) {
        const Drawn all = drawnOf(view, draw(*device_, view, cloud, voronoiPasses(false), true));
        const Drawn clipped = drawnOf(view, draw(*device_, view, cloud, voronoiPasses(false, true), true));
        EXPECT_GT(all.outside, 500u);
        EXPECT_LE(double(clipped.outside), 0.3 * double(all.outside));
        EXPECT_GE(double(clipped.inside), 0.995 * double(all.inside));
    }
}

}  // namespace
}  // namespace scancast::test
