// Light on planes: Blinn-Phong from the plane of normals, docs/spec/shading.md §2, and the sun's shadows, looked up in what it
// sees, docs/spec/shading.md §10. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/formulas.hpp"
#include "renderer/device/cpu/kernels/normal_plane.hpp"
#include "renderer/device/cpu/kernels/sums.hpp"
#include "renderer/device/cpu/kernels/texels.hpp"

namespace scancast::cpu {
namespace {

void phong(const Phong& p) {
    for (int row = p.row0; row < p.row1; ++row) {
        std::uint32_t* const rgba = p.rgba + static_cast<std::int64_t>(row) * p.stride;
        const std::uint32_t* const normals = p.normals + static_cast<std::int64_t>(row) * p.stride;
        const FloatW y = all(-((p.offsetY + static_cast<float>(p.y + row)) * p.inverseFocal));
        for (int column = 0; column < p.width; column += wideLanes) {
            const int lanes = p.width - column < wideLanes ? p.width - column : wideLanes;
            const IntW code = loadSome<IntW>(normals + column, lanes);
            if (!anyOf<wideLanes>(code != 0)) continue;
            FloatW nx, ny, nz;
            unpackNormal(code, nx, ny, nz);
            FloatW vx = all(0.0f), vy = all(0.0f), vz = all(1.0f);
            if (p.perspective) {
                // The same numbers, wherever planes, rows and vectors begin.
                const FloatW x = (p.offsetX + toFloat(laneIndices() + (p.x + column))) * p.inverseFocal;
                const FloatW inverse = 1.0f / squareRoot<wideLanes>(x * x + y * y + 1.0f);
                vx = -x * inverse;
                vy = -y * inverse;
                vz = inverse;
            }
            const IntW before = loadSome<IntW>(rgba + column, lanes);
            const FloatW seen =
                p.sunSeen != nullptr
                    ? loadSome<FloatW>(p.sunSeen + static_cast<std::int64_t>(row) * p.stride + column, lanes)
                    : all(1.0f);
            FloatW diffuse, shine;
            blinnPhong(nx, ny, nz, vx, vy, vz, p.sun[0], p.sun[1], p.sun[2], p.ambient, p.headlight,
                       p.sunlight, p.shine, seen, diffuse, shine);
            const IntW after = lit(before, diffuse, shine);
            storeSome(rgba + column, code == 0 ? before : after, lanes);
        }
    }
}

/// A coordinate in the map, linear in pixels and depth.
inline float inShadowMap(const ShadowNumbers& s, const float* a, float x, float y, float depth) {
    const float flat = a[0] + a[1] * x + a[2] * y;
    return s.perspective ? depth * flat + a[3] : flat + a[3] * depth;
}

/// Of three texels beside each other, whose weights change smoothly with the place.
inline float litOfRow(const float* row, float depth, float first, float last) {
    const float a = row[-1] >= depth ? first : 0.0f;
    const float b = row[0] >= depth ? 0.5f : 0.0f;
    const float c = row[1] >= depth ? last : 0.0f;
    return a + b + c;
}

/// How much of the sun a pixel sees, 0 to 1.
inline float seenOfSun(const Shadow& s, float x, float y, float depth) {
    const float u = inShadowMap(s, s.u, x, y, depth), v = inShadowMap(s, s.v, x, y, depth);
    const bool inside = u >= 1.0f && v >= 1.0f && u < static_cast<float>(s.mapWidth - 1) &&
                        v < static_cast<float>(s.mapHeight - 1);
    if (!inside) return 1.0f;
    const std::int32_t column = static_cast<std::int32_t>(u), row = static_cast<std::int32_t>(v);
    const float right = (u - static_cast<float>(column)) * 0.5f, below = (v - static_cast<float>(row)) * 0.5f;
    const float limit = inShadowMap(s, s.depth, x, y, depth) - s.bias;
    const float* const place = s.map + static_cast<std::int64_t>(row) * s.mapWidth + column;
    const float above = litOfRow(place - s.mapWidth, limit, 0.5f - right, right);
    const float middle = litOfRow(place, limit, 0.5f - right, right);
    const float under = litOfRow(place + s.mapWidth, limit, 0.5f - right, right);
    return (0.5f - below) * above + 0.5f * middle + below * under;
}

void shadow(const Shadow& s) {
    for (int row = s.row0; row < s.row1; ++row) {
        const std::int64_t first = static_cast<std::int64_t>(row) * s.stride;
        const float y = static_cast<float>(s.y + row);
        for (int column = 0; column < s.width; ++column) {
            const float depth = s.depths[first + column];
            float sun = 1.0f;
            if (depth < 3.4e38f)
                sun = 1.0f - s.strength * (1.0f - seenOfSun(s, static_cast<float>(s.x + column), y, depth));
            s.sunlight[first + column] = sun;
            if (s.share <= 0.0f || !(depth < 3.4e38f)) continue;
            const float shade = 1.0f - s.share * (1.0f - sun);
            const std::uint32_t before = s.rgba[first + column];
            std::uint32_t after = before & 0xff000000u;
            for (int shift = 0; shift < 24; shift += 8) {
                const float channel = static_cast<float>((before >> shift) & 255u) * shade + 0.5f;
                after |= static_cast<std::uint32_t>(channel) << shift;
            }
            s.rgba[first + column] = after;
        }
    }
}

}  // namespace
}  // namespace scancast::cpu
