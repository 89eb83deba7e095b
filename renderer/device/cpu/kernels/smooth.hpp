// Borders between neighbouring paraboloids' cells, smoothed; docs/spec/sprites.md §9. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/normal_plane.hpp"

namespace scancast::cpu {
namespace {

/// The paraboloids that some pixels beside each other show. From each one's centre to a pixel: x, y.
struct ShownParaboloids {
    FloatW x, y, half, depth, rise;

    FloatW order() const { return depth + rise * (x * x + y * y); }
    /// Px beyond what the splat covers; negative inside.
    FloatW beyond(bool square) const {
        const FloatW out = square ? larger(absolute(x), absolute(y)) : squareRoot<wideLanes>(x * x + y * y);
        return out - half;
    }
};

/// `shown`: it is not the background, whose numbers mean nothing.
inline ShownParaboloids shownAt(const Smoothing& s, std::int64_t at, IntW& shown) {
    ShownParaboloids p;
    const IntW place = load<IntW>(s.owners.places + at);
    p.x = (toFloat(place & 0xffff) - placeMiddle) * placeStep;
    p.y = (toFloat((place >> 16) & 0xffff) - placeMiddle) * placeStep;
    const FloatW order = load<FloatW>(s.owners.orders + at);
    shown = order < __builtin_inff();
    p.half = shown ? load<FloatW>(s.owners.halves + at) : all(1.0f);
    // The centre's own pixel has the centre's depth.
    const IntW centre = (p.x > -0.5f) & (p.x <= 0.5f) & (p.y > -0.5f) & (p.y <= 0.5f);
    const FloatW perPx2 = s.bulge / p.half, distance2 = p.x * p.x + p.y * p.y;
    const FloatW seen = shown ? order : all(1.0f);
    if (s.perspective) {
        p.depth = centre ? seen : seen / (1.0f + perPx2 * distance2);
        p.rise = perPx2 * p.depth;
    } else {
        p.depth = centre ? seen : seen - perPx2 * distance2;
        p.rise = perPx2;
    }
    return p;
}

/// The same cell, as seen from the same pixel: centres in one place. Or two without a border between them.
inline IntW sameCell(const ShownParaboloids& a, const ShownParaboloids& b) {
    return (a.half == b.half) & (absolute(a.x - b.x) <= placeStep) & (absolute(a.y - b.y) <= placeStep);
}

/// How far a pixel's centre, which shows `own`, lies from where `other` begins, which its neighbour `dx` to the right and `dy`
/// below shows; px. Both are seen from the pixel.
inline FloatW distanceToBorder(const Smoothing& s, const ShownParaboloids& own, const ShownParaboloids& other,
                               float dx, float dy) {
    const FloatW unit = 1.0f / larger(own.rise + other.rise, all(leastRise));
    const FloatW a = own.rise * unit, b = other.rise * unit;
    const FloatW gx = b * other.x - a * own.x, gy = b * other.y - a * own.y;
    const FloatW slope = 2.0f * squareRoot<wideLanes>(gx * gx + gy * gy);
    const FloatW between = ((other.order() - own.order()) * unit) / larger(slope, all(leastSlope));
    // What is behind begins where the nearer one ends, if that is on the neighbour's side.
    const FloatW along = dx * own.x + dy * own.y;
    const IntW side = (along > 0.0f) & (2.0f * (along * along) >= own.x * own.x + own.y * own.y);
    const FloatW end = side ? -own.beyond(s.square) : all(__builtin_inff());
    return larger(other.beyond(s.square), smaller(between, end));
}

inline IntW blended(IntW own, IntW other, FloatW share) {
    IntW out = own & static_cast<std::int32_t>(0xff000000u);
    for (int shift = 0; shift < 24; shift += 8) {
        const FloatW a = toFloat((own >> shift) & 255), b = toFloat((other >> shift) & 255);
        out |= toInt((a + (b - a) * share) + 0.5f) << shift;
    }
    return out;
}

/// Some pixels beside each other, from `at` on in the planes.
inline void smoothPixels(const Smoothing& s, std::int64_t at, std::uint32_t* rgba, int lanes) {
    constexpr int dx[] = {1, -1, 0, 0}, dy[] = {0, 0, 1, -1};
    IntW shown, othersShown;
    const ShownParaboloids own = shownAt(s, at, shown);
    if (!anyOf<wideLanes>(shown)) return;
    const IntW ownColor = load<IntW>(s.owners.colors + at);
    IntW color = ownColor;
    FloatW nearest = all(0.5f);
    for (int k = 0; k < 4; ++k) {
        const std::int64_t there = at + static_cast<std::int64_t>(dy[k]) * s.owners.stride + dx[k];
        ShownParaboloids other = shownAt(s, there, othersShown);
        other.x -= static_cast<float>(dx[k]);
        other.y -= static_cast<float>(dy[k]);
        const IntW border = shown & othersShown & ~sameCell(own, other);
        if (!anyOf<wideLanes>(border)) continue;
        const FloatW distance =
            distanceToBorder(s, own, other, static_cast<float>(dx[k]), static_cast<float>(dy[k]));
        const IntW nearer = border & (distance < nearest);
        nearest = nearer ? larger(distance, all(0.0f)) : nearest;
        color = nearer ? load<IntW>(s.owners.colors + there) : color;
    }
    if (anyOf<wideLanes>(nearest < 0.5f)) storeSome(rgba, blended(ownColor, color, 0.5f - nearest), lanes);
}

void smooth(const Smoothing& s) {
    for (int y = 0; y < s.height; ++y) {
        const std::int64_t row = static_cast<std::int64_t>(y) * s.owners.stride;
        std::uint32_t* const out = s.rgba + static_cast<std::int64_t>(y) * s.stride;
        for (int x = 0; x < s.width; x += wideLanes)
            smoothPixels(s, row + x, out + x, s.width - x < wideLanes ? s.width - x : wideLanes);
    }
}

}  // namespace
}  // namespace scancast::cpu
