// The passes of a picture on the GPU: owns programs and buffers, which stay from picture to picture, and runs
// what a draw plan says. Owned by a GL device; everything, destruction included, inside a Current scope of
// its context. Pipeline: draw plan → **passes** → frame.
#pragma once

#include <filesystem>
#include <glm/vec2.hpp>
#include <stop_token>
#include <vector>

#include "renderer/device/gl/draw_plan.hpp"
#include "renderer/device/gl/gl_handles.hpp"
#include "renderer/device/gl/programs.hpp"

namespace scancast::gl {

class Passes {
  public:
    Passes(const GlFunctions& gl, const std::filesystem::path& programFolder);

    /// What plans may ask for here.
    const GlLimits& limits() const { return limits_; }
    /// Everything of a plan but the samples goes to the GPU. `plan` must outlive the picture's other calls.
    Expected<void> begin(const DrawPlan& plan);
    /// Clears, then the order dispatches and the payload dispatches, slice by slice; Cancelled between
    /// slices.
    Expected<void> nearest(const glm::dvec2& jitter, const std::stop_token& stop);
    Expected<void> resolve();
    Expected<void> eyeDome();
    /// The window's rgba, four bytes a pixel, after the last screen pass.
    Expected<void> readColor(std::span<std::uint8_t> rgba);
    /// The window's depths.
    Expected<void> readDepth(std::span<float> depth);

  private:
    /// A page buffer and whose samples are in it now.
    struct Slot {
        Buffer buffer;
        std::size_t page;
    };

    Expected<void> bindPage(std::size_t page);
    Expected<void> splat(int stage, const std::stop_token& stop);
    Expected<void> splatPage(const SamplePage& page, const std::stop_token& stop);
    void dispatchScreen(int width, int height);
    std::size_t areaPixels() const;

    const GlFunctions& gl_;
    GlLimits limits_;
    const DrawPlan* plan_ = nullptr;
    Programs programs_;
    std::vector<Slot> slots_;
    Buffer params_, runs_, chunks_, colors_, background_, orders_, payloads_, resolved_, shaded_;
    std::vector<float> areaDepth_;    ///< read back when the area is larger than the window
    std::uint32_t sliceChunks_ = 64;  ///< work groups a dispatch, adapted to last a few milliseconds
};

}  // namespace scancast::gl
