// Blinn-Phong lighting from the plane of normals; docs/spec/shading.md §2. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/normal_plane.hpp"
#include "renderer/device/cpu/kernels/sums.hpp"
#include "renderer/device/cpu/kernels/texels.hpp"

namespace scancast::cpu {
namespace {

/// To the directional light, view space: upper left, behind the viewer.
inline constexpr float lightX = -0.57735027f, lightY = 0.57735027f, lightZ = 0.57735027f;

struct Brightness {
    FloatW diffuse, specular;
};

/// (nx, ny, nz) and (vx, vy, vz) are unit vectors, v to the eye.
inline Brightness blinnPhong(const Phong& p, FloatW nx, FloatW ny, FloatW nz, FloatW vx, FloatW vy,
                             FloatW vz) {
    const FloatW facing = nx * vx + ny * vy + nz * vz;
    // Two-sided: the side that is seen is lit.
    const FloatW side = facing < 0.0f ? all(-1.0f) : all(1.0f);
    const FloatW light = larger(side * (nx * lightX + ny * lightY + nz * lightZ), all(0.0f));
    const FloatW hx = vx + lightX, hy = vy + lightY, hz = vz + lightZ;
    const FloatW half = side * (nx * hx + ny * hy + nz * hz);
    // The halfway vector is never 0: the light stands behind the viewer, v before him.
    FloatW shine = larger(half, all(0.0f)) / squareRoot<wideLanes>(hx * hx + hy * hy + hz * hz);
    for (int doubled = 0; doubled < 5; ++doubled) shine = shine * shine;
    return {p.ambient + p.headlight * (side * facing) + p.directional * light, (p.specular * 255.0f) * shine};
}

inline IntW lit(IntW rgba, const Brightness& b) {
    IntW out = rgba & static_cast<std::int32_t>(0xff000000u);
    for (int shift = 0; shift < 24; shift += 8) {
        const FloatW value = toFloat((rgba >> shift) & 255) * b.diffuse + b.specular + 0.5f;
        out |= toInt(smaller(value, all(255.0f))) << shift;
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
            const IntW after = lit(before, blinnPhong(p, nx, ny, nz, vx, vy, vz));
            storeSome(rgba + column, code == 0 ? before : after, lanes);
        }
    }
}

}  // namespace
}  // namespace scancast::cpu
