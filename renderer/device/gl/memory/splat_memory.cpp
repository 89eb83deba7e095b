#include "renderer/device/gl/memory/splat_memory.hpp"

#include <algorithm>

namespace scancast::gl {
namespace {

/// Sums of more pixels than this take are drawn band by band.
constexpr std::size_t largestPlane = std::size_t{512} << 20;

std::size_t keyWords(const SplatLimits& limits) {
    return limits.keys64 ? 2 : 1;
}

}  // namespace

std::size_t sumWords(const FramePasses& passes) {
    return !passes.sum ? 0 : passes.sum->normals ? 14 : 8;
}

Expected<void> PixelPlane::reserve(std::size_t pixels) {
    if (pixels <= pixels_) return {};
    pixels_ = 0;
    texels_.reset();
    if (auto ok = buffer_.reserve(pixels * words_ * 4); !ok) return ok;
    texels_.emplace(gl_, buffer_, words_);
    pixels_ = pixels;
    return {};
}

void PixelPlane::clear(std::size_t pixels) {
    buffer_.clear(pixels * words_, 0xffffffff);
}

SplatMemory::SplatMemory(const GlFunctions& gl, const SplatLimits& limits)
    : nearest{{gl, "nearest keys", keyWords(limits)}, {gl, "nearest payloads", 1}},
      cells{{gl, "cell keys", keyWords(limits)}, {gl, "cell payloads", 1}},
      silhouette(gl, "silhouette", 1),
      sums(gl, "sums"),
      places(gl, "places of sprites"),
      halves(gl, "sizes of sprites"),
      smoothed(gl, "smoothed colours"),
      limits_(limits) {}

std::size_t SplatMemory::mostPixels(const FramePasses& passes) const {
    const std::size_t words = std::max(keyWords(limits_), sumWords(passes));
    return std::min(limits_.texels, std::min(limits_.storageBlockBytes, largestPlane) / (4 * words));
}

Expected<void> SplatMemory::reserve(KeyPlane& plane, std::size_t pixels) {
    if (auto made = plane.keys.reserve(pixels); !made || limits_.keys64) return made;
    return plane.payloads.reserve(pixels);
}

Expected<void> SplatMemory::reserveOwners(std::size_t pixels) {
    for (Buffer* const buffer : {&places, &halves, &smoothed}) {
        if (auto ok = buffer->reserve(pixels * 4); !ok) return ok;
    }
    return {};
}

Expected<void> SplatMemory::reserve(const FramePasses& passes, std::size_t pixels) {
    Expected<void> made = reserve(nearest, pixels);
    if (made && passes.cell) made = reserve(cells, pixels);
    if (made && passes.silhouette) made = silhouette.reserve(pixels);
    if (made && passes.sum) made = sums.reserve(pixels * sumWords(passes) * 4);
    return made;
}

}  // namespace scancast::gl
