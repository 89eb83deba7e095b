// A surfel's ellipse byte, as renderer/cloud/surfel_codec.hpp writes it: b/a in 3 bits and the major axis'
// angle in 5, in the tangent frame of the decoded normal. Part of kernels.cpp.
#pragma once

#include "renderer/cloud/surfel_bytes.hpp"
#include "renderer/device/cpu/kernels/formulas.hpp"
#include "renderer/device/cpu/kernels/view_normals.hpp"
#include "renderer/device/host/splat_numbers.hpp"

namespace scancast::cpu {
namespace {

inline constexpr int outlierCode = outlierRadius;

/// Of a block's samples: the major half-axis over the radius, the minor over the major, the angle.
struct alignas(64) AxisCodes {
    float major[blockSize], ratio[blockSize], cosine[blockSize], sine[blockSize];
};

inline void decodeAxes(const SplatPass& pass, const Block& b, AxisCodes& out) {
    for (int i = 0; i < b.padded; ++i) {
        const std::uint32_t word = b.words[3][i];
        const std::uint32_t radius = (word >> 16) & 255;
        const std::uint32_t code = word >> 24;
        const bool known = radius != noRadius && radius != outlierCode && pass.radii != nullptr;
        out.major[i] = known ? majorPerRadius : 1.0f;
        out.ratio[i] = ratioOf(static_cast<std::int32_t>(code), pass.ratioStep);
        out.cosine[i] = axisDirections.cosine[code & (axisAngles - 1)];
        out.sine[i] = axisDirections.sine[code & (axisAngles - 1)];
    }
}

inline void majorAxis(FloatW nx, FloatW ny, FloatW nz, const AxisCodes& codes, int i, FloatW& x, FloatW& y,
                      FloatW& z) {
    axisAt(nx, ny, nz, load<FloatW>(codes.cosine + i), load<FloatW>(codes.sine + i), x, y, z);
}

}  // namespace
}  // namespace scancast::cpu
