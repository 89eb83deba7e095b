// Draws a cut with one `nearest` pass on a device, with everything else at its plainest: what tests of
// devices vary is then all that they say.
#pragma once

#include <gtest/gtest.h>

#include "renderer/device/device.hpp"
#include "tests/support/pictures/analytic_cut.hpp"

namespace scancast::test {

inline constexpr glm::dvec2 noJitter{0, 0};

inline NearestPass sprite(Footprint footprint, Profile profile, float sizePx, float gain = 2) {
    NearestPass pass;
    pass.footprint = footprint;
    pass.profile = profile;
    pass.size.sizePx = sizePx;
    pass.gain = profile == Profile::Flat ? 0 : gain;
    return pass;
}

/// From nothing to twice as bright.
inline IntensityFactors factors(double low, double high) {
    IntensityFactors made{.low = low, .high = high};
    for (std::size_t i = 0; i < 256; ++i) made.factors[i] = static_cast<std::uint16_t>(2 * i);
    return made;
}

/// A drawing that owns its cuts: the whole picture, one frame of it.
struct OwnDrawing : Drawing {
    OwnDrawing(const Viewpoint& viewpoint, const Cut& cut, std::span<const Pass> what)
        : own_{{viewpoint, cut, {}}} {
        cuts = own_;
        passes = what;
        window = {0, 0, viewpoint.width, viewpoint.height};
        jitter = {&noJitter, 1};
    }
    OwnDrawing(const OwnDrawing& other) : Drawing(other), own_(other.own_) { cuts = own_; }

    CutView& view() { return own_.front(); }
    void add(std::span<const CutView> reflections) {
        own_.insert(own_.end(), reflections.begin(), reflections.end());
        cuts = own_;
    }

  private:
    std::vector<CutView> own_;
};

/// A drawing that owns its pass list.
struct Scene {
    PassList passes;
    OwnDrawing drawing;

    Scene(const Viewpoint& viewpoint, const Cut& cut, const NearestPass& nearest)
        : passes{nearest, ResolvePass{}}, drawing(viewpoint, cut, passes) {
        drawing.background.kind = Background::Kind::Color;
        drawing.background.top = {0, 0, 0};
    }
    Scene(const Scene&) = delete;

    void addEyeDome(EyeDomePass pass = {}) { add(pass); }
    void add(const Pass& pass) {
        passes.push_back(pass);
        drawing.passes = passes;
    }
};

inline Frame mustDraw(Device& device, const Drawing& drawing) {
    auto frame = device.draw(drawing, {});
    if (!frame) {
        ADD_FAILURE() << frame.error().message;
        return {};
    }
    return std::move(*frame);
}

inline Rgb8 pixel(const Frame& f, int x, int y) {
    const std::uint8_t* p = f.rgba.data() + 4 * (static_cast<std::size_t>(y) * f.width + x);
    return {p[0], p[1], p[2]};
}

inline std::uint8_t alpha(const Frame& f, int x, int y) {
    return f.rgba[4 * (static_cast<std::size_t>(y) * f.width + x) + 3];
}

inline float depth(const Frame& f, int x, int y) {
    return f.depth[static_cast<std::size_t>(y) * f.width + x];
}

}  // namespace scancast::test
