#pragma once

// A layer drawn by both devices, bare: the cpu device's layer and the gl device's, with limits of a test's choice, into planes that a test reads.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "renderer/device/cpu/layer.hpp"
#include "renderer/device/cpu/simd_level.hpp"
#include "renderer/device/gl/context/egl_context.hpp"
#include "renderer/device/gl/context/osmesa_context.hpp"
#include "renderer/device/gl/passes/layer.hpp"
#include "renderer/method/method.hpp"
#include "tests/support/pictures/analytic_cut.hpp"
#include "tests/support/pictures/draw_surfels.hpp"
#include "tests/support/pictures/faded_cut.hpp"
#include "tests/support/pictures/gl_context_test.hpp"

namespace scancast::test {

using gl::ivec4;

/// What a layer leaves.
struct Pixels {
    std::vector<std::uint32_t> rgba, depth, normals;
};

/// A layer to be drawn.
struct LayerCase {
    Drawing drawing;
    FramePasses passes;
    LayerView layerView;
    ivec4 area;
    glm::dvec2 jitter{0.25, -0.4375};
};

inline LayerCase layerCase(const Drawing& drawing) {
    LayerCase c;
    c.drawing = drawing;
    c.passes = framePasses(drawing.passes).value();
    c.layerView = {&drawing.mainView().viewpoint, c.passes.guardBand(), drawing.surfels, drawing.oriented};
    const Window& w = drawing.window;
    c.area = {w.x + c.layerView.pad, w.y + c.layerView.pad, w.width, w.height};
    return c;
}

inline std::size_t pixelsOf(const LayerCase& c) {
    return static_cast<std::size_t>(c.area.z) * static_cast<std::size_t>(c.area.w);
}

inline Pixels drawOnCpu(const LayerCase& c) {
    tbb::task_arena arena(1);
    const cpu::Workers workers(arena, 1, {});
    cpu::TileMemories memories;
    memories.push_back(std::make_unique<cpu::TileMemory>());
    const cpu::Rect area{c.area.x, c.area.y, c.area.x + c.area.z, c.area.y + c.area.w};
    cpu::Layer layer(c.drawing, c.drawing.mainView(), c.layerView, c.passes,
                     *cpu::chooseSimdLevel("").value()->kernels, workers, memories, area);
    const std::vector<std::uint32_t> none(pixelsOf(c));
    Pixels out{none, none, none};
    FrameStats stats;
    layer.draw(c.jitter,
               {area, out.rgba.data(), reinterpret_cast<float*>(out.depth.data()), out.normals.data()},
               stats);
    return out;
}

/// Everything that a layer needs of a device, with limits of the test's choice.
class GlLayers : public testing::Environment {
  public:
    struct Backend {
        std::unique_ptr<gl::Context> context;
        std::optional<gl::Programs> programs;
    };

    void TearDown() override {
        for (auto& [name, backend] : backends_) {
            if (!backend.context) continue;
            const auto current = gl::Context::Current::enter(*backend.context);
            backend.programs.reset();
        }
        backends_.clear();
    }

    Backend& get(const std::string& name, std::string& reason) {
        Backend& backend = backends_[name];
        if (backend.context) return backend;
        auto opened = name == "egl" ? gl::createEglContext() : gl::createOsmesaContext();
        if (!opened) {
            reason = opened.error().message;
            return backend;
        }
        backend.context = std::move(*opened);
        const auto current = gl::Context::Current::enter(*backend.context);
        gl::logDriverMessages(backend.context->functions());
        backend.programs.emplace(backend.context->functions(), std::filesystem::path());
        return backend;
    }

  private:
    std::map<std::string, Backend> backends_;
};
/// Owned by GoogleTest.
inline GlLayers* const glLayers = [] {
    auto* const layers = new GlLayers;
    testing::AddGlobalTestEnvironment(layers);
    return layers;
}();

struct GlLimitsOfTest {
    std::size_t storageBlockBytes = std::size_t{128} << 20;
    gl::SampleCacheOptions samples{std::uint64_t{64} << 20, 0};
    std::optional<std::size_t> texels;
    bool exactDoubles = true;  ///< the GPU composes runs; else the host does
    bool software = true;      ///< work is cut as for a rasteriser on the CPU, or as for a GPU
    std::optional<std::uint32_t> tileBytes;
    bool countAdds = false;
};

inline gl::SplatLimits splatLimits(const gl::GlFunctions& functions, const GlLimitsOfTest& of) {
    gl::SplatLimits limits = gl::splatLimits(functions, of.software);
    limits.storageBlockBytes = of.storageBlockBytes;
    if (of.texels) limits.texels = *of.texels;
    if (of.tileBytes) limits.tileBytes = *of.tileBytes;
    limits.countAdds = of.countAdds;
    return limits;
}

/// The layer on the GPU and the planes that it is drawn into, which reach `border` pixels beyond its area.
struct GlDrawing {
    static constexpr std::uint32_t untouched = 0x12345678;

