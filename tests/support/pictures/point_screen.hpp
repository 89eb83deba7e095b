// Pictures of one-pixel points made by hand, for the screen passes of docs/spec/pyramid.md §1: the tests know
// of every pixel which surface its point came from, and no device stands between them and the passes.
#pragma once

#include <tbb/task_arena.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "renderer/device/cpu/pyramid.hpp"
#include "renderer/device/cpu/simd_level.hpp"
#include "tests/support/pictures/analytic_cut.hpp"

namespace scancast::test {

/// A point in view space: x right, y up, depth away from the viewer.
struct ScreenPoint {
    double x = 0, y = 0, depth = 0;
};

struct PointScreen {
    int width = 0, height = 0;
    bool perspective = true;
    double pixelsPerUnit = 1;
    std::vector<std::uint32_t> rgba, normals;
    std::vector<float> depth;
    std::vector<int> surface;  ///< of the pixel's point; -1 = background
    std::vector<std::uint8_t> labels;

    static constexpr std::uint32_t background = 0xff402010;

    PointScreen(int w, int h, bool inPerspective, double pixels)
        : width(w), height(h), perspective(inPerspective), pixelsPerUnit(pixels) {
        const std::size_t size = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
        rgba.assign(size, background);
        normals.assign(size, 0);
        depth.assign(size, std::numeric_limits<float>::infinity());
        surface.assign(size, -1);
        labels.assign(size, 0);
    }

    std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
    /// Where a point falls, px; false outside.
    bool pixelOf(const ScreenPoint& p, int& px, int& py) const {
        const double q = perspective ? pixelsPerUnit / p.depth : pixelsPerUnit;
        const double x = width / 2.0 + p.x * q, y = height / 2.0 - p.y * q;
        if (!(p.depth > 0) || x < 0 || y < 0 || x >= width || y >= height) return false;
        px = static_cast<int>(x);
        py = static_cast<int>(y);
        return true;
    }
    /// Draws it where it is nearest.
    void add(const ScreenPoint& p, int of, std::uint32_t color = 0xffffffff) {
        int px = 0, py = 0;
        if (!pixelOf(p, px, py)) return;
        const std::size_t i = at(px, py);
        if (!(static_cast<float>(p.depth) < depth[i])) return;
        depth[i] = static_cast<float>(p.depth);
        rgba[i] = color;
        surface[i] = of;
    }
    /// The view direction through a pixel's centre as (x, y) per unit of depth; orthographic: its place.
    ScreenPoint through(int px, int py) const {
        return {(px + 0.5 - width / 2.0) / pixelsPerUnit, (height / 2.0 - py - 0.5) / pixelsPerUnit, 1};
    }
    cpu::PyramidPlanes planes() {
        cpu::PyramidPlanes s;
        s.rgba = rgba.data();
        s.depth = depth.data();
        s.stride = s.width = width;
        s.height = height;
        s.perspective = perspective;
        s.pixelsPerUnit = pixelsPerUnit;
        s.center = {width / 2.0, height / 2.0};
        return s;
    }
};

/// Runs the passes on such pictures.
class PointPasses {
  public:
    virtual ~PointPasses() = default;
    virtual void hidePoints(PointScreen& p, const HiddenPointsPass& pass) = 0;
    /// After hidePoints of the same picture.
    virtual void showLabels(PointScreen& p, const VisibilityPass& pass) = 0;
    virtual void fill(PointScreen& p, const PullPushPass& pass) = 0;
    virtual void findNormals(PointScreen& p, const DepthNormalsPass& pass) = 0;

    /// All three with the method's own numbers.
    void run(PointScreen& p, double spacing, double detail = 0) {
        HiddenPointsPass hide;
        hide.spacing = static_cast<float>(spacing);
        hide.detail = static_cast<float>(detail);
        hide.minGap = static_cast<float>(3 * spacing);
        hidePoints(p, hide);
        fill(p, {});
        DepthNormalsPass normal;
        normal.spacing = hide.spacing;
        normal.detail = hide.detail;
        findNormals(p, normal);
    }
};

/// With the cpu device's kernels: the best of this machine or given ones.
class PyramidRunner : public PointPasses {
  public:
    explicit PyramidRunner(int threads = 2, const cpu::SimdLevel* level = nullptr)
        : arena_(threads),
          workers_(arena_, threads, {}),
          kernels_((level != nullptr ? level : cpu::chooseSimdLevel({}).value())->kernels->pyramid) {}

    /// Without copying the labels.
    void hidePointsOnly(PointScreen& p, const HiddenPointsPass& pass) {
        pyramid_.hidePoints(p.planes(), pass, kernels_, workers_);
    }
    void hidePoints(PointScreen& p, const HiddenPointsPass& pass) override {
        hidePointsOnly(p, pass);
        const auto labels = pyramid_.labels();
        for (int y = 0; y < p.height; ++y) {
            for (int x = 0; x < p.width; ++x) p.labels[p.at(x, y)] = labels.first[y * labels.stride + x];
        }
    }
    void showLabels(PointScreen& p, const VisibilityPass& pass) override {
        pyramid_.showLabels(p.planes(), pass, workers_);
    }
    void fill(PointScreen& p, const PullPushPass& pass) override {
        pyramid_.fill(p.planes(), pass, kernels_, workers_);
    }
    void findNormals(PointScreen& p, const DepthNormalsPass& pass) override {
        pyramid_.findNormals(p.planes(), pass, kernels_, workers_, p.normals.data(), p.width);
    }

  private:
    tbb::task_arena arena_;
    cpu::Workers workers_;
    const cpu::PyramidKernels& kernels_;
    cpu::Pyramid pyramid_;
};

/// A pixel's normal in view space; (0, 0, 0) where it has none. Written anew from the plane's format:
/// octahedral, 16 + 16 bits, 1 … 65535 with 32768 in the middle.
inline glm::dvec3 normalOf(std::uint32_t code) {
    if (code == 0) return {0, 0, 0};
    const double u = (double(code >> 16) - 32768) / 32767, v = (double(code & 0xffff) - 32768) / 32767;
    glm::dvec3 n{u, v, 1 - std::abs(u) - std::abs(v)};
    if (n.z < 0) {
        n.x = std::copysign(1 - std::abs(v), u);
        n.y = std::copysign(1 - std::abs(u), v);
    }
    return n / std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
}

/// Plane at a depth, seen from the front: points every `spacing` from its middle on, each off its place by up
/// to `noise` on every axis. Calls add(ScreenPoint).
template <class Add>
void sheet(double depth, double halfWidth, double halfHeight, double spacing, double noise, Numbers& numbers,
           const Add& add) {
    const int columns = static_cast<int>(halfWidth / spacing), rows = static_cast<int>(halfHeight / spacing);
    for (int j = -rows; j <= rows; ++j) {
        for (int i = -columns; i <= columns; ++i) {
            add(ScreenPoint{i * spacing + numbers.uniform(-noise, noise),
                            j * spacing + numbers.uniform(-noise, noise),
                            depth + numbers.uniform(-noise, noise)});
        }
    }
}

}  // namespace scancast::test
