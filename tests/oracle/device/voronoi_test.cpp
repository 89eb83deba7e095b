// Sprites share the picture like cells of a Voronoi diagram: docs/spec/sprites.md §3.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"

namespace scancast::test {
namespace {

class Voronoi : public OnDevice {};
SCANCAST_ON_DEVICES(Voronoi, "egl");

Rgb8 numbered(std::size_t i) {
    return {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8),
            static_cast<std::uint8_t>(i >> 16)};
}

std::size_t number(Rgb8 c) {
    return c[0] | std::size_t{c[1]} << 8 | std::size_t{c[2]} << 16;
}

/// A jittered grid of points on the plane y = `depth`, seen from the origin: about `apart` px between
/// neighbours.
std::vector<AnalyticPoint> facingPlane(const Viewpoint& view, double depth, double apart,
                                       double disorder = 1) {
    Numbers numbers(31);
    std::vector<AnalyticPoint> points;
    const double step = apart / view.q(depth);
    const int across = int(view.width / apart / 2) + 2, down = int(view.height / apart / 2) + 2;
    for (int i = -across; i <= across; ++i) {
        for (int j = -down; j <= down; ++j) {
            AnalyticPoint p;
            p.position = {(i + disorder * numbers.uniform(-0.5, 0.5)) * step, depth,
                          (j + disorder * numbers.uniform(-0.5, 0.5)) * step};
            p.rgb = numbered(points.size() + 1);
            points.push_back(p);
        }
    }
    return points;
}

struct Seen {
    double x, y;
};

std::vector<Seen> projected(const Viewpoint& view, const AnalyticCloud& cloud, std::size_t count) {
    std::vector<Seen> places(count + 1);
    for (const CutRun& run : cloud.cut().runs) {
        for (const Sample& s : run.samples) {
            const glm::dvec4 v = view.cloudToView * glm::dvec4(position(*run.node, s), 1);
            places[number({s.r, s.g, s.b})] = {view.width / 2.0 + view.q(-v.z) * v.x,
                                               view.height / 2.0 - view.q(-v.z) * v.y};
        }
    }
    return places;
}

TEST_P(Voronoi, EqualParaboloidsOnAFacingPlaneAreTheVoronoiDiagramOfTheirCentres) {
    // Right because among equal paraboloids at one depth the lowest at a pixel is the one whose centre is
    // nearest.
    const int width = slow_ ? 160 : 320, height = slow_ ? 120 : 240;
    const Viewpoint view = lookAt({0, 0, 0}, {0, 1, 0}, width, height);
    const double sizePx = 12;
    const std::vector<AnalyticPoint> points = facingPlane(view, 5, 6);
    const AnalyticCloud cloud(points, 0.1);
    const std::vector<Seen> places = projected(view, cloud, points.size());
    struct Nearest {
        std::size_t number = 0;
        double distance = 1e9;
    };
    std::vector<Nearest> diagram;  // by brute force, of every pixel
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            Nearest& nearest = diagram.emplace_back();
            for (std::size_t i = 1; i < places.size(); ++i) {
                const double d = std::hypot(x + 0.5 - places[i].x, y + 0.5 - places[i].y);
                if (d < nearest.distance) nearest = {i, d};
            }
        }
    }
    for (const Profile profile : {Profile::Paraboloid, Profile::Cone, Profile::Sphere, Profile::Flat}) {
        Scene scene(view, cloud.cut(), sprite(Footprint::Circle, profile, float(sizePx)));
        const Frame frame = mustDraw(*device_, scene.drawing);
        int covered = 0, right = 0, outside = 0;
        for (int y = 0; y < frame.height; ++y) {
            for (int x = 0; x < frame.width; ++x) {
                const auto& [nearest, best] = diagram[static_cast<std::size_t>(y * width + x)];
                const std::size_t shown = number(pixel(frame, x, y));
                if (best > sizePx / 2 + 1) outside += shown != 0 ? 1 : 0;
                if (best > sizePx / 2) continue;
                ++covered;
                right += shown == nearest ? 1 : 0;
            }
        }
        EXPECT_GT(covered, width * height * 9 / 10);
        EXPECT_EQ(outside, 0) << "nothing outside the union of discs";
        // Flat circles too: at equal depths the nearest centre wins, by the payload's 8 bits.
        EXPECT_GE(double(right) / covered, profile == Profile::Flat ? 0.97 : 0.995) << int(profile);
    }
}

/// Where the border between two sprites lies in every row: x of the first pixel of the right one, refined to
/// a fraction of a pixel by drawing with the picture shifted in steps of 1/32 px.
std::vector<double> border(Device& device, const Viewpoint& view, const AnalyticCloud& cloud,
                           const NearestPass& pass, int y0, int y1) {
    constexpr int steps = 32;
    std::vector<double> sum(static_cast<std::size_t>(y1 - y0), 0);
    for (int s = 0; s < steps; ++s) {
        Scene scene(view, cloud.cut(), pass);
        const glm::dvec2 shift{(s + 0.5) / steps, 0};
        scene.drawing.jitter = {&shift, 1};
        const Frame frame = mustDraw(device, scene.drawing);
        for (int y = y0; y < y1; ++y) {
            int x = frame.width / 2;
            // Walk from inside the left sprite to the first pixel of the right one.
            while (x > 0 && number(pixel(frame, x, y)) != 1) --x;
            while (x < frame.width && number(pixel(frame, x, y)) != 2) ++x;
            sum[static_cast<std::size_t>(y - y0)] += (x - shift.x) / steps;
        }
    }
    return sum;
}

