// Blended ellipses with the screen's low-pass: docs/spec/surfels.md §4.
#include <gtest/gtest.h>

#include "tests/oracle/device/surfel_scenes.hpp"
#include "tests/support/pictures/devices.hpp"

namespace scancast::test {
namespace {

class Ewa : public OnDevice {};
SCANCAST_ON_DEVICES(Ewa, "egl");

constexpr double square = 0.25;

double chequer(double x, double y) {
    const auto odd = [](double v) { return int(std::floor(v / square)) & 1; };
    return odd(x) ^ odd(y) ? 255 : 0;
}

/// The mean of a chequerboard over a pixel, by 24 × 24 rays: its exact area average, but for 1/24 of an edge.
double averageOf(const Viewpoint& view, int x, int y, bool& inside, double across, double along) {
    double sum = 0;
    constexpr int rays = 24;
    for (int j = 0; j < rays; ++j) {
        for (int i = 0; i < rays; ++i) {
            const Ray ray = rayThrough(view, x + (i + 0.5) / rays, y + (j + 0.5) / rays);
            const glm::dvec3 hit = ray.origin - ray.direction * (ray.origin.z / ray.direction.z);
            inside = inside && ray.direction.z < 0 && std::abs(hit.x) < across && std::abs(hit.y) < along;
            if (!inside) return 0;
            sum += chequer(hit.x, hit.y);
        }
    }
    return sum / (rays * rays);
}

double psnr(const Viewpoint& view, const Frame& frame, double across, double along) {
    double error = 0;
    std::size_t count = 0;
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            bool inside = true;
            const double truth = averageOf(view, x, y, inside, across, along);
            if (!inside) continue;
            const double off = pixel(frame, x, y)[0] - truth;
            error += off * off;
            ++count;
        }
    }
    EXPECT_GT(count, frame.depth.size() / 5);
    return 10 * std::log10(255 * 255 / (error / double(count)));
}

AnalyticCloud chequeredPlane(double across, double along, double spacing) {
    std::vector<AnalyticPoint> points = planeOf(across, along, spacing, [](double x, double y) {
        const auto c = static_cast<std::uint8_t>(chequer(x, y));
        return Rgb8{c, c, c};
    });
    for (AnalyticPoint& p : points) p.surfel = surfelOf({0, 0, 1}, 1.27 * spacing);
    return AnalyticCloud(points, spacing);
}

// Right because the truth is the area average of the pattern itself: what a perfect low-pass would show.
TEST_P(Ewa, AveragesAChequerboardSeenAtAGrazingAngle) {
    constexpr double across = 10, along = 20, spacing = 0.05;
    const AnalyticCloud cloud = chequeredPlane(across, along, spacing);
    NearestPass circles = sprite(Footprint::Circle, Profile::Flat, 0);
    for (const Viewpoint& view :
         {lookAt({0, -24, 2}, {0, 0, 0}, 320, 180, 40), lookAt({3, -22, 1.2}, {0, 2, 0}, 200, 150, 30),
          lookAtOrthographic({0, -30, 4}, {0, 0, 0}, 240, 60, 5)}) {
        const double circle =
            psnr(view, draw(*device_, view, cloud, {circles, ResolvePass{}}), across, along);
        const double ewa = psnr(view, draw(*device_, view, cloud, ewaPasses()), across, along);
        EXPECT_GE(ewa, circle + 6) << circle << " dB with circles, " << ewa << " dB with ellipses";
    }
}

// Right because without the low-pass nothing filters what is smaller than a pixel.
TEST_P(Ewa, IsFilteredByItsLowPass) {
    constexpr double across = 10, along = 20, spacing = 0.05;
    const AnalyticCloud cloud = chequeredPlane(across, along, spacing);
    const Viewpoint view = lookAt({0, -24, 2}, {0, 0, 0}, 320, 180, 40);
    const double with = psnr(view, draw(*device_, view, cloud, ewaPasses(0.5)), across, along);
    const double without = psnr(view, draw(*device_, view, cloud, ewaPasses(0.02)), across, along);
    EXPECT_GE(with, without + 1) << with << " dB against " << without;
}

