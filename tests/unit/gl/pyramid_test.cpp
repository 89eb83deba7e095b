// The passes of docs/spec/pyramid.md §1 on the GPU against those of the cpu device, word by word: where
// divisions and roots are exact, as they are on the software driver, both compute the same. Others round:
// there nearly all labels, and colours and normals to a step or two.
#include "renderer/device/gl/passes/pyramid.hpp"

#include <gmock/gmock.h>

#include <glm/geometric.hpp>

#include "tests/support/pictures/on_gl.hpp"
#include "tests/support/pictures/point_accidents.hpp"

namespace scancast::test {
namespace {

class GlPyramid : public OnGl {
  protected:
    void SetUp() override {
        OnGl::SetUp();
        if (IsSkipped() || HasFatalFailure()) return;
        const gl::GlFunctions& functions = shaders().functions();
        buffers_.emplace(functions);
        pyramid_.emplace(shaders());
        software_ = gl::describeDriver(functions)->software;
    }
    void TearDown() override {
        buffers_.reset();
        pyramid_.reset();
        OnGl::TearDown();
    }

    gl::Pyramid& pyramid() { return *pyramid_; }
    /// What PyramidRunner does, there.
    PointScreen onGpu(PointScreen s, const HiddenPointsPass& hide, const DepthNormalsPass& normals) {
        PixelPlanes planes{{0, 0, s.width, s.height}, s.rgba, s.depth, s.normals};
        const gl::GpuPlanes there = buffers_->upload(planes);
        const PyramidView view = s.planes();
        std::vector<std::uint32_t> labels(planes.pixels());
        for (const auto& done : {pyramid_->hidePoints(there, view, hide), pyramid_->fill(there, view),
                                 pyramid_->findNormals(there, view, normals)}) {
            EXPECT_TRUE(done) << done.error().message;
        }
        EXPECT_TRUE(gl::checkErrors(shaders().functions(), "testing"));
        pyramid_->labels().read(std::as_writable_bytes(std::span(labels)));
        buffers_->download(planes);
        s.labels.assign(labels.begin(), labels.end());
        s.rgba = std::move(planes.rgba);
        s.depth = std::move(planes.depth);
        s.normals = std::move(planes.normals);
        return s;
    }
    PointScreen onCpu(PointScreen s, const HiddenPointsPass& hide, const DepthNormalsPass& normals) {
        cpu_.hidePoints(s, hide);
        cpu_.fill(s, {});
        cpu_.findNormals(s, normals);
        return s;
    }
    void expectTheSame(const PointScreen& s, const HiddenPointsPass& hide, const std::string& what) {
        DepthNormalsPass normals;
        normals.spacing = hide.spacing;
        normals.detail = hide.detail;
        const PointScreen there = onGpu(s, hide, normals), here = onCpu(s, hide, normals);
        std::size_t labels = 0;
        for (std::size_t i = 0; i < s.depth.size(); ++i) labels += there.labels[i] != here.labels[i] ? 1 : 0;
        if (software_) {
            ASSERT_EQ(labels, 0u) << what;
            ASSERT_EQ(differences(there.rgba, here.rgba), 0u) << what;
            ASSERT_EQ(differences(there.depth, here.depth), 0u) << what;
            ASSERT_EQ(differences(there.normals, here.normals), 0u) << what;
        } else {
            ASSERT_LE(labels, s.depth.size() / 500) << what;
            ASSERT_LE(farApart(there, here), s.depth.size() / 100) << what;
        }
    }

  private:
    /// Pixels whose depth, colour or normal is another one, beyond rounding.
    static std::size_t farApart(const PointScreen& a, const PointScreen& b) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < a.depth.size(); ++i) {
            bool apart = !(a.depth[i] == b.depth[i] || std::abs(a.depth[i] / b.depth[i] - 1) < 1e-5);
            for (int shift = 0; shift < 32; shift += 8) {
                const auto channel = [&](std::uint32_t rgba) {
                    return static_cast<int>(rgba >> shift & 255);
                };
                apart |= std::abs(channel(a.rgba[i]) - channel(b.rgba[i])) > 1;
            }
            apart |= glm::distance(normalOf(a.normals[i]), normalOf(b.normals[i])) > 0.01;
            count += apart ? 1 : 0;
        }
        return count;
    }

