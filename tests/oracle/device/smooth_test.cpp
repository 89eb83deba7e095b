// Borders between paraboloids' cells, smoothed: docs/spec/sprites.md §9. What is expected is worked out in double, of points
// whose places are known: along one border analytically, and in a crowd by walking around each pixel until another cell
// is met.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"
#include "tests/support/pictures/reference_renderer.hpp"

namespace scancast::test {
namespace {

class SmoothBorders : public OnDevice {};
SCANCAST_ON_DEVICES(SmoothBorders, "egl");

/// One nearest pass whose borders are smoothed, or the same without.
struct SmoothScene : Scene {
    SmoothScene(const Viewpoint& view, const Cut& cut, NearestPass pass, bool smooth)
        : Scene(view, cut, asked(pass, smooth)) {
        std::get<ResolvePass>(passes[1]).smooth = smooth;
        drawing.passes = passes;
    }

  private:
    static NearestPass asked(NearestPass pass, bool smooth) {
        pass.payload = smooth ? Payload::Sample : Payload::Color;
        return pass;
    }
};

/// A sample as it is seen, by its ordinal.
struct SeenSplat {
    double x, y, depth, half, rise;
    Rgb8 color;
    double order(double px, double py) const {
        return depth + rise * ((px - x) * (px - x) + (py - y) * (py - y));
    }
    double beyond(double px, double py, bool square) const {
        const double out = square ? std::max(std::abs(px - x), std::abs(py - y)) : std::hypot(px - x, py - y);
        return out - half;
    }
};

std::vector<SeenSplat> seenSplats(const Drawing& drawing, const NearestPass& pass) {
    const Viewpoint& v = drawing.mainView().viewpoint;
    std::vector<SeenSplat> all;
    for (const CutRun& run : drawing.mainView().cut.runs) {
        all.resize(std::max<std::size_t>(all.size(), run.firstOrdinal + run.samples.size()));
        for (std::size_t i = 0; i < run.samples.size(); ++i) {
            const Sample& sample = run.samples[i];
            const glm::dvec4 eye = v.cloudToView * glm::dvec4(position(*run.node, sample), 1);
            SeenSplat& s = all[run.firstOrdinal + i];
            s.depth = -eye.z;
            const double q = v.q(s.depth);
            s.x = v.width / 2.0 + drawing.jitter[0].x + q * eye.x;
            s.y = v.height / 2.0 + drawing.jitter[0].y - q * eye.y;
            s.half =
                0.5 * (pass.size.sizePx > 0 ? double(pass.size.sizePx)
                                            : std::clamp(2 * run.node->spacing * pass.size.scale * q,
                                                         double(pass.size.minPx), double(pass.size.maxPx)));
            s.rise = pass.gain * (s.half / q) / (s.half * s.half);
            s.color = {sample.r, sample.g, sample.b};
        }
    }
    return all;
}

Rgb8 mixed(Rgb8 own, Rgb8 other, double share) {
    Rgb8 out;
    for (std::size_t c = 0; c < 3; ++c)
        out[c] = static_cast<std::uint8_t>(std::lround(own[c] + (double(other[c]) - own[c]) * share));
    return out;
}

int difference(Rgb8 a, Rgb8 b) {
    int most = 0;
    for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(int(a[c]) - int(b[c])));
    return most;
}

constexpr Rgb8 red{250, 20, 90}, blue{10, 180, 240};

/// What two points share, seen from -y: pixels that lie well inside what both cover, and the distance of each to the border.
/// `border(first, second, x, y)`: signed distance of a place to it, positive on the first one's side.
template <class Border>
void expectOneBorder(Device& device, const Viewpoint& view, std::span<const AnalyticPoint> points,
                     const glm::dvec2& shift, const Border& border, int& blended, int& kept) {
    const AnalyticCloud cloud(points, 0.1);
    const NearestPass pass = sprite(Footprint::Circle, Profile::Paraboloid, 24);
    SmoothScene scene(view, cloud.cut(), pass, true);
    scene.drawing.jitter = {&shift, 1};
    const std::vector<SeenSplat> seen = seenSplats(scene.drawing, pass);
    const Frame frame = mustDraw(device, scene.drawing);
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            const double px = x + 0.5, py = y + 0.5, margin = 1.5;
            if (seen[0].beyond(px, py, false) > -margin || seen[1].beyond(px, py, false) > -margin) continue;
            const double distance = border(seen[0], seen[1], px, py);
            const bool first = distance > 0;
            const Rgb8 own = seen[first ? 0 : 1].color, other = seen[first ? 1 : 0].color;
            // On the very border rounding decides whose it is, and it is half of each.
            const double share = std::max(0.0, 0.5 - std::abs(distance));
            EXPECT_LE(difference(pixel(frame, x, y), mixed(own, other, share)), 2)
                << x << ' ' << y << ", " << distance << " px from the border";
            if (share > 0) ++blended;
            if (std::abs(distance) < 0.51) continue;
            EXPECT_EQ(pixel(frame, x, y), own) << "the border is not in this pixel";
            ++kept;
        }
    }
}

