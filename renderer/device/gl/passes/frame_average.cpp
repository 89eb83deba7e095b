#include "renderer/device/gl/passes/frame_average.hpp"

#include <cassert>

#include "renderer/device/gl/programs/screen_layouts.hpp"

namespace scancast::gl {

Expected<void> crop(const Buffer& plane, const glm::ivec4& area, const glm::ivec4& window, Buffer& out,
                    ScreenShaders& shaders) {
    const std::size_t pixels = static_cast<std::size_t>(window.z) * static_cast<std::size_t>(window.w);
    if (auto ok = out.reserve(pixels * 4); !ok) return ok;
    if (auto ok = shaders.set(PartParams{area, window, uvec4(0)}); !ok) return ok;
    plane.bindStorage(BindPart);
    out.bindStorage(BindCropped);
    return shaders.overPixels("crop.comp", window.z, window.w);
}

FrameAverage::FrameAverage(ScreenShaders& shaders)
    : shaders_(shaders),
      redBlue_(shaders.functions(), "sums of frames, red and blue"),
      greenAlpha_(shaders.functions(), "sums of frames, green and alpha") {}

Expected<void> FrameAverage::begin(int width, int height) {
    width_ = width;
    height_ = height;
    frames_ = 0;
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (auto ok = redBlue_.reserve(pixels * 4); !ok) return ok;
    return greenAlpha_.reserve(pixels * 4);
}

Expected<void> FrameAverage::add(const GpuPlanes& planes, const glm::ivec4& window) {
    assert(window.z == width_ && window.w == height_ && frames_ < mostFrames);
    const PartParams params{planes.area, window, uvec4(frames_++, 0, 0, 0)};
    if (auto ok = shaders_.set(params); !ok) return ok;
    planes.rgba->bindStorage(BindPart);
    redBlue_.bindStorage(BindRedBlue);
    greenAlpha_.bindStorage(BindGreenAlpha);
    return shaders_.overPixels("accumulate.comp", width_, height_);
}

Expected<void> FrameAverage::write(Buffer& rgba) {
    assert(frames_ > 0);
    const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    if (auto ok = rgba.reserve(pixels * 4); !ok) return ok;
    const ivec4 window(0, 0, width_, height_);
    if (auto ok = shaders_.set(PartParams{window, window, uvec4(frames_, 0, 0, 0)}); !ok) return ok;
    rgba.bindStorage(BindPart);
    redBlue_.bindStorage(BindRedBlue);
    greenAlpha_.bindStorage(BindGreenAlpha);
    return shaders_.overPixels("average.comp", width_, height_);
}

}  // namespace scancast::gl
