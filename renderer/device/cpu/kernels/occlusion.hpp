// Ambient occlusion from depth alone; docs/spec/shading.md §9. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/screen.hpp"

namespace scancast::cpu {
namespace {

/// What is nearer is larger, and linear over a plane: 1/depth, or -depth in an orthographic picture; -infinity of the
/// background.
void nearness(const float* depth, bool perspective, float* out, int count) {
    for (int x = 0; x < count; x += wideLanes) {
        const int lanes = count - x < wideLanes ? count - x : wideLanes;
        const FloatW d = loadSome<FloatW>(depth + x, lanes);
        const IntW background = d > 3.4e38f;
        const FloatW near = perspective ? 1.0f / (background ? all(1.0f) : d) : -d;
        storeSome(out + x, background ? all(-__builtin_inff()) : near, lanes);
    }
}

/// How steeply two opposite neighbours rise above the plane through a pixel, the mean of both; less where one of them
/// stands far in front of it.
inline FloatW hollow(const float* a, const float* b, FloatW own, FloatW slope, int lanes) {
    const FloatW nearA = loadSome<FloatW>(a, lanes), nearB = loadSome<FloatW>(b, lanes);
    const IntW knownA = nearA > -3.4e38f, knownB = nearB > -3.4e38f;
    const FloatW riseA = knownA ? (nearA - own) * slope : all(0.0f);
    const FloatW riseB = knownB ? (nearB - own) * slope : all(0.0f);
    // Of the background nothing is known: the surface goes on there.
    const FloatW sideA = knownA ? riseA : -riseB, sideB = knownB ? riseB : -riseA;
    const FloatW beyondA = smaller(larger((sideA - occlusionFull) * occlusionFall, all(0.0f)), all(1.0f));
    const FloatW beyondB = smaller(larger((sideB - occlusionFull) * occlusionFall, all(0.0f)), all(1.0f));
    const FloatW mean = 0.5f * (sideA + sideB) * (1.0f - beyondA - beyondB);
    return smaller(larger(mean, all(0.0f)), all(1000.0f));
}

void occlude(const Occlusion& o) {
    for (int y = 0; y < o.height; ++y) {
        const float* const row = o.nearness + static_cast<std::int64_t>(y) * o.nearStride;
        const float* const depth = o.depth + static_cast<std::int64_t>(y) * o.stride;
        std::uint32_t* const rgba = o.rgba + static_cast<std::int64_t>(y) * o.stride;
        for (int x = 0; x < o.width; x += wideLanes) {
            const int lanes = o.width - x < wideLanes ? o.width - x : wideLanes;
            const FloatW near = loadSome<FloatW>(row + x, lanes);
            const IntW background = near < -3.4e38f;
            const FloatW own = background ? all(0.0f) : near;
            const FloatW scale = o.perspective ? loadSome<FloatW>(depth + x, lanes) : all(1.0f);
            FloatW sum{};
            for (int k = 0; k < occlusionPairs; ++k) {
                const FloatW h =
                    hollow(row + x + o.offsets[k], row + x - o.offsets[k], own, scale * o.perPx[k], lanes);
                const FloatW square = h * h;
                sum += square / (1.0f + square);
            }
            const IntW before = loadSome<IntW>(rgba + x, lanes);
            storeSome(rgba + x, background ? before : shaded(before, exp2Of(-(o.factor * sum))), lanes);
        }
    }
}

}  // namespace
}  // namespace scancast::cpu
