// The pyramid of points that hidden point removal looks at: of each 2 × 2 the point with the least depth, the
// first in reading order among equals. docs/spec/pyramid.md §3. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/texels.hpp"

namespace scancast::cpu {
namespace {

void copyDepth(const float* depth, std::int32_t stride, const PointLevel& out, int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
        __builtin_memcpy(out.depth + rowOf(out.stride, y), depth + rowOf(stride, y),
                         static_cast<unsigned>(out.width) * sizeof(float));
    }
}

/// Place of a pixel relative to the view axis, times depth in perspective: x right, y up.
inline FloatW placeX(const Unprojection& u, FloatW px) {
    return (px + (0.5f - u.centerX)) * u.step;
}
inline FloatW placeY(const Unprojection& u, FloatW py) {
    return ((u.centerY - 0.5f) - py) * u.step;
}

void firstPoints(const PointLevel& picture, const Unprojection& u, const PointLevel& out, int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
        const float* const top = picture.depth + rowOf(picture.stride, 2 * y);
        const std::int64_t row = rowOf(out.stride, y);
        for (int x = 0; x < out.width; x += wideLanes) {
            const Four<FloatW> fine = loadFours<FloatW>(top + 2 * x, top + 2 * x + picture.stride);
            const FloatW left = toFloat((laneIndices() + x) * 2);
            FloatW depth = fine.v[0], px = left, py = all(static_cast<float>(2 * y));
            for (int i = 1; i < 4; ++i) {
                const IntW nearer = fine.v[i] < depth;
                depth = nearer ? fine.v[i] : depth;
                px = nearer ? left + static_cast<float>(i & 1) : px;
                py = nearer ? all(static_cast<float>(2 * y + (i >> 1))) : py;
            }
            const FloatW scale = u.perspective ? depth : all(1.0f);
            const FloatW pointX = placeX(u, px) * scale, pointY = placeY(u, py) * scale;
            const FloatW square = pointX * pointX + pointY * pointY + depth * depth;
            storeInside(out.depth + row, x, out.width, depth);
            storeInside(out.x + row, x, out.width, pointX);
            storeInside(out.y + row, x, out.width, pointY);
            storeInside(out.square + row, x, out.width, u.perspective ? square : all(1.0f));
        }
    }
}

void nextPoints(const PointLevel& fine, const PointLevel& out, int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
        const std::int64_t top = rowOf(fine.stride, 2 * y), row = rowOf(out.stride, y);
        for (int x = 0; x < out.width; x += wideLanes) {
            const auto fours = [&](const float* plane) {
                const float* const p = plane + top + 2 * x;
                return loadFours<FloatW>(p, p + fine.stride);
            };
            const Four<FloatW> d = fours(fine.depth), px = fours(fine.x), py = fours(fine.y),
                               s = fours(fine.square);
            FloatW depth = d.v[0], pointX = px.v[0], pointY = py.v[0], square = s.v[0];
            for (int i = 1; i < 4; ++i) {
                const IntW nearer = d.v[i] < depth;
                depth = nearer ? d.v[i] : depth;
                pointX = nearer ? px.v[i] : pointX;
                pointY = nearer ? py.v[i] : pointY;
                square = nearer ? s.v[i] : square;
            }
            storeInside(out.depth + row, x, out.width, depth);
            storeInside(out.x + row, x, out.width, pointX);
            storeInside(out.y + row, x, out.width, pointY);
            storeInside(out.square + row, x, out.width, square);
        }
    }
}

}  // namespace
}  // namespace scancast::cpu