// Right because two equal paraboloids at one depth meet where both centres are as far, and what a pixel shows of each is what
// of one pixel's width across the border lies on its side.
TEST_P(SmoothBorders, OfTwoPointsAtOneDepthAreSharedByTheirDistance) {
    int blended = 0, kept = 0;
    for (const bool perspective : {false, true}) {
        const Viewpoint view = perspective ? lookAt({0, -10, 0}, {0, 0, 0}, 64, 64)
                                           : lookAtOrthographic({0, -10, 0}, {0, 0, 0}, 64, 64, 6.4);
        for (int direction = 0; direction < 8; ++direction) {
            const double angle = 0.13 + direction * 3.14159265358979323846 / 4;
            const glm::dvec3 half{0.5 * std::cos(angle), 0, 0.5 * std::sin(angle)};
            const AnalyticPoint points[] = {{-half, red}, {half, blue}};
            const auto border = [](const SeenSplat& a, const SeenSplat& b, double x, double y) {
                const glm::dvec2 normal = glm::dvec2(a.x - b.x, a.y - b.y) / std::hypot(a.x - b.x, a.y - b.y);
                return normal.x * (x - 0.5 * (a.x + b.x)) + normal.y * (y - 0.5 * (a.y + b.y));
            };
            for (const glm::dvec2& shift : {glm::dvec2{0, 0}, {0.3, 0.1}, {-0.45, 0.2}, {0.17, -0.38}})
                expectOneBorder(*device_, view, points, shift, border, blended, kept);
        }
    }
    EXPECT_GT(blended, 500);
    EXPECT_GT(kept, 1000);
}

// Right because the orders of equal paraboloids differ by a linear function of the pixel, also where their depths differ.
TEST_P(SmoothBorders, BetweenDepthsLieWhereOrdersAreEqual) {
    const Viewpoint view = lookAtOrthographic({0, -10, 0}, {0, 0, 0}, 64, 64, 6.4);
    int blended = 0, kept = 0;
    for (const double behind : {0.1, 0.3, -0.4}) {
        const AnalyticPoint points[] = {{{-0.4, 0, -0.2}, red}, {{0.4, behind, 0.25}, blue}};
        const auto border = [](const SeenSplat& a, const SeenSplat& b, double x, double y) {
            return (b.order(x, y) - a.order(x, y)) / (2 * a.rise * std::hypot(a.x - b.x, a.y - b.y));
        };
        expectOneBorder(*device_, view, points, {0, 0}, border, blended, kept);
    }
    EXPECT_GT(blended, 15);
    EXPECT_GT(kept, 100);
}

// Right because of a circle far in front of another one nothing lies behind that: its own rim is the border.
TEST_P(SmoothBorders, OfWhatIsFarInFrontAreItsRim) {
    const Viewpoint view = lookAtOrthographic({0, -50, 0}, {0, 0, 0}, 96, 96, 9.6);
    int blended = 0, kept = 0;
    for (const double shift : {0.0, 0.013, 0.031, 0.057}) {
        const AnalyticPoint points[] = {{{shift, -30, 0.4 * shift}, red}, {{1.1, 0, 0.2}, blue}};
        const AnalyticCloud cloud(points, 0.1);
        const NearestPass pass = sprite(Footprint::Circle, Profile::Paraboloid, 40);
        const SmoothScene scene(view, cloud.cut(), pass, true), hard(view, cloud.cut(), pass, false);
        const std::vector<SeenSplat> seen = seenSplats(scene.drawing, pass);
        const Frame frame = mustDraw(*device_, scene.drawing), plain = mustDraw(*device_, hard.drawing);
        for (int y = 1; y < frame.height - 1; ++y) {
            for (int x = 1; x < frame.width - 1; ++x) {
                const double px = x + 0.5, py = y + 0.5;
                // Where the far one ends, too, or begins the background, other borders are near.
                if (seen[1].beyond(px, py, false) > -2.5) continue;
                const double distance = -seen[0].beyond(px, py, false);
                const bool first = distance >= 0;
                const double share = std::max(0.0, 0.5 - std::abs(distance));
                const Rgb8 expected = mixed(first ? red : blue, first ? blue : red, share);
                EXPECT_LE(difference(pixel(frame, x, y), expected), 2)
                    << x << ' ' << y << ", " << distance << " px inside the rim";
                share > 0 ? ++blended : ++kept;
            }
        }
        EXPECT_EQ(0, std::memcmp(frame.depth.data(), plain.depth.data(), frame.depth.size() * 4));
    }
    EXPECT_GT(blended, 100);
    EXPECT_GT(kept, 500);
}

