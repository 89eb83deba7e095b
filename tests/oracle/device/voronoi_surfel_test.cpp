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

std::vector<Viewpoint> aroundTheCube() {
    return {lookAt({4, -3, 3}, {0, 0, 0}, 300, 300, 40), lookAt({3, -4, 2}, {0, 0, 0}, 640, 480, 40),
            lookAtOrthographic({4, -5, 4}, {0, 0, 0}, 400, 400, 4)};
}

/// How a picture of the cube shows its creases.
struct Creases {
    std::size_t covered = 0;
    std::size_t wrong = 0;   ///< pixels of another face than the ray's …
    std::size_t astray = 0;  ///< … which no ray within 1 px of theirs meets either
};

Creases creasesOf(const Viewpoint& view, const Frame& frame) {
    const auto faceAt = [&](double x, double y) { return faceHit(rayThrough(view, x, y)); };
    Creases c;
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            const int face = faceAt(x + 0.5, y + 0.5);
            if (face < 0 || std::isinf(depth(frame, x, y))) continue;
            ++c.covered;
            const int shown = int(std::lround((pixel(frame, x, y)[0] - 40) / 30.0));
            if (shown == face) continue;
            ++c.wrong;
            bool near = false;
            for (int i = 0; i < 32 && !near; ++i) {
                const double angle = i * 0.19634954084936207;
                near = faceAt(x + 0.5 + std::cos(angle), y + 0.5 + std::sin(angle)) == shown;
            }
            c.astray += near ? 0 : 1;
        }
    }
    return c;
}

// Right because the cube is known: two planes meet in a line, and a pixel on one side of it shows the face on that side.
TEST_P(VoronoiSurfels, CreasesAreTheLinesWhereTheFacesMeet) {
    for (const double spacing : {0.05, 0.1}) {
        const AnalyticCloud cloud(cubeOf(spacing), spacing);
        for (const Viewpoint& view : aroundTheCube()) {
            for (const bool smooth : {false, true}) {
                for (const bool oriented : {false, true}) {
                    const Creases c =
                        creasesOf(view, draw(*device_, view, cloud, voronoiPasses(smooth), oriented));
                    EXPECT_GT(c.covered, 10000u);
                    EXPECT_LE(c.wrong, c.covered / (oriented ? 5000 : 200)) << spacing;
                    // Without a side the inside of a hidden face may win beside an outline.
                    EXPECT_LE(c.astray, oriented ? 0 : c.covered / 250) << spacing;
                }
            }
        }
    }
}

TEST_P(VoronoiSurfels, SoAreThoseOfARoom) {
    std::vector<AnalyticPoint> points = cubeOf(0.1);
    for (AnalyticPoint& p : points) p.surfel = surfelOf(-glm::dvec3(p.surfel->normal), p.surfel->radius);
    const AnalyticCloud cloud(points, 0.1);
    for (const Viewpoint& view : {lookAt({-0.7, -0.5, 0.2}, {1, 0.8, -0.6}, 400, 300, 70),
                                  lookAt({0.4, -0.8, 0.6}, {-1, 1, -1}, 320, 240, 50)}) {
        for (const bool smooth : {false, true}) {
            const Creases c = creasesOf(view, draw(*device_, view, cloud, voronoiPasses(smooth), true));
            EXPECT_GT(c.covered, 70000u);
            EXPECT_LE(c.wrong, c.covered / 5000);
            EXPECT_EQ(c.astray, 0u);
        }
    }
}

// Right because the upper sheet covers the lower one, and nothing hangs over.
TEST_P(VoronoiSurfels, SheetsStayApart) {
    constexpr double spacing = 0.05, radius = 1.27 * spacing;
    std::vector<AnalyticPoint> points;
    for (const double height : {0.0, 0.5 * radius}) {
        for (AnalyticPoint& p : planeOf(1, 1, spacing, [&](double, double) {
                 return height > 0 ? Rgb8{200, 40, 40} : Rgb8{40, 40, 200};
             })) {
            p.position.z = height;
            p.surfel = surfelOf({0, 0, 1}, radius);
            points.push_back(p);
        }
    }
    const AnalyticCloud cloud(points, spacing);
    const Viewpoint view = lookAt({0, -3, 1.1}, {0, 0, 0}, 320, 200, 25);
    for (const bool smooth : {false, true}) {
        const Frame frame = draw(*device_, view, cloud, voronoiPasses(smooth), true);
        std::size_t lower = 0;
        for (int y = 85; y < 115; ++y) {
            for (int x = 60; x < 260; ++x) lower += pixel(frame, x, y)[0] < 190 ? 1 : 0;
        }
        EXPECT_LE(lower, 30u) << smooth;
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
