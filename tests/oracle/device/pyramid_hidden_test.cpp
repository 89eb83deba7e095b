// Hidden point removal against scenes whose hidden points are known (docs/spec/pyramid.md §4): two sheets, a
// window, a wide range of depths. Points carry the surface that they come from, and geometry says which of
// them can be seen.
#include <gtest/gtest.h>

#include <functional>

#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/point_passes.hpp"
#include "tests/support/pictures/pyramid_reference.hpp"

namespace scancast::test {
namespace {

class HiddenPoints : public OnPointPasses {};
SCANCAST_ON_DEVICES(HiddenPoints, "egl");

struct HiddenSetting {
    int width, height;
    bool perspective;
    double spacingPx, noise;  ///< noise in spacings
};

std::vector<HiddenSetting> hiddenSettings(bool small) {
    std::vector<HiddenSetting> all;
    for (const auto& [width, height] : {std::pair{640, 480}, {1248, 768}, {401, 333}}) {
        if (small && width > 401) continue;
        for (const bool perspective : {true, false}) {
            for (const double spacing : {2.0, 3.0, 5.0, 8.0}) {
                for (const double noise : {0.0, 0.3}) {
                    all.push_back({width, height, perspective, spacing, noise});
                }
            }
        }
    }
    return all;
}

std::string nameOf(const HiddenSetting& s) {
    return std::to_string(s.width) + " x " + std::to_string(s.height) + ", every " +
           std::to_string(s.spacingPx) + " px, noise " + std::to_string(s.noise) + " spacings, " +
           (s.perspective ? "perspective" : "orthographic");
}

constexpr double depth = 10;
constexpr int guardBand = 32;
constexpr int front = 0, rear = 1;

/// In perspective about 60° high.
PointScreen screenFor(const HiddenSetting& s) {
    return {s.width, s.height, s.perspective, s.perspective ? 0.87 * s.height : 0.1 * s.height};
}

double spacingOf(const HiddenSetting& s, const PointScreen& screen) {
    return s.spacingPx * (s.perspective ? depth : 1) / screen.pixelsPerUnit;
}

HiddenPointsPass hiding(double spacing) {
    HiddenPointsPass pass;
    pass.spacing = static_cast<float>(spacing);
    pass.detail = 0;
    pass.minGap = static_cast<float>(3 * spacing);
    return pass;
}

/// A front sheet, as far as `keep` wants it, and a rear one of which no point is less than six spacings
/// behind it, both wider than the picture and displaced at random.
PointScreen twoSheets(const HiddenSetting& s, std::uint64_t seed,
                      const std::function<bool(const ScreenPoint&)>& keep) {
    PointScreen screen = screenFor(s);
    const double spacing = spacingOf(s, screen), gap = (6 + 2 * s.noise) * spacing;
    const double halfHeight = 0.6 * s.height * spacing / s.spacingPx, scale = (depth + gap) / depth;
    const double halfWidth = halfHeight * s.width / s.height;
    Numbers numbers(seed);
    const double x = numbers.uniform() * spacing, y = numbers.uniform() * spacing;
    const auto displaced = [&](int of, auto wanted) {
        // Rear points stand between the front ones, else these would cover them already.
        const double apart = of == rear ? 0.5 * spacing : 0;
        const double dx = x + apart, dy = y + apart;
        return [&screen, dx, dy, of, wanted](ScreenPoint p) {
            p.x += dx;
            p.y += dy;
            if (wanted(p)) screen.add(p, of);
        };
    };
    sheet(depth, halfWidth, halfHeight, spacing, s.noise * spacing, numbers, displaced(front, keep));
    sheet(depth + gap, halfWidth * scale, halfHeight * scale, spacing, s.noise * spacing, numbers,
          displaced(rear, [](const ScreenPoint&) { return true; }));
    return screen;
}

/// Calls work(index, x, y) for the pixels inside the guard band.
template <class Work>
void insideGuardBand(const PointScreen& s, const Work& work) {
    for (int y = guardBand; y < s.height - guardBand; ++y) {
        for (int x = guardBand; x < s.width - guardBand; ++x) work(s.at(x, y), x, y);
    }
}

struct Share {
    double part = 0, whole = 0;
    void count(bool yes) {
        part += yes ? 1 : 0;
        ++whole;
    }
    double value() const { return whole > 0 ? part / whole : 0; }
};

TEST_P(HiddenPoints, OfTheRearOfTwoSheetsGoAndTheFrontStays) {
    // All of the rear sheet is covered by the front one, none of the front one by anything.
    for (const HiddenSetting& setting : hiddenSettings(slow_)) {
        Share removed, lost, closed;
        // About as many points of small pictures as of large ones.
        for (std::uint64_t seed = 0; seed < (slow_ ? 140'000u : 1'000'000u) /
                                                (static_cast<std::uint64_t>(setting.width) * setting.height);
             ++seed) {
            PointScreen s = twoSheets(setting, seed, [](const ScreenPoint&) { return true; });
            passes_->hidePoints(s, hiding(spacingOf(setting, s)));
            insideGuardBand(s, [&](std::size_t i, int, int) {
                const bool hidden = s.labels[i] == hiddenLabel;
                if (s.surface[i] == rear) removed.count(hidden);
                if (s.surface[i] == front) lost.count(hidden);
                if (s.surface[i] < 0) closed.count(hidden);
            });
        }
        EXPECT_GE(removed.value(), 0.99) << nameOf(setting);
        EXPECT_GT(removed.whole, 1000) << nameOf(setting);
        EXPECT_LE(lost.value(), 0.01) << nameOf(setting);
        EXPECT_GE(closed.value(), 0.99) << nameOf(setting);
    }
}

TEST_P(HiddenPoints, KeepAWindowOpen) {
    // What lies behind an opening of radius 1.5 · hprScale · s0 is seen through it; the wall around hides the
    // rest.
    for (const HiddenSetting& setting : hiddenSettings(slow_)) {
        const PointScreen size = screenFor(setting);
        const double spacing = spacingOf(setting, size), radius = 15 * spacing;
        const double radiusPx = radius / spacing * setting.spacingPx;
        if (radiusPx > 0.4 * setting.height) continue;
        PointScreen s =
            twoSheets(setting, 5, [&](const ScreenPoint& p) { return std::hypot(p.x, p.y) > radius; });
        passes_->hidePoints(s, hiding(spacing));
        Share closed, removed;
        insideGuardBand(s, [&](std::size_t i, int x, int y) {
            const double r = std::hypot(x + 0.5 - s.width / 2.0, y + 0.5 - s.height / 2.0) / radiusPx;
            const bool hidden = s.labels[i] == hiddenLabel;
            // At the rim itself some sectors see the wall on both sides.
            if (r < 0.9 && s.surface[i] == rear) closed.count(hidden);
            if (r > 1.4 && s.surface[i] == rear) removed.count(hidden);
        });
        EXPECT_LE(closed.value(), 0.01) << nameOf(setting);
        EXPECT_GT(closed.whole, 100) << nameOf(setting);
        EXPECT_GE(removed.value(), 0.98) << nameOf(setting);
        EXPECT_GT(removed.whole, 100) << nameOf(setting);
    }
}

/// A table top and its underside, `gap` spacings apart, with points every `step` spacings, each off its place by up to
/// `noise` spacings: how many of the underside's points go, and how many of the top's.
struct TableTop {
    Share removed, lost;
};

TableTop tableTop(PointPasses& passes, bool perspective, double spacingPx, double step, double gap,
                  double noise, double minGap) {
    PointScreen s = screenFor({401, 333, perspective, spacingPx, noise});
    const double spacing = spacingOf({401, 333, perspective, spacingPx, noise}, s);
    Numbers numbers(4);
    const double half = 0.7 * s.width * spacing / spacingPx;
    sheet(depth, half, half, step * spacing, noise * spacing, numbers,
          [&](const ScreenPoint& p) { s.add(p, front); });
    sheet(depth + gap * spacing, half, half, spacing, noise * spacing, numbers, [&](ScreenPoint p) {
        p.x += 0.5 * step * spacing;
        p.y += 0.5 * step * spacing;
        s.add(p, rear);
    });
    HiddenPointsPass pass = hiding(spacing);
    pass.minGap = static_cast<float>(minGap * spacing);
    passes.hidePoints(s, pass);
    TableTop out;
    insideGuardBand(s, [&](std::size_t i, int, int) {
        if (s.surface[i] == rear) out.removed.count(s.labels[i] == hiddenLabel);
        if (s.surface[i] == front) out.lost.count(s.labels[i] == hiddenLabel);
    });
    return out;
}

TEST_P(HiddenPoints, OfTheUndersideOfATableGoWhereTheScanIsClean) {
    // Where a scan is twice as dense as on the whole, nearly three spacings below: dark dots, as long as less than
    // three spacings counted as the same surface.
    for (const bool perspective : {true, false}) {
        for (const double spacingPx : {3.0, 5.0, 8.0}) {
            for (const double noise : {0.0, 0.05}) {
                const TableTop table = tableTop(*passes_, perspective, spacingPx, 0.5, 2.9, noise, 3 * noise);
                EXPECT_GE(table.removed.value(), 0.99) << spacingPx << ", " << noise << ", " << perspective;
                EXPECT_GT(table.removed.whole, 500);
                EXPECT_LE(table.lost.value(), 0.01) << spacingPx << ", " << noise << ", " << perspective;
            }
        }
    }
}

TEST_P(HiddenPoints, OfANoisyFrontStayWhereTheNoiseIsKnown) {
    // Off by up to half a spacing on every axis.
    for (const bool perspective : {true, false}) {
        for (const double spacingPx : {2.0, 3.0, 5.0, 8.0}) {
            const TableTop known = tableTop(*passes_, perspective, spacingPx, 1, 8, 0.5, 3 * 0.29);
            EXPECT_LE(known.lost.value(), 0.01) << spacingPx << ", " << perspective;
            EXPECT_GE(known.removed.value(), 0.99) << spacingPx << ", " << perspective;
        }
    }
}

/// Labels as colours are the paper's criterion (Bouchiba, Deschaud and Goulette, "Raw point cloud deferred shading through
/// screen space pyramidal operators", 2018, §3.1.2) asked of every pixel, one neighbour after another and in double.
TEST_P(HiddenPoints, AreShownAsTheCriterionFindsThem) {
    for (const bool perspective : {true, false}) {
        const HiddenSetting setting{401, 333, perspective, 3, 0.3};
        PointScreen s =
            twoSheets(setting, 3, [](const ScreenPoint& p) { return std::hypot(p.x, p.y) > 1.5; });
        HiddenPointsPass pass = hiding(spacingOf(setting, s));
        const ReferenceHidden expected = referenceHidden(s, pass);
        const VisibilityPass colors;
        passes_->hidePoints(s, pass);
        passes_->showLabels(s, colors);
        const auto opaque = [](const VisibilityPass::Rgb& c) {
            return 0xff000000u | std::uint32_t{c[2]} << 16 | std::uint32_t{c[1]} << 8 | c[0];
        };
        std::size_t seen[4] = {}, unsure = 0;
        for (std::size_t i = 0; i < s.labels.size(); ++i) {
            if (std::abs(expected.occlusion[i] - double(pass.threshold)) < 1e-5) {
                ++unsure;
                continue;
            }
            const bool point = s.surface[i] >= 0, hidden = expected.labels[i] == hiddenLabel;
            const std::uint32_t colorOf[2][2] = {{PointScreen::background, opaque(colors.hole)},
                                                 {opaque(colors.foreground), opaque(colors.hidden)}};
            ASSERT_EQ(s.rgba[i], colorOf[point][hidden]) << i;
            ++seen[2 * (point ? 1 : 0) + (hidden ? 1 : 0)];
        }
        EXPECT_LT(unsure, 100u);
        EXPECT_GT(seen[1], 10000u) << "holes";
        EXPECT_GT(seen[2], 5000u) << "visible";
        EXPECT_GT(seen[3], 5000u) << "hidden";
    }
}

TEST_P(HiddenPoints, AreTheSameInAFixedNeighbourhoodWhereAllIsEquallyFar) {
    // Where every block's depth asks for the same level, saying that level asks for the same.
    for (const HiddenSetting& setting : hiddenSettings(true)) {
        if (setting.noise > 0) continue;
        PointScreen s = twoSheets(setting, 2, [](const ScreenPoint&) { return true; });
        HiddenPointsPass pass = hiding(spacingOf(setting, s));
        // Away from a power of two, where rounding would decide.
        pass.scale = 5.5f;
        passes_->hidePoints(s, pass);
        const std::vector<std::uint8_t> adaptive = s.labels;
        pass.fixedPx = static_cast<float>(5.5 * setting.spacingPx);
        passes_->hidePoints(s, pass);
        EXPECT_EQ(s.labels, adaptive) << nameOf(setting);
    }
}

TEST_P(HiddenPoints, AreFoundNearAndFarByNoFixedNeighbourhood) {
    // One wall, near and far away: with points every 32 px, and what it hides must go; with points every 2 px and a
    // window of 15 s0, through which one sees ten times as far (Bouchiba, Deschaud and Goulette, "Raw point cloud deferred
    // shading through screen space pyramidal operators", 2018, §3.1.2, Fig. 4). A fixed size is too small for the
    // one or too large for the other.
    const HiddenSetting near{640, 480, true, 32, 0}, far{640, 480, true, 2, 0};
    const auto removedNear = [&](float px) {
        PointScreen s = twoSheets(near, 5, [](const ScreenPoint&) { return true; });
        HiddenPointsPass pass = hiding(spacingOf(near, s));
        pass.fixedPx = px;
        passes_->hidePoints(s, pass);
        Share removed;
        insideGuardBand(s, [&](std::size_t i, int, int) {
            if (s.surface[i] == rear) removed.count(s.labels[i] == hiddenLabel);
        });
        return removed.value();
    };
    const auto closedFar = [&](float px) {
        const double spacing = spacingOf(far, screenFor(far));
        PointScreen s = screenFor(far);
        Numbers numbers(5);
        sheet(depth, 8, 6, spacing, 0, numbers, [&](const ScreenPoint& p) {
            if (std::hypot(p.x, p.y) > 15 * spacing) s.add(p, front);
        });
        sheet(10 * depth, 80, 60, 10 * spacing, 0, numbers, [&](const ScreenPoint& p) { s.add(p, rear); });
        HiddenPointsPass pass = hiding(spacing);
        pass.fixedPx = px;
        passes_->hidePoints(s, pass);
        Share closed;
        insideGuardBand(s, [&](std::size_t i, int x, int y) {
            const double r = std::hypot(x + 0.5 - s.width / 2.0, y + 0.5 - s.height / 2.0) / 30;
            if (r < 0.9 && s.surface[i] == rear) closed.count(s.labels[i] == hiddenLabel);
        });
        return closed.value();
    };
    EXPECT_GE(removedNear(0), 0.99);
    EXPECT_LE(closedFar(0), 0.01);
    for (const float px : {4.0f, 8.0f, 16.0f, 32.0f, 64.0f, 128.0f, 256.0f}) {
        const double removed = removedNear(px), closed = closedFar(px);
        EXPECT_TRUE(removed < 0.9 || closed > 0.9)
            << px << " px: " << removed << " removed near by, " << closed << " closed far away";
    }
}

/// Under the bridge (Bouchiba, Deschaud and Goulette, "Raw point cloud deferred shading through screen space
/// pyramidal operators", 2018, §3.1.2, Fig. 4): through openings near by one sees things up to a hundred
/// times as far.
TEST_P(HiddenPoints, KeepWhatIsSeenOverDepthsOfOneToAHundred) {
    for (const auto& [width, height] : {std::pair{640, 480}, {1248, 768}}) {
        if (slow_ && width > 640) continue;
        for (const double spacingPx : {2.0, 4.0}) {
            PointScreen s(width, height, true, 0.87 * height);
            const double near = 2, far = 200, spacing = spacingPx * near / s.pixelsPerUnit;
            Numbers numbers(82);
            // A wall with openings at depth 2, one without at 200, and the ground 1.2 below the eye, all
            // equally dense on screen.
            const auto jittered = [&](double v) { return v + numbers.uniform(-0.4, 0.4) * spacingPx; };
            const auto fillWith = [&](int surface, const std::function<double(double, double)>& depthAt) {
                for (double py = 0; py < height; py += spacingPx) {
                    for (double px = 0; px < width; px += spacingPx) {
                        const double x = jittered(px), y = jittered(py);
                        const double u = (x - width / 2.0) / s.pixelsPerUnit;
                        const double v = (height / 2.0 - y) / s.pixelsPerUnit;
                        const double d = depthAt(u, v);
                        if (d > 0) s.add({u * d, v * d, d}, surface);
                    }
                }
            };
            const auto opening = [&](double u, double v) {
                return std::abs(std::remainder(u, 0.3)) < 0.09 && std::abs(v) < 0.3;
            };
            const auto wall = [&](double u, double v) { return opening(u, v) ? -1.0 : near; };
            const auto ground = [&](double, double v) { return v < 0 && 1.2 / -v < far ? 1.2 / -v : -1.0; };
            fillWith(0, wall);
            fillWith(1, ground);
            fillWith(2, [&](double, double v) { return v > -1.2 / far ? far : -1.0; });
            passes_->hidePoints(s, hiding(spacing));
            Share kept, removed;
            insideGuardBand(s, [&](std::size_t i, int x, int y) {
                if (s.surface[i] < 0) return;
                // What a ray would hit first: a wall or the ground, whichever is nearest.
                const ScreenPoint ray = s.through(x, y);
                double nearest = wall(ray.x, ray.y) > 0 ? near : far;
                if (const double g = ground(ray.x, ray.y); g > 0) nearest = std::min(nearest, g);
                const bool onSurface = s.depth[i] < 1.02 * nearest + spacing;
                const bool hidden = s.labels[i] == hiddenLabel;
                if (onSurface)
                    kept.count(!hidden);
                else
                    removed.count(hidden);
            });
            EXPECT_GE(kept.value(), 0.99) << width << " x " << height << ", every " << spacingPx << " px";
            EXPECT_GT(kept.whole, 1000);
            // Most of what shines through goes; without that, keeping all would be easy.
            EXPECT_GE(removed.value(), 0.85) << width << " x " << height << ", every " << spacingPx << " px";
            EXPECT_GT(removed.whole, 1000);
        }
    }
}

}  // namespace
}  // namespace scancast::test
