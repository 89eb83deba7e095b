// The screen passes of docs/spec/pyramid.md §1 on the GPU: hidden point removal, pull-push, normals of the
// filled depth, in this order, on planes that are changed in place. Levels above the picture stand one after
// another in two buffers of texels; a dispatch works on six levels at a time, so that a picture of up to 4096
// pixels takes nine.
//
// Owned by a GL device, so that its buffers outlive pictures; everything, destruction included, inside a
// Current scope of its context. One picture at a time. What comes out is, byte by byte, what the cpu device
// computes, where divisions and roots are exact.
#pragma once

#include "renderer/device/gl/passes/planes.hpp"
#include "renderer/device/gl/programs/screen_layouts.hpp"
#include "renderer/device/gl/programs/screen_shaders.hpp"
#include "renderer/device/host/screens.hpp"

namespace scancast::gl {

class Pyramid {
  public:
    /// `shaders` outlive it.
    explicit Pyramid(ScreenShaders& shaders);

    /// Labels every pixel hidden, visible foreground or visible background. Changes nothing else.
    /// ResourceLimit for a picture whose levels a shader cannot see as a whole.
    Expected<void> hidePoints(const GpuPlanes& planes, const PyramidView& view, const HiddenPointsPass& pass);
    /// Colours of labels in place of those of points. After hidePoints of the same picture, before fill.
    Expected<void> showLabels(const GpuPlanes& planes, const PyramidView& view, const VisibilityPass& pass);
    /// Gives colour and depth to hidden pixels. After hidePoints of the same picture.
    Expected<void> fill(const GpuPlanes& planes, const PyramidView& view);
    /// Writes the plane of normals, 0 at background. After fill of the same picture.
    Expected<void> findNormals(const GpuPlanes& planes, const PyramidView& view,
                               const DepthNormalsPass& pass);

    /// Of hidePoints, one word a pixel.
    const Buffer& labels() const { return labels_; }

  private:
    Expected<void> layOut(const PyramidView& view);
    PyramidParams paramsOf(const PyramidView& view) const;
    void bind(const GpuPlanes& planes) const;
    /// Which background pixels are holes.
    Expected<void> closeBackground(const PyramidView& view);
    /// Runs a shader of six levels at a time on the tiles of one level.
    Expected<void> overTiles(const char* shader, int level);

    ScreenShaders& shaders_;
    Buffer labels_;
    Buffer closing_;  ///< of the background: blocks, then twice the pixels
    Buffer texels_;   ///< nearest points; later filled depths and colours
    Buffer pulled_;   ///< pulled depths and colours; later normals
    PyramidShape shape_;
    std::array<std::int32_t, maxPyramidLevels> first_{};  ///< a level's first texel
};

}  // namespace scancast::gl
