// How normals turn across a sample: its curvatures (renderer/cloud/curvature.hpp) in view space, and what they make of its
// normal at a place beside its centre. docs/spec/surfels.md §12. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/surfel_codes.hpp"

namespace scancast::cpu {
namespace {

/// Of a vector of samples: what their codes say, one lane each.
struct alignas(64) BendCodes {
    float cosine[wideLanes], sine[wideLanes];  ///< of k1's direction
    float k1[wideLanes], k2[wideLanes];        ///< times what the run has per cloud unit
};

/// Of what stands beside a sample (renderer/cloud/beside.hpp).
constexpr std::uint32_t curvatureBits = 0x00ffffff;

inline float bendsPerUnit(const SplatRun& run) {
    return 1.0f / (run.ratioUnit * run.plainRadius);
}

inline void decodeBend(const SplatPass& pass, std::uint32_t code, int i, BendCodes& out) {
    out.k1[i] = pass.curvatures[code & 255];
    out.k2[i] = pass.curvatures[(code >> 8) & 255];
    out.cosine[i] = axisDirections.cosine[(code >> 16) & (axisAngles - 1)];
    out.sine[i] = axisDirections.sine[(code >> 16) & (axisAngles - 1)];
}

/// The principal directions in view space (x right, y up, z towards the viewer), and the curvatures along them.
struct Bend {
    FloatW k1, k2;
    FloatW x1, y1, z1, x2, y2, z2;
};

/// Of unit normals in cloud space, and the same in view space.
inline Bend bendOf(const SplatPass& pass, FloatW cloudX, FloatW cloudY, FloatW cloudZ, FloatW x, FloatW y,
                   FloatW z, const BendCodes& codes, FloatW perUnit) {
    Bend b;
    b.k1 = load<FloatW>(codes.k1) * perUnit;
    b.k2 = load<FloatW>(codes.k2) * perUnit;
    axisAt(cloudX, cloudY, cloudZ, load<FloatW>(codes.cosine), load<FloatW>(codes.sine), b.x1, b.y1, b.z1);
    rotateToView(pass, b.x1, b.y1, b.z1);
    b.x2 = y * b.z1 - z * b.y1;
    b.y2 = z * b.x1 - x * b.z1;
    b.z2 = x * b.y1 - y * b.x1;
    return b;
}

/// Never more than a radian: beyond, nothing is known of the surface.
inline FloatW turnOf(FloatW turn) {
    return larger(smaller(turn, all(1.0f)), all(-1.0f));
}

}  // namespace
}  // namespace scancast::cpu