    /// `instead`: of the backend's own functions.
    GlDrawing(GlLayers::Backend& backend, const LayerCase& what, const GlLimitsOfTest& limits, int border = 0,
              const gl::GlFunctions* instead = nullptr)
        : c(what),
          functions(instead ? *instead : backend.context->functions()),
          screen(functions, *backend.programs),
          samples(functions, limits.samples),
          slices(functions),
          memory(functions, splatLimits(functions, limits)),
          parts{functions, *backend.programs, screen, samples, slices, memory, tables, limits.exactDoubles},
          planes{ivec4(c.area.x - border, c.area.y - border, c.area.z + 2 * border, c.area.w + 2 * border),
                 &rgba, &depth, &normals} {}

    void draw(const std::stop_token& stop = {}) {
        for (gl::Buffer* buffer : {&rgba, &depth, &normals}) {
            ASSERT_TRUE(buffer->reserve(planes.pixels() * 4));
            buffer->clear(planes.pixels(), untouched);
        }
        auto layer = gl::Layer::create(parts, c.drawing, c.drawing.mainView(), c.layerView, c.passes, c.area);
        ASSERT_TRUE(layer) << layer.error().message;
        gl::GpuTimers timers(functions);
        gl::StageTimes times(timers);
        drawn = (*layer)->draw(c.jitter, planes, times, stop);
    }
    std::vector<std::uint32_t> read(const gl::Buffer& plane) const {
        std::vector<std::uint32_t> words(planes.pixels());
        plane.read(std::as_writable_bytes(std::span(words)));
        return words;
    }

    const LayerCase& c;
    const gl::GlFunctions& functions;
    gl::ScreenShaders screen;
    gl::SampleCache samples;
    gl::Slices slices;
    gl::SplatMemory memory;
    gl::StagingRing ring{functions, 1 << 20};
    gl::LayerMemory tables{functions, ring};
    gl::LayerParts parts;
    gl::Buffer rgba{functions, "rgba"}, depth{functions, "depth"}, normals{functions, "normals"};
    gl::GpuPlanes planes;
    Expected<void> drawn;
};

inline void drawOnGl(GlLayers::Backend& backend, const LayerCase& c, const GlLimitsOfTest& limits,
                     Pixels& out) {
    const auto current = gl::Context::Current::enter(*backend.context);
    ASSERT_TRUE(current) << current.error().message;
    GlDrawing gl(backend, c, limits);
    gl.draw();
    ASSERT_TRUE(gl.drawn) << gl.drawn.error().message;
    out = {gl.read(gl.rgba), gl.read(gl.depth), gl.read(gl.normals)};
}

inline std::size_t differing(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i];
    return count;
}

inline std::size_t covered(const Pixels& p) {
    return static_cast<std::size_t>(
        std::ranges::count_if(p.depth, [](std::uint32_t bits) { return bits < 0x7f800000; }));
}

