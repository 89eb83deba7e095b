// Lists of screen passes on the GPU against the cpu device's, byte by byte; on drivers that round divisions
// and roots, to a step of colour.
#include "renderer/device/gl/passes/screen_passes.hpp"

#include <glm/geometric.hpp>
#include <limits>

#include "renderer/device/cpu/screen_passes.hpp"
#include "tests/support/pictures/analytic_cut.hpp"
#include "tests/support/pictures/on_gl.hpp"
#include "tests/support/pictures/point_accidents.hpp"

namespace scancast::test {
namespace {

/// What a list is run on: planes that are part of a larger picture, seen through a shifted axis.
struct Scene {
    Viewpoint viewpoint;
    int pad = 0;
    glm::dvec2 jitter{0};
    PixelPlanes planes;
    Viewpoint sun;
    std::vector<float> sunDepth;  ///< what it sees; empty: there is none

    LayerView layerView() const {
        LayerView s;
        s.viewpoint = &viewpoint;
        s.pad = pad;
        return s;
    }
};

/// Octahedral 16 + 16 bits, as the planes hold them; now and then none.
std::uint32_t randomNormal(Numbers& numbers) {
    if (numbers.uniform() < 0.1) return 0;
    return static_cast<std::uint32_t>(numbers.next()) | 0x00010001u;
}

Scene sceneOf(int width, int height, bool perspective, glm::dvec2 jitter, std::uint64_t seed) {
    const PointScreen points = accidents(width, height, perspective, 0.5, seed);
    Scene s;
    s.viewpoint.width = width + 40;
    s.viewpoint.height = height + 27;
    s.viewpoint.projection = perspective ? Projection::Perspective : Projection::Orthographic;
    s.viewpoint.pixelsPerUnit = points.pixelsPerUnit;
    s.pad = 5;
    s.jitter = jitter;
    s.planes = {{23, 11, width, height}, points.rgba, points.depth, points.normals};
    Numbers numbers(seed + 1);
    for (std::uint32_t& normal : s.planes.normals) normal = randomNormal(numbers);
    return s;
}

class GlScreenPasses : public OnGl {
  protected:
    void SetUp() override {
        OnGl::SetUp();
        if (IsSkipped() || HasFatalFailure()) return;
        buffers_.emplace(shaders().functions());
        pyramid_.emplace(shaders());
        timers_.emplace(shaders().functions());
        software_ = gl::describeDriver(shaders().functions())->software;
    }
    void TearDown() override {
        buffers_.reset();
        pyramid_.reset();
        timers_.reset();
        OnGl::TearDown();
    }

    PixelPlanes onGpu(const Scene& scene, std::span<const Pass> passes) {
        PixelPlanes planes = scene.planes;
        gl::StageTimes times(*timers_);
        gl::Buffer map(shaders().functions(), "map"), seen(shaders().functions(), "seen");
        const gl::GpuShadowMap sun{&scene.sun, &map, &seen};
        EXPECT_TRUE(map.write(std::as_bytes(std::span(scene.sunDepth))));
        auto done =
            gl::runScreenPasses(passes, scene.layerView(), scene.jitter, buffers_->upload(planes), shaders(),
                                *pyramid_, times, {}, scene.sunDepth.empty() ? nullptr : &sun);
        if (done) done = times.collect(stats_);
        EXPECT_TRUE(done) << done.error().message;
        buffers_->download(planes);
        return planes;
    }
    PixelPlanes onCpu(const Scene& scene, std::span<const Pass> passes) {
        PixelPlanes result = scene.planes;
        const glm::ivec4& a = result.area;
        cpu::Planes planes;
        planes.area = {a.x, a.y, a.x + a.z, a.y + a.w};
        planes.rgba = result.rgba.data();
        planes.depth = result.depth.data();
        planes.normals = result.normals.data();
        const cpu::Workers workers(arena_, 2, {});
        const cpu::ShadowMap sun{&scene.sun, scene.sunDepth.data()};
        cpu::runScreenPasses(passes, scene.layerView(), scene.jitter, planes, *kernels_, workers, memory_,
                             cpuStats_, scene.sunDepth.empty() ? nullptr : &sun);
        return result;
    }
    void expectTheSame(const Scene& scene, std::span<const Pass> passes) {
        const PixelPlanes there = onGpu(scene, passes), here = onCpu(scene, passes);
        const auto what = [&] {
            return std::to_string(scene.planes.area.z) + " x " + std::to_string(scene.planes.area.w);
        };
        if (software_) {
            ASSERT_EQ(differences(there.rgba, here.rgba), 0u) << what();
            ASSERT_EQ(differences(there.depth, here.depth), 0u) << what();
            ASSERT_EQ(differences(there.normals, here.normals), 0u) << what();
            return;
        }
        std::size_t apart = 0;
        for (std::size_t i = 0; i < there.rgba.size(); ++i) {
            int largest = 0;
            for (int shift = 0; shift < 32; shift += 8)
                largest = std::max(largest, std::abs(static_cast<int>(there.rgba[i] >> shift & 255) -
                                                     static_cast<int>(here.rgba[i] >> shift & 255)));
            apart += largest > 1 ? 1 : 0;
        }
        ASSERT_LE(apart, there.rgba.size() / 50) << what();
    }