/// How far the middle of a pixel that shows `own` lies from where `other` is in front or alone, found by looking around; 1 where it
/// is not near.
double walkToCell(const SeenSplat& own, const SeenSplat& other, double px, double py, bool square) {
    constexpr double step = 1.0 / 40;
    constexpr int directions = 36;
    for (double radius = 0; radius <= 0.55; radius += step) {
        for (int i = 0; i < directions; ++i) {
            const double angle = i * 6.28318530717958647692 / directions;
            const double x = px + radius * std::cos(angle), y = py + radius * std::sin(angle);
            if (other.beyond(x, y, square) > 0) continue;
            if (own.beyond(x, y, square) > 0 || other.order(x, y) < own.order(x, y)) return radius;
        }
    }
    return 1;
}

/// Share of the pixels that are what walking says. Which of several neighbours is met first, or whether the nearest place
/// of a cell is hidden by a third one, may be a matter of a hair: then any that is nearly as near will do.
double agreementOfWalks(Device& device, const Viewpoint& view, const Cut& cut, const NearestPass& pass,
                        double& changed) {
    const bool square = pass.footprint == Footprint::Square;
    const SmoothScene scene(view, cut, pass, true);
    const ReferencePicture owners = referenceNearest(scene.drawing);
    const std::vector<SeenSplat> seen = seenSplats(scene.drawing, pass);
    const Frame frame = mustDraw(device, scene.drawing);
    std::size_t right = 0, all = 0, blended = 0;
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            const ReferenceFragment& here = owners.at(x, y);
            if (std::isinf(here.order)) {
                EXPECT_EQ(pixel(frame, x, y), Rgb8{}) << "the background stays";
                continue;
            }
            const SeenSplat& own = seen[here.sample];
            // The pixel that holds a centre shows it even where others are in front.
            if (own.beyond(x + 0.5, y + 0.5, square) > 0) continue;
            ++all;
            const Rgb8 is = pixel(frame, x, y);
            double nearest = 0.5;
            std::vector<std::pair<double, Rgb8>> met;
            for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
                const bool inside =
                    x + dx >= 0 && x + dx < frame.width && y + dy >= 0 && y + dy < frame.height;
                if (!inside || std::isinf(owners.at(x + dx, y + dy).order)) continue;
                const std::uint64_t sample = owners.at(x + dx, y + dy).sample;
                if (sample == here.sample) continue;
                const double distance = walkToCell(own, seen[sample], x + 0.5, y + 0.5, square);
                met.emplace_back(distance, seen[sample].color);
                nearest = std::min(nearest, distance);
            }
            if (nearest == 0.5) met.emplace_back(0.5, own.color);
            blended += nearest < 0.5;
            right += std::ranges::any_of(met, [&](const auto& m) {
                const double share = std::max(0.0, 0.5 - m.first);
                return m.first <= nearest + 0.05 && difference(is, mixed(own.color, m.second, share)) <= 12;
            });
        }
    }
    changed = double(blended) / double(all);
    return double(right) / double(all);
}

TEST_P(SmoothBorders, OfACrowdAreWhereWalkingFindsThem) {
    Numbers numbers(41);
    std::vector<AnalyticPoint> points(2500);
    for (AnalyticPoint& p : points) {
        // A thick wall: neighbours beside and behind each other.
        p.position = {numbers.uniform(-2, 2), numbers.uniform(0, 0.25), numbers.uniform(-1.5, 1.5)};
        p.rgb = numbers.color();
    }
    const AnalyticCloud cloud(points, 0.09, 300);
    const Viewpoint views[] = {lookAt({0.2, -2.5, 0.1}, {0, 0, 0}, 161, 121),
                               lookAtOrthographic({0.2, -2.5, 0.1}, {0, 0, 0}, 161, 121, 2.9)};
    for (const Viewpoint& view : views) {
        for (const Footprint footprint : {Footprint::Circle, Footprint::Square}) {
            NearestPass pass = sprite(footprint, Profile::Paraboloid, 0);
            pass.size.maxPx = 14;
            double changed = 0;
            const double share = agreementOfWalks(*device_, view, cloud.cut(), pass, changed);
            EXPECT_GE(share, 0.985) << (footprint == Footprint::Square ? "squares" : "circles");
            EXPECT_GE(changed, 0.2) << "where nothing is blended nothing is proved";
        }
    }
}

}  // namespace
}  // namespace scancast::test