    std::optional<PlaneBuffers> buffers_;
    std::optional<gl::Pyramid> pyramid_;
    PyramidRunner cpu_;
    bool software_ = false;
};
INSTANTIATE_ON_GL(GlPyramid);

std::string nameOf(const AccidentCase& c) {
    return std::to_string(c.width) + " x " + std::to_string(c.height) +
           (c.perspective ? "" : ", orthographic");
}

// One after the other on the same object, larger and smaller ones by turns.
TEST_P(GlPyramid, ComputesWhatTheCpuDoes) {
    for (const AccidentCase& c : accidentCases) {
        for (const float threshold : {0.1f, 0.02f, 0.3f, 1.5f}) {
            const PointScreen s = accidents(c.width, c.height, c.perspective, c.cover, 7);
            expectTheSame(s, hiding(c, threshold), nameOf(c) + ", threshold " + std::to_string(threshold));
        }
    }
}

TEST_P(GlPyramid, ComputesWhatTheCpuDoesInFixedNeighbourhoods) {
    for (const AccidentCase& c : accidentCases) {
        const PointScreen s = accidents(c.width, c.height, c.perspective, c.cover, 7);
        HiddenPointsPass pass = hiding(c);
        for (const float px : {1.0f, 20.0f}) {
            pass.fixedPx = px;
            expectTheSame(s, pass, nameOf(c) + ", fixed");
        }
    }
}

// Several tiles of work groups on each axis, and pyramids of more levels than one dispatch makes.
TEST_P(GlPyramid, ComputesWhatTheCpuDoesOnLargePictures) {
    const AccidentCase cases[] = {{1313, 333, true, 0.1, 0.02f, 1},
                                  {401, 520, false, 0.2, 0.4f, 0},
                                  {4200, 70, true, 0.3, 0.005f, 0.7f},
                                  {129, 257, true, 0.01, 5.0f, 0}};
    for (const AccidentCase& c : cases) {
        const PointScreen s = accidents(c.width, c.height, c.perspective, c.cover, 8);
        expectTheSame(s, hiding(c), nameOf(c));
    }
}

// Surfaces as they are seen: a tilted plane in front of another one, both sparse.
TEST_P(GlPyramid, ComputesWhatTheCpuDoesOnSurfaces) {
    for (const bool perspective : {true, false}) {
        PointScreen s(320, 200, perspective, perspective ? 250 : 30);
        Numbers numbers(9);
        sheet(9, 8, 6, 0.07, 0.01, numbers, [&](const ScreenPoint& p) { s.add(p, 0, 0xff2060a0u); });
        sheet(5, 2, 1.5, 0.06, 0.01, numbers, [&](ScreenPoint p) {
            p.depth += 0.4 * p.x;
            s.add(p, 1, 0xffa06020u);
        });
        HiddenPointsPass hide;
        hide.spacing = 0.07f;
        hide.minGap = 0.21f;
        expectTheSame(s, hide, perspective ? "perspective" : "orthographic");
    }
}

TEST_P(GlPyramid, HidesNothingWithoutPoints) {
    for (const float spacing : {0.1f, 1e30f}) {
        HiddenPointsPass pass;
        pass.spacing = spacing;
        expectTheSame(PointScreen(90, 60, true, 80), pass, "background only");
    }
}

TEST_P(GlPyramid, HostileNumbersEndInTheSamePicture) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (const float spacing : {0.0f, 1e-30f, 1e30f, inf, nan, -1.0f}) {
        for (const float detail : {0.0f, 1e20f, nan}) {
            HiddenPointsPass pass;
            pass.spacing = spacing;
            pass.detail = detail;
            expectTheSame(accidents(70, 50, true, 0.4, 12), pass,
                          "spacing " + std::to_string(spacing) + ", detail " + std::to_string(detail));
        }
    }
}

TEST_P(GlPyramid, SaysWhenAPictureIsTooLarge) {
    PyramidView view;
    view.width = 100000;
    view.height = 80000;
    const auto done = pyramid().hidePoints({}, view, {});
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, ErrorCode::ResourceLimit);
    EXPECT_THAT(done.error().message, testing::HasSubstr("100000 x 80000 px"));
    // And goes on with the next one.
    expectTheSame(accidents(70, 50, true, 0.4, 12), hiding(accidentCases[0]), "after too large a one");
}

}  // namespace
}  // namespace scancast::test
