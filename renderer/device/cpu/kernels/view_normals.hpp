// Normals of samples, out of their bits and into view space. Part of kernels.cpp.
#pragma once

#include "renderer/cloud/surfel_bytes.hpp"
#include "renderer/device/cpu/kernels/normal_plane.hpp"
#include "renderer/device/cpu/kernels/project.hpp"

namespace scancast::cpu {
namespace {

/// Unit vectors in cloud space; (0, 0, 0) where a sample has none.
inline void sampleNormal(IntW codes, FloatW& x, FloatW& y, FloatW& z) {
    unpackSampleNormal(codes, x, y, z);
    const FloatW length2 = x * x + y * y + z * z;
    const FloatW inverse = 1.0f / squareRoot<wideLanes>(length2 > 0.0f ? length2 : all(1.0f));
    x = x * inverse;
    y = y * inverse;
    z = z * inverse;
}

/// Cloud space → view space: x right, y up, z towards the viewer.
inline void rotateToView(const SplatPass& pass, FloatW& x, FloatW& y, FloatW& z) {
    const auto& r = pass.rotation;
    const FloatW vx = r[0][0] * x + (r[0][1] * y + r[0][2] * z);
    const FloatW vy = r[1][0] * x + (r[1][1] * y + r[1][2] * z);
    const FloatW vz = r[2][0] * x + (r[2][1] * y + r[2][2] * z);
    x = vx;
    y = vy;
    z = vz;
}

/// Unit normals of a block's samples in view space, turned to the eye: where they are not oriented, and where they face
/// away by 30° or more, so that a back is seen. What faces away by less lies just behind an outline, over which its sprite
/// hangs: that one goes on to the side, so its normal is mirrored.
struct alignas(64) ViewNormals {
    float x[blockSize], y[blockSize], z[blockSize];
    std::int32_t anySide[blockSize];  ///< -1: it might as well point the other way
};

inline void viewNormals(const SplatPass& pass, bool oriented, const Block& b, ViewNormals& out) {
    const float slope = 1.0f / pass.pixelsPerUnit;
    for (int i = 0; i < b.padded; i += wideLanes) {
        FloatW x, y, z;
        sampleNormal(load<IntW>(b.words[3] + i) & 0xffff, x, y, z);
        rotateToView(pass, x, y, z);
        const IntW word = load<IntW>(b.words[3] + i);
        const IntW anySide = oriented ? (word >> 24 & 255) == twoSidedCircle : all(-1);
        // Towards the eye: against (x, y, -1) in perspective, along z in orthographic projection.
        const FloatW px = (load<FloatW>(b.x + i) - pass.centerX) * slope;
        const FloatW py = (pass.centerY - load<FloatW>(b.y + i)) * slope;
        const FloatW towards = pass.perspective ? z - (x * px + y * py) : z;
        const FloatW length2 = pass.perspective ? px * px + py * py + 1.0f : all(1.0f);
        const IntW away = towards < 0.0f;
        const IntW turns = away & (anySide | (towards * towards >= farAway * length2));
        const FloatW twice = (away & ~turns) ? 2.0f * towards / length2 : all(0.0f);
        if (pass.perspective) {
            x = x + twice * px;
            y = y + twice * py;
        }
        z = z - twice;
        x = turns ? -x : x;
        y = turns ? -y : y;
        z = turns ? -z : z;
        store(out.anySide + i, anySide);
        store(out.x + i, x);
        store(out.y + i, y);
        store(out.z + i, z);
    }
}

}  // namespace
}  // namespace scancast::cpu