#define REQUIRE_BACKEND(NAME, BACKEND)                              \
    std::string NAME##Reason;                                       \
    GlLayers::Backend& NAME = glLayers->get(BACKEND, NAME##Reason); \
    if (!NAME.context) GTEST_SKIP() << "MISSING BACKEND " << (BACKEND) << ": " << NAME##Reason

inline void expectTheSame(GlLayers::Backend& backend, const LayerCase& c, const GlLimitsOfTest& limits = {}) {
    const Pixels cpu = drawOnCpu(c);
    Pixels gl;
    drawOnGl(backend, c, limits, gl);
    ASSERT_EQ(gl.rgba.size(), pixelsOf(c));
    EXPECT_GT(covered(cpu), pixelsOf(c) / 100) << "a picture of nothing proves nothing";
    EXPECT_EQ(differing(cpu.depth, gl.depth), 0u) << "depths";
    EXPECT_EQ(differing(cpu.rgba, gl.rgba), 0u) << "colours";
    if (c.passes.resolve.normals) {
        EXPECT_EQ(differing(cpu.normals, gl.normals), 0u) << "normals";
    }
}

/// A shaken ball before a tilted wall, with surfels of many sizes, ellipses in all directions, some outliers,
/// samples without a normal or a radius, and a few that are very near.
inline AnalyticCloud scene() {
    Numbers numbers(17);
    std::vector<AnalyticPoint> points;
    const auto add = [&](const glm::dvec3& position, const glm::dvec3& normal, double radius) {
        AnalyticPoint p;
        p.position = position;
        p.rgb = numbers.color();
        p.intensity = static_cast<std::uint16_t>(numbers.next());
        p.classification = static_cast<std::uint8_t>(numbers.next() % 20);
        const glm::dvec3 tilted = glm::normalize(normal + 0.2 * numbers.onSphere());
        const glm::dvec3 along = glm::normalize(glm::cross(tilted, numbers.onSphere()));
        p.surfel = surfelOf(tilted, radius * numbers.uniform(0.4, 2.2), along, numbers.uniform(0.25, 1));
        p.surfel->outlier = numbers.uniform() < 0.03;
        p.surfel->bend = glm::vec3(0.4 / radius * numbers.onSphere());
        if (numbers.uniform() < 0.03) p.surfel->normal = glm::vec3(0);
        if (numbers.uniform() < 0.03) p.surfel.reset();
        points.push_back(p);
    };
    for (int i = 0; i < 6000; ++i) {
        const glm::dvec3 n = numbers.onSphere();
        add(n * numbers.uniform(0.97, 1.02), n, 0.05);
    }
    for (int i = 0; i < 4000; ++i)
        add({numbers.uniform(-3, 3), 1.6 + 0.5 * numbers.uniform(-1, 1), numbers.uniform(-2, 2)},
            {0.447, -0.894, 0}, 0.09);
    for (int i = 0; i < 40; ++i) add(glm::dvec3(0.3, -3.6, 1) + 0.3 * numbers.onSphere(), {0, -1, 0}, 0.05);
    return AnalyticCloud(points, 0.06, 1500);
}

inline const AnalyticCloud& sharedScene() {
    static const AnalyticCloud cloud = scene();
    return cloud;
}

inline Viewpoint viewpoint(Projection projection) {
    constexpr int width = 187, height = 141;  // no multiple of any work group
    return projection == Projection::Perspective
               ? lookAt({0.3, -4, 1}, {0, 0, 0}, width, height, 50)
               : lookAtOrthographic({0.3, -4, 1}, {0, 0, 0}, width, height, 3.2);
}

struct MethodCase {
    const char* method;
    ParameterValues parameters;
    const char* label;
    bool normals = false;  ///< its splats know theirs, so it is lit differently
};
inline void PrintTo(const MethodCase& c, std::ostream* out) {
    *out << c.label;
}

inline PassList passesOf(const MethodCase& c, Shading shading) {
    const Method* method = findMethod(c.method);
    if (!method) throw std::runtime_error(std::string("no method ") + c.method);
    const auto values = resolveParameters(*method, c.parameters);
    if (!values) throw std::runtime_error(values.error().message);
    return method->passes({*method, *values, shading});
}

/// One method of each kind of pass, and everything else varied.
class LayerDrawing : public testing::TestWithParam<std::string> {
  protected:
    static inline const MethodCase sprites{"paraboloid", {}, ""}, blended{"hqs", {}, ""},
        cells{"voronoi", {{"smooth", true}}, ""};
    const Viewpoint from_ = viewpoint(Projection::Perspective);
    const GlLimitsOfTest limits_;

    /// Draws the methods after `change` had its way with the drawing.
    template <class Change>
    void check(std::initializer_list<MethodCase> methods, const Change& change, const Cut* cut = nullptr,
               std::optional<GlLimitsOfTest> limits = {}) {
        REQUIRE_BACKEND(backend, GetParam());
        for (const MethodCase& method : methods) {
            SCOPED_TRACE(method.method);
            SurfelScene s(from_, cut ? *cut : sharedScene().cut(), passesOf(method, Shading::Phong));
            change(s.drawing);
            expectTheSame(backend, layerCase(s.drawing), limits.value_or(limits_));
        }
    }
};

}  // namespace scancast::test
