// A second opinion on every splat: one sample after another, one pixel after another, in double, straight
// from docs/spec/passes.md §1, docs/spec/sprites.md §3 and docs/spec/shading.md §4, sharing no code with any
// device. Slow, and meant to be obviously right.
#pragma once

#include <functional>
#include <vector>

#include "renderer/device/device.hpp"

namespace scancast::test {

struct ReferenceFragment {
    double order = 0;          ///< +infinity = background
    double distance = 0;       ///< squared, in units of half a splat (at least half a pixel)
    std::uint64_t sample = 0;  ///< ordinal in the cut
    Rgb8 color{};
};

struct ReferencePicture {
    int width = 0, height = 0;
    std::vector<ReferenceFragment> pixels;
    const ReferenceFragment& at(int x, int y) const {
        return pixels[static_cast<std::size_t>(y) * width + x];
    }
};

/// The whole picture of the drawing's viewpoint: its first frame, unlit, its first `nearest` pass.
ReferencePicture referenceNearest(const Drawing& drawing);

/// exp(-300 · strength · mean over 8 neighbours of max(0, log2 d - log2 d_i)); background adds nothing.
double referenceEyeDome(const Frame& depths, int x, int y, const EyeDomePass& pass);

}  // namespace scancast::test
