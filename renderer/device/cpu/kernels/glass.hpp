// A mirror's glass: where it is seen, the reflected picture shows, and in the end its tint. Part of
// kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/formulas.hpp"

namespace scancast::cpu {
namespace {

/// The lanes of a row's pixels from `i` on that see the glass, and its depth there.
template <bool perspective>
inline IntW seesGlass(const Glass& g, int row, int i, FloatW scene, FloatW& depth) {
    const float y = static_cast<float>(g.y + row);
    const FloatW x = laneNumbers<wideLanes>() + static_cast<float>(g.x + i);
    const FloatW linear = (g.depthAt[0] + y * g.depthAt[2]) + x * g.depthAt[1];
    const FloatW right = (g.rightAt[0] + y * g.rightAt[2]) + x * g.rightAt[1];
    const FloatW up = (g.upAt[0] + y * g.upAt[2]) + x * g.upAt[1];
    const FloatW edge = perspective ? linear : all(1.0f);
    const IntW inFront = linear > 0.0f;
    depth = perspective ? 1.0f / (inFront ? linear : all(1.0f)) : linear;
    return inFront & (right <= edge) & (right >= -edge) & (up <= edge) & (up >= -edge) &
           (depth - g.margin <= scene);
}

/// Calls change(row, first pixel, lanes, which of them, glass's depth).
template <class Change>
inline void overGlass(const Glass& g, const Change& change) {
    for (int row = 0; row < g.height; ++row) {
        const float* const depths = g.depth + static_cast<std::int64_t>(row) * g.stride;
        for (int i = 0; i < g.width; i += wideLanes) {
            const int lanes = g.width - i < wideLanes ? g.width - i : wideLanes;
            const FloatW scene = loadSome<FloatW>(depths + i, lanes);
            FloatW depth;
            const IntW sees = g.perspective ? seesGlass<true>(g, row, i, scene, depth)
                                            : seesGlass<false>(g, row, i, scene, depth);
            change(row, i, lanes, sees, depth);
        }
    }
}

void lookThrough(const Glass& g) {
    overGlass(g, [&](int row, int i, int lanes, IntW sees, FloatW) {
        const std::int64_t at = static_cast<std::int64_t>(row) * g.stride + i;
        const std::int64_t from = static_cast<std::int64_t>(row) * g.reflectedStride + i;
        const auto take = [&](auto* to, const auto* reflected) {
            const IntW seen = loadSome<IntW>(reflected + from, lanes);
            storeSome(to + at, sees ? seen : loadSome<IntW>(to + at, lanes), lanes);
        };
        take(g.rgba, g.reflected);
        take(g.depth, g.reflectedDepth);
        if (g.normals != nullptr) take(g.normals, g.reflectedNormals);
    });
}

void tintGlass(const Glass& g) {
    overGlass(g, [&](int row, int i, int lanes, IntW sees, FloatW depth) {
        const std::int64_t at = static_cast<std::int64_t>(row) * g.stride + i;
        const IntW rgba = loadSome<IntW>(g.rgba + at, lanes);
        storeSome(g.rgba + at, sees ? throughGlass(rgba, g.tint[0], g.tint[1], g.tint[2]) : rgba, lanes);
        const FloatW scene = loadSome<FloatW>(g.depth + at, lanes);
        storeSome(g.depth + at, sees ? depth : scene, lanes);
    });
}

}  // namespace
}  // namespace scancast::cpu
