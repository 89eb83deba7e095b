// Runs compute shaders over planes: what all screen passes have in common. Owned by a GL device; everything,
// destruction included, inside a Current scope of its context. One dispatch sees what earlier ones wrote.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "renderer/device/gl/programs/gl_handles.hpp"
#include "renderer/device/gl/programs/programs.hpp"

namespace scancast::gl {

class ScreenShaders {
  public:
    /// Both outlive it.
    ScreenShaders(const GlFunctions& gl, Programs& programs);

    /// The uniform block of the dispatches that follow.
    template <class Params>
    Expected<void> set(const Params& params) {
        if (auto ok = params_.write(std::as_bytes(std::span(&params, 1))); !ok) return ok;
        params_.bindUniform(0);
        return {};
    }
    /// Dispatches so many work groups; `base` goes to a shader's `baseLevel` where it has one.
    Expected<void> run(std::string_view shader, int groupsX, int groupsY,
                       std::span<const Define> defines = {}, const std::uint32_t* base = nullptr);
    /// One invocation per pixel, in groups of 32 × 8.
    Expected<void> overPixels(std::string_view shader, int width, int height,
                              std::span<const Define> defines = {});

    const GlFunctions& functions() const { return gl_; }
    /// Bytes that a shader can see of one buffer.
    std::size_t largestBuffer() const { return largestBuffer_; }

  private:
    const GlFunctions& gl_;
    Programs& programs_;
    Buffer params_;
    std::size_t largestBuffer_ = std::size_t{128} << 20;  ///< what OpenGL promises
};

/// How many tiles of `side` pixels there are in a row.
inline int tilesOf(int pixels, int side) {
    return (pixels + side - 1) / side;
}

}  // namespace scancast::gl