/// Largest distance of the border from the straight line through it (least squares), px.
double bend(const std::vector<double>& x) {
    const double n = double(x.size());
    double sy = 0, sx = 0, syy = 0, sxy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        sy += double(i), sx += x[i], syy += double(i) * double(i), sxy += double(i) * x[i];
    }
    const double slope = (n * sxy - sy * sx) / (n * syy - sy * sy), base = (sx - slope * sy) / n;
    double worst = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
        worst = std::max(worst, std::abs(x[i] - base - slope * double(i)));
    return worst;
}

TEST_P(Voronoi, BordersBetweenDepthsAreStraightForParaboloidsAndCurvedForConesAndSpheres) {
    // Two equal paraboloids differ by a linear function of the pixel, whatever their depths: their border is
    // a line. Equal radii in the world and orthographic projection make them exactly equal. Square root
    // profiles do not cancel.
    const Viewpoint view = lookAtOrthographic({0, -10, 0}, {0, 0, 0}, 200, 160, 16);
    std::vector<AnalyticPoint> points(2);
    points[0].position = {-1.5, 0, 0.3};
    points[0].rgb = numbered(1);
    points[1].position = {1.5, 1.5, -0.4};
    points[1].rgb = numbered(2);
    const AnalyticCloud cloud(points, 0.1);
    const auto bendOf = [&](Profile profile) {
        // Rows within both discs (50 px = 5 units across), around the middle.
        return bend(border(*device_, view, cloud, sprite(Footprint::Circle, profile, 50), 68, 92));
    };
    EXPECT_LE(bendOf(Profile::Paraboloid), 0.1);
    EXPECT_GT(bendOf(Profile::Cone), 0.3);
    EXPECT_GT(bendOf(Profile::Sphere), 0.3);
}

double changedPixels(Device& device, const AnalyticCloud& cloud, const NearestPass& pass) {
    const auto draw = [&](double degrees) {
        const double a = degrees * 3.14159265358979323846 / 180;
        // The viewer moves round the plane's middle: depths change order, places hardly change.
        const glm::dvec3 target{0, 5, 0};
        const Viewpoint view =
            lookAt(target - 5.0 * glm::dvec3(std::sin(a), std::cos(a), 0), target, 320, 240);
        Scene scene(view, cloud.cut(), pass);
        return mustDraw(device, scene.drawing);
    };
    const Frame left = draw(-0.05), right = draw(0.05);
    int changed = 0, covered = 0;
    for (int y = 40; y < 200; ++y) {
        for (int x = 60; x < 260; ++x) {
            ++covered;
            changed += pixel(left, x, y) != pixel(right, x, y) ? 1 : 0;
        }
    }
    return double(changed) / covered;
}

TEST_P(Voronoi, ParaboloidsDoNotFlickerWhereSquaresDo) {
    // A plane that turns by ±0.05° keeps its Voronoi cells to within a small part of a pixel, but its depth
    // order turns round completely: whatever shows another sample than before has flickered.
    const Viewpoint view = lookAt({0, 0, 0}, {0, 1, 0}, 320, 240);
    const AnalyticCloud cloud(facingPlane(view, 5, 6, 0.6), 0.1);
    EXPECT_LE(changedPixels(*device_, cloud, sprite(Footprint::Circle, Profile::Paraboloid, 16)), 0.02);
    EXPECT_GE(changedPixels(*device_, cloud, sprite(Footprint::Square, Profile::Flat, 16)), 0.80);
}

TEST_P(Voronoi, LargeSparseSplatsDoNotBreakThroughADenseSurface) {
    // A sparse layer 2 units behind a dense one must stay hidden, however large its splats.
    const Viewpoint view = lookAt({0, 0, 0}, {0, 1, 0}, 320, 240);
    std::vector<AnalyticPoint> front = facingPlane(view, 20, 2), back = facingPlane(view, 22, 30);
    for (AnalyticPoint& p : front) p.rgb = {255, 255, 255};
    for (AnalyticPoint& p : back) p.rgb = {255, 0, 0};
    const AnalyticCloud dense(front, 2 / view.q(20)), sparse(back, 30 / view.q(22));
    const Cut cut = dense.joined(sparse);
    for (const Profile profile : {Profile::Paraboloid, Profile::Cone, Profile::Sphere}) {
        Scene scene(view, cut, sprite(Footprint::Circle, profile, 0));
        const Frame frame = mustDraw(*device_, scene.drawing);
        int wrong = 0;
        for (int y = 0; y < frame.height; ++y) {
            for (int x = 0; x < frame.width; ++x)
                wrong += pixel(frame, x, y) != (Rgb8{255, 255, 255}) ? 1 : 0;
        }
        EXPECT_LE(wrong, 320 * 240 / 200) << int(profile);
    }
}

}  // namespace
}  // namespace scancast::test
