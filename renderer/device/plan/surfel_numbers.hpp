// Numbers of surfels that kernels, shaders and the host share. Constants of internal linkage and nothing
// else, because SIMD kernels include this (decision 2).
#pragma once

namespace scancast {

/// Largest radius over depth in perspective: what reaches the eye's plane has no outline. Once for what is
/// drawn, once for what a sum extends it to.
constexpr float largestSpread = 0.5f, largestReach = 0.9f;
constexpr float rootOf6 = 2.4494897f;

/// Directions of the major axis that an ellipse byte may name (renderer/cloud/surfel_codec.hpp): 32, half a
/// turn in all.
constexpr int axisAngles = 32;
struct AxisDirections {
    float cosine[axisAngles], sine[axisAngles];
};
constexpr AxisDirections axisDirections = [] {
    AxisDirections table{};
    double c = 1, s = 0;
    for (int i = 0; i < axisAngles; ++i) {
        table.cosine[i] = static_cast<float>(c);
        table.sine[i] = static_cast<float>(s);
        const double next = c * 0.9951847266721969 - s * 0.0980171403295606;
        s = s * 0.9951847266721969 + c * 0.0980171403295606;
        c = next;
    }
    return table;
}();

}  // namespace scancast
