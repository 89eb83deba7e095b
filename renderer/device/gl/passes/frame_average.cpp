#include "renderer/device/gl/passes/frame_average.hpp"

#include <cassert>

#include "renderer/device/gl/programs/screen_layouts.hpp"

namespace scancast::gl {

Expected<void> crop(const Buffer& plane, const glm::ivec4& area, const glm::ivec4& window, Buffer& out,
                    ScreenShaders& shaders) {
    const std::size_t pixels = static_cast<std::size_t>(window.z) * static_cast<std::size_t>(window.w);
    if (auto room = out.reserve(pixels * 4); !room) return room;
    if (auto set = shaders.set(PartParams{area, window, uvec4(0)}); !set) return set;
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
    if (auto room = redBlue_.reserve(pixels * 4); !room) return room;
    return greenAlpha_.reserve(pixels * 4);
}

Expected<void> FrameAverage::add(const GpuPlanes& planes, const glm::ivec4& window) {
    assert(window.z == width_ && window.w == height_ && frames_ < mostFrames);
    const PartParams params{planes.area, window, uvec4(frames_++, 0, 0, 0)};
    if (auto set = shaders_.set(params); !set) return set;
    planes.rgba->bindStorage(BindPart);
    redBlue_.bindStorage(BindRedBlue);
    greenAlpha_.bindStorage(BindGreenAlpha);
    return shaders_.overPixels("accumulate.comp", width_, height_);
}

Expected<void> FrameAverage::write(Buffer& rgba) {
    assert(frames_ > 0);
    const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    if (auto room = rgba.reserve(pixels * 4); !room) return room;
    const ivec4 window(0, 0, width_, height_);
    if (auto set = shaders_.set(PartParams{window, window, uvec4(frames_, 0, 0, 0)}); !set) return set;
    rgba.bindStorage(BindPart);
    redBlue_.bindStorage(BindRedBlue);
    greenAlpha_.bindStorage(BindGreenAlpha);
    return shaders_.overPixels("average.comp", width_, height_);
}

}  // namespace scancast::gl
