// Blinn-Phong lighting from the plane of normals; docs/spec/shading.md §2. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/normal_plane.hpp"
#include "renderer/device/cpu/kernels/sums.hpp"
#include "renderer/device/cpu/kernels/texels.hpp"

namespace scancast::cpu {
namespace {

struct Brightness {
    FloatW diffuse, shine;
};

/// (nx, ny, nz) and (vx, vy, vz) are unit vectors, v to the eye.
inline Brightness blinnPhong(const Phong& p, FloatW nx, FloatW ny, FloatW nz, FloatW vx, FloatW vy, FloatW vz,
                             FloatW sunSeen) {
    const FloatW facing = nx * vx + ny * vy + nz * vz;
    // Two-sided: the side that is seen is lit.
    const FloatW side = facing < 0.0f ? all(-1.0f) : all(1.0f);
    const FloatW toLampX = vx + lampX, toLampY = vy + lampY;
    const FloatW nearer = 1.0f / squareRoot<wideLanes>(toLampX * toLampX + toLampY * toLampY + vz * vz);
    const FloatW mx = toLampX * nearer, my = toLampY * nearer, mz = vz * nearer;
    // Large and near: what is turned a little from it gets hardly less, what is turned away from it still some.
    const FloatW ofLamp = side * (nx * mx + ny * my + nz * mz);
    const FloatW lamp = larger(ofLamp * lampScale + lampOffset, all(0.0f));
    const FloatW sun = larger(side * (nx * p.sun[0] + ny * p.sun[1] + nz * p.sun[2]), all(0.0f));
    const FloatW hx = vx + mx, hy = vy + my, hz = vz + mz;
    const FloatW half = side * (nx * hx + ny * hy + nz * hz);
    // Neither is ever 0: eye and lamp are before whatever is seen.
    FloatW shine = larger(half, all(0.0f)) / squareRoot<wideLanes>(hx * hx + hy * hy + hz * hz);
    for (int doubled = 0; doubled < 6; ++doubled) shine = shine * shine;
    const FloatW soft = lamp * (2.0f - lamp);
    const FloatW diffuse = p.ambient + p.headlight * soft + p.sunlight * (sun * sunSeen);
    return {smaller(diffuse, all(2.0f)), p.shine * shine};
}

/// What brightens bends towards white, and nothing but white becomes so.
inline IntW lit(IntW rgba, const Brightness& b) {
    const FloatW less = smaller(b.diffuse, all(1.0f));
    const FloatW more = larger(b.diffuse - 1.0f, all(0.0f));
    IntW out = rgba & static_cast<std::int32_t>(0xff000000u);
    for (int shift = 0; shift < 24; shift += 8) {
        const FloatW dimmed = toFloat((rgba >> shift) & 255) * less;
        const FloatW value = dimmed + dimmed * more * (1.0f - dimmed * 0.003921569f);
        const FloatW shining = value + b.shine * (255.0f - value) + 0.5f;
        out |= toInt(smaller(shining, all(255.0f))) << shift;
    }
    return out;
}

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
            const IntW after = lit(before, blinnPhong(p, nx, ny, nz, vx, vy, vz, seen));
            storeSome(rgba + column, code == 0 ? before : after, lanes);
        }
    }
}

}  // namespace
}  // namespace scancast::cpu
