// The screen passes of docs/spec/pyramid.md §1 on the CPU: hidden point removal, pull-push, normals of the
// filled depth. Called between what splats have drawn and what shades it, in this order, on whole pictures
// (guard band included) whose planes are changed in place.
//
// Owned by the device, so that its buffers outlive pictures: a picture of a known size allocates nothing.
// One picture at a time; the work inside is spread over the picture's workers and does not depend on them.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/device/cpu/kernels/pyramid.hpp"
#include "renderer/device/cpu/workers.hpp"
#include "renderer/device/host/screens.hpp"

namespace scancast::cpu {

/// The planes of a picture and where they stand in front of the eye.
struct PyramidPlanes : PyramidView {
    std::uint32_t* rgba = nullptr;
    float* depth = nullptr;   ///< linear; +infinity = background
    std::int32_t stride = 0;  ///< pixels per row, of both
};

class Pyramid {
  public:
    /// One label per pixel; rows are `stride` bytes long.
    struct Labels {
        const std::uint8_t* first = nullptr;
        std::int32_t stride = 0;
    };

    /// Labels every pixel hidden, visible foreground or visible background. Changes nothing else.
    void hidePoints(const PyramidPlanes&, const HiddenPointsPass&, const PyramidKernels&, const Workers&);
    /// Valid until the next hidePoints.
    Labels labels() const;
    /// Colours of labels in place of those of points. After hidePoints of the same picture, before fill.
    void showLabels(const PyramidPlanes&, const VisibilityPass&, const Workers&) const;
    /// Gives colour and depth to hidden pixels. After hidePoints of the same picture.
    void fill(const PyramidPlanes&, const PullPushPass&, const PyramidKernels&, const Workers&);
    /// Packed normals (kernels/normal_plane.hpp), 0 at background. After fill of the same picture.
    void findNormals(const PyramidPlanes&, const DepthNormalsPass&, const PyramidKernels&, const Workers&,
                     std::uint32_t* out, std::int32_t outStride);

  private:
    /// Memory for all levels of some planes.
    struct LevelMemory {
        std::vector<float> values;
        std::size_t used = 0;
    };

    void layOut(const PyramidPlanes&);
    float* takePlane(LevelMemory& block, std::int32_t stride, std::int32_t height, std::size_t& offset);
    void chooseReach(const HiddenPointsNumbers&);
    void settleSizes();
    void closeBackground(const PyramidKernels&, const Workers&);

    std::int32_t width_ = 0, height_ = 0;
    PyramidShape shape_;
    LevelMemory pointBlock_, fillBlock_, normalBlock_;
    std::vector<std::uint8_t> labels_, reach_, wide_, uncovered_, distances_, covered_;
    std::vector<std::int32_t> sizes_, settled_;
    std::int32_t labelStride_ = 0, blocksPerRow_ = 0, byteStride_ = 0;
    PointLevel points_[maxPyramidLevels];
    FillLevel fills_[maxPyramidLevels];  ///< [0] is the picture itself: unused
    NormalLevel normals_[maxPyramidLevels];
};

}  // namespace scancast::cpu