    FrameStats stats_, cpuStats_;
    std::optional<gl::GpuTimers> timers_;

  private:
    std::optional<PlaneBuffers> buffers_;
    std::optional<gl::Pyramid> pyramid_;
    tbb::task_arena arena_{2};
    cpu::ScreenMemory memory_;
    const cpu::Kernels* kernels_ = cpu::chooseSimdLevel({}).value()->kernels;
    bool software_ = false;
};
INSTANTIATE_ON_GL(GlScreenPasses);

const Scene scenes[] = {sceneOf(131, 67, true, {0.25, -0.375}, 1), sceneOf(131, 67, false, {0, 0}, 2),
                        sceneOf(1, 1, true, {0, 0}, 3), sceneOf(33, 9, false, {-0.4, 0.1}, 4),
                        sceneOf(320, 240, true, {0.1, 0.2}, 5)};

TEST_P(GlScreenPasses, PhongIsTheCpus) {
    const PhongPass shiny{0.1f, 0.4f, 0.8f, 0.9f, {0.48f, -0.6f, 0.64f}};
    for (const Scene& scene : scenes) {
        expectTheSame(scene, PassList{PhongPass{}});
        expectTheSame(scene, PassList{shiny});
    }
}

TEST_P(GlScreenPasses, EyeDomeIsTheCpus) {
    for (const Scene& scene : scenes) {
        for (const EyeDomePass pass :
             {EyeDomePass{}, EyeDomePass{2, 4.5f}, EyeDomePass{0.01f, 64}, EyeDomePass{1000, 0}}) {
            expectTheSame(scene, PassList{pass});
        }
    }
}

/// What a sun above and behind the viewer may see of where the scenes' points lie.
Scene sunny(Scene scene) {
    scene.sun = lookAtOrthographic({9, 12, 5}, {0, 0, -4}, 97, 61, 14);
    Numbers numbers(61);
    scene.sunDepth.resize(std::size_t{97} * 61);
    for (float& depth : scene.sunDepth)
        depth = numbers.uniform() < 0.1 ? std::numeric_limits<float>::infinity()
                                        : static_cast<float>(numbers.uniform(12, 20));
    return scene;
}

TEST_P(GlScreenPasses, ShadowsAreTheCpus) {
    PhongPass lit{0.3f, 0.2f, 0.8f, 0.1f, {0.48f, -0.6f, 0.64f}, true};
    for (const Scene& scene : scenes) {
        const Scene shaded = sunny(scene);
        expectTheSame(shaded, PassList{ShadowPass{0.8f, 0.6f, 0.05f}});
        expectTheSame(shaded, PassList{ShadowPass{1, 0, 0.05f}, lit});
        expectTheSame(scene, PassList{ShadowPass{1, 0.5f, 0.05f}, lit});  // there is no sun
    }
    const Scene shaded = sunny(scenes[4]);
    EXPECT_GT(differences(onCpu(shaded, PassList{ShadowPass{1, 1, 0.05f}}).rgba, shaded.planes.rgba), 1000u)
        << "nothing was in the shadow";
}

TEST_P(GlScreenPasses, OcclusionIsTheCpus) {
    for (const Scene& scene : scenes) {
        for (const OcclusionPass pass :
             {OcclusionPass{}, OcclusionPass{0.3f, 7}, OcclusionPass{1, 1000}, OcclusionPass{1, 0}}) {
            expectTheSame(scene, PassList{pass});
        }
    }
}

PassList everything() {
    HiddenPointsPass hide;
    hide.spacing = 0.06f;
    hide.minGap = 0.18f;
    DepthNormalsPass normals;
    normals.spacing = hide.spacing;
    return {hide, PullPushPass{}, normals, PhongPass{}, EyeDomePass{}, OcclusionPass{}};
}

TEST_P(GlScreenPasses, AllAfterOneAnotherAreTheCpus) {
    for (const Scene& scene : scenes) expectTheSame(scene, everything());
}

TEST_P(GlScreenPasses, TellTheSameStages) {
    PassList passes = everything();
    passes.insert(passes.begin(), {NearestPass{}, ResolvePass{}});  // not ours
    expectTheSame(scenes[0], passes);
    ASSERT_EQ(stats_.stages.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(stats_.stages[i].name, cpuStats_.stages[i].name);
}

TEST_P(GlScreenPasses, AreAbandonedWhenAsked) {
    std::stop_source stop;
    stop.request_stop();
    PlaneBuffers buffers(shaders().functions());
    gl::Pyramid pyramid(shaders());
    gl::StageTimes times(*timers_);
    const auto done =
        gl::runScreenPasses(everything(), scenes[0].layerView(), {}, buffers.upload(scenes[0].planes),
                            shaders(), pyramid, times, stop.get_token());
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace scancast::test