std::size_t beyondTheCube(const Viewpoint& view, const Frame& frame) {
    std::size_t count = 0;
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            if (std::isinf(depth(frame, x, y))) continue;
            count += faceHit(rayThrough(view, x + 0.5, y + 0.5)) < 0 ? 1 : 0;
        }
    }
    return count;
}

// Right because the cube's outline is known: what is drawn outside is overshoot. The same surfels are drawn
// as ellipses and as circles of their larger half-axis.
TEST_P(Ewa, EllipsesOvershootASilhouetteLessThanCircles) {
    for (const double spacing : {0.05, 0.1}) {
        std::vector<AnalyticPoint> ellipses = cubeOf(spacing);
        estimate(ellipses);
        std::vector<AnalyticPoint> circles = ellipses;
        for (AnalyticPoint& p : circles) p.surfel->minor = p.surfel->major;
        const AnalyticCloud narrow(ellipses, spacing), round(circles, spacing);
        for (const Viewpoint& view :
             {lookAt({0, -5, 0}, {0, 0, 0}, 400, 400, 35), lookAt({4, -3, 2}, {0, 0, 0}, 640, 480, 40),
              lookAtOrthographic({3, -5, 4}, {0, 0, 0}, 400, 400, 4.5)}) {
            const std::size_t less = beyondTheCube(view, draw(*device_, view, narrow, ewaPasses()));
            const std::size_t more = beyondTheCube(view, draw(*device_, view, round, ewaPasses()));
            EXPECT_GT(more, 50u);
            EXPECT_LE(double(less), 0.95 * double(more)) << spacing;
            const std::size_t same = beyondTheCube(view, draw(*device_, view, narrow, circularPasses()));
            EXPECT_NEAR(double(same), double(more), 0.01 * double(more)) << "shape=circle";
        }
    }
}

/// Fragments of a picture of one surfel that are not where its plane is hit within `a` of its centre, but for those nearer
/// than a pixel to its border.
std::size_t wronglyCovered(const Viewpoint& view, const Frame& frame, const glm::dvec3& normal, double a) {
    std::size_t wrong = 0, covered = 0;
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            const Ray ray = rayThrough(view, x + 0.5, y + 0.5);
            const double t = -glm::dot(ray.origin, normal) / glm::dot(ray.direction, normal);
            const double away = glm::length(ray.origin + t * ray.direction);
            const bool drawn = !std::isinf(depth(frame, x, y));
            covered += drawn ? 1 : 0;
            const double pixel = 1 / view.pixelsPerUnit / std::abs(glm::dot(ray.direction, normal));
            if (std::abs(away - a) > pixel) wrong += drawn != (away < a) ? 1 : 0;
        }
    }
    EXPECT_GT(covered, 500u);
    return wrong;
}

// Right because a circle in a tilted plane is seen wherever a ray meets the plane within its radius, and an ellipse of a
// quarter of that is not.
TEST_P(Ewa, CirclesAreThoseOfTheLargerHalfAxisInTheSurface) {
    for (const double tilt : {0.0, 0.6, 1.2}) {
        const glm::dvec3 normal(0, -std::cos(tilt), std::sin(tilt));
        AnalyticPoint point;
        point.rgb = {200, 200, 200};
        point.surfel = surfelOf(normal, 1, {1, 0, 0}, 0.25);
        const AnalyticCloud cloud(std::array{point}, 1);
        const double a = majorPerRadius;
        const Viewpoint view = lookAtOrthographic({0, -10, 0}, {0, 0, 0}, 160, 160, 4);
        EXPECT_EQ(wronglyCovered(view, draw(*device_, view, cloud, circularPasses(0)), normal, a), 0u)
            << tilt;
        EXPECT_GT(wronglyCovered(view, draw(*device_, view, cloud, ewaPasses(0)), normal, a), 500u) << tilt;
    }
}

}  // namespace
}  // namespace scancast::test
