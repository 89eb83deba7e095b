// The passes of docs/spec/pyramid.md §1 on pictures of points made by hand, on the cpu device's kernels or on
// a GL backend's shaders, without a device around them: what their oracles are asked of.
#pragma once

#include "renderer/device/gl/passes/pyramid.hpp"
#include "tests/support/pictures/on_gl.hpp"
#include "tests/support/pictures/point_screen.hpp"

namespace scancast::test {

/// On the GPU of a context that is current as long as this lives.
class GlPointPasses : public PointPasses {
  public:
    explicit GlPointPasses(gl::ScreenShaders& shaders)
        : functions_(shaders.functions()), buffers_(functions_), pyramid_(shaders) {}

    void hidePoints(PointScreen& p, const HiddenPointsPass& pass) override {
        there(p, [&](const gl::GpuPlanes& planes) { return pyramid_.hidePoints(planes, p.planes(), pass); });
        std::vector<std::uint32_t> labels(p.depth.size());
        pyramid_.labels().read(std::as_writable_bytes(std::span(labels)));
        p.labels.assign(labels.begin(), labels.end());
    }
    void showLabels(PointScreen& p, const VisibilityPass& pass) override {
        there(p, [&](const gl::GpuPlanes& planes) { return pyramid_.showLabels(planes, p.planes(), pass); });
    }
    void fill(PointScreen& p, const PullPushPass&) override {
        there(p, [&](const gl::GpuPlanes& planes) { return pyramid_.fill(planes, p.planes()); });
    }
    void findNormals(PointScreen& p, const DepthNormalsPass& pass) override {
        there(p, [&](const gl::GpuPlanes& planes) { return pyramid_.findNormals(planes, p.planes(), pass); });
    }

  private:
    template <class Work>
    void there(PointScreen& p, const Work& work) {
        PixelPlanes planes{
            {0, 0, p.width, p.height}, std::move(p.rgba), std::move(p.depth), std::move(p.normals)};
        const Expected<void> done = work(buffers_.upload(planes));
        EXPECT_TRUE(done) << done.error().message;
        EXPECT_TRUE(gl::checkErrors(functions_, "testing"));
        buffers_.download(planes);
        p.rgba = std::move(planes.rgba);
        p.depth = std::move(planes.depth);
        p.normals = std::move(planes.normals);
    }

    const gl::GlFunctions& functions_;
    PlaneBuffers buffers_;
    gl::Pyramid pyramid_;
};

/// Parameter: "cpu", "egl" or "osmesa".
class OnPointPasses : public OnGl {
  protected:
    void SetUp() override {
        if (GetParam() == "cpu") {
            passes_ = std::make_unique<PyramidRunner>();
            return;
        }
        OnGl::SetUp();
        if (IsSkipped() || HasFatalFailure()) return;
        slow_ = gl::describeDriver(shaders().functions())->software;
        passes_ = std::make_unique<GlPointPasses>(shaders());
    }
    void TearDown() override {
        passes_.reset();
        OnGl::TearDown();
    }
    std::unique_ptr<PointPasses> passes_;
    bool slow_ = false;  ///< a software driver: draw less
};

}  // namespace scancast::test
