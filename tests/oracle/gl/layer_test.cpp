// Layer against layer: what the gl device splats and resolves is, on Mesa's rasteriser, byte for byte what
// the cpu device does - colours, depths and normals, for the passes of every method. Right because both do
// the same float operations in the same order (`precise`, no contraction), their reductions are integers, and
// nothing else is shared.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <cstring>
#include <tuple>

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
namespace {

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

LayerCase layerCase(const Drawing& drawing) {
    LayerCase c;
    c.drawing = drawing;
    c.passes = framePasses(drawing.passes).value();
    c.layerView = {&drawing.mainView().viewpoint, c.passes.guardBand(), drawing.surfels, drawing.oriented};
    const Window& w = drawing.window;
    c.area = {w.x + c.layerView.pad, w.y + c.layerView.pad, w.width, w.height};
    return c;
}

std::size_t pixelsOf(const LayerCase& c) {
    return static_cast<std::size_t>(c.area.z) * static_cast<std::size_t>(c.area.w);
}

Pixels drawOnCpu(const LayerCase& c) {
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
GlLayers* const glLayers = [] {
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

gl::SplatLimits splatLimits(const gl::GlFunctions& functions, const GlLimitsOfTest& of) {
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

void drawOnGl(GlLayers::Backend& backend, const LayerCase& c, const GlLimitsOfTest& limits, Pixels& out) {
    const auto current = gl::Context::Current::enter(*backend.context);
    ASSERT_TRUE(current) << current.error().message;
    GlDrawing gl(backend, c, limits);
    gl.draw();
    ASSERT_TRUE(gl.drawn) << gl.drawn.error().message;
    out = {gl.read(gl.rgba), gl.read(gl.depth), gl.read(gl.normals)};
}

std::size_t differing(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i];
    return count;
}

std::size_t covered(const Pixels& p) {
    return static_cast<std::size_t>(
        std::ranges::count_if(p.depth, [](std::uint32_t bits) { return bits < 0x7f800000; }));
}

#define REQUIRE_BACKEND(NAME, BACKEND)                              \
    std::string NAME##Reason;                                       \
    GlLayers::Backend& NAME = glLayers->get(BACKEND, NAME##Reason); \
    if (!NAME.context) GTEST_SKIP() << "MISSING BACKEND " << (BACKEND) << ": " << NAME##Reason

void expectTheSame(GlLayers::Backend& backend, const LayerCase& c, const GlLimitsOfTest& limits = {}) {
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
AnalyticCloud scene() {
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

const AnalyticCloud& sharedScene() {
    static const AnalyticCloud cloud = scene();
    return cloud;
}

Viewpoint viewpoint(Projection projection) {
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
void PrintTo(const MethodCase& c, std::ostream* out) {
    *out << c.label;
}

const MethodCase spriteCases[] = {
    {"point", {}, "point"},
    {"square", {}, "square"},
    {"circle", {}, "circle"},
    {"paraboloid", {}, "paraboloid"},
    {"cone", {}, "cone"},
    {"sphere", {}, "sphere"},
    {"sphere", {{"sizePx", 23.0}}, "sphere23px"},
    {"cone", {{"sizePx", 4.0}, {"footprint", std::string("square")}}, "coneOnSquares"},
    {"paraboloid", {{"sizePx", 26.5}, {"footprint", std::string("square")}}, "paraboloidOnSquares"},
    {"hqs", {}, "hqs", true},
    {"hqs", {{"sizePx", 21.0}}, "hqs21px", true},
};
const MethodCase surfelCases[] = {
    {"disc", {}, "disc", true},
    {"disc", {{"maxPx", 9.0}, {"cull", false}}, "smallDisc", true},
    {"ewa", {}, "ewa", true},
    {"disc", {{"curved", false}}, "flatDisc", true},
    {"ewa", {{"curved", true}}, "curvedEwa", true},
    {"ewa", {{"lowPass", 2.0}, {"scale", 3.0}}, "blurredEwa", true},
    {"voronoi", {{"smooth", false}}, "voronoiFlat", true},
    {"voronoi", {{"smooth", true}}, "voronoiSmooth", true},
    {"voronoi", {{"smooth", true}, {"silhouette", true}, {"tolerance", 0.5}}, "voronoiSilhouette", true},
};

PassList passesOf(const MethodCase& c, Shading shading) {
    const Method* method = findMethod(c.method);
    if (!method) throw std::runtime_error(std::string("no method ") + c.method);
    const auto values = resolveParameters(*method, c.parameters);
    if (!values) throw std::runtime_error(values.error().message);
    return method->passes({*method, *values, shading});
}

using AgreementCase = std::tuple<std::string, MethodCase, Projection>;
class GlLayer : public testing::TestWithParam<AgreementCase> {};

TEST_P(GlLayer, LeavesTheBytesOfTheCpuDevice) {
    const auto& [backendName, method, projection] = GetParam();
    REQUIRE_BACKEND(backend, backendName);
    const Viewpoint from = viewpoint(projection);
    const auto check = [&](Shading shading, bool oriented) {
        SCOPED_TRACE(std::string(name(shading)) + (oriented ? ", oriented" : ""));
        SurfelScene s(from, sharedScene().cut(), passesOf(method, shading));
        s.drawing.oriented = oriented;
        expectTheSame(backend, layerCase(s.drawing));
    };
    check(Shading::Unlit, false);
    if (!method.normals) return;
    check(Shading::Phong, false);
    check(Shading::Phong, true);
}

std::string labelOf(const testing::TestParamInfo<AgreementCase>& c) {
    return std::get<0>(c.param) + "_" + std::get<1>(c.param).label + "_" +
           std::string(name(std::get<2>(c.param)));
}
const auto bothProjections = testing::Values(Projection::Perspective, Projection::Orthographic);

// Two suites, since most of their time is compiling shaders, wherever the driver has none of them in its cache yet.
INSTANTIATE_TEST_SUITE_P(GlSprites, GlLayer,
                         testing::Combine(testing::Values("egl"), testing::ValuesIn(spriteCases),
                                          bothProjections),
                         labelOf);
INSTANTIATE_TEST_SUITE_P(GlSurfels, GlLayer,
                         testing::Combine(testing::Values("egl"), testing::ValuesIn(surfelCases),
                                          bothProjections),
                         labelOf);

/// One method of each kind of pass, and everything else varied.
class GlLayerDrawing : public testing::TestWithParam<std::string> {
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
INSTANTIATE_TEST_SUITE_P(Gl, GlLayerDrawing, testing::Values("egl"),
                         [](const testing::TestParamInfo<std::string>& c) { return c.param; });

/// Looked up while splatting, for sums, and by ordinal.
TEST_P(GlLayerDrawing, EveryColorSource) {
    for (const ColorSource source :
         {ColorSource::Intensity, ColorSource::Elevation, ColorSource::Classification, ColorSource::Normal,
          ColorSource::Curvature, ColorSource::Infrared, ColorSource::Depth, ColorSource::Lod,
          ColorSource::Flat}) {
        SCOPED_TRACE(std::string(name(source)));
        check({sprites, {"voronoi", {{"smooth", false}}, ""}}, [&](OwnDrawing& d) {
            d.color.source = source;
            d.color.low = source == ColorSource::Intensity ? 5000 : -0.7;
            d.color.high = source == ColorSource::Intensity ? 60000 : 4.3;
            d.color.flat = {10, 200, 90};
            for (std::size_t i = 0; i < 256; ++i) {
                const auto level = static_cast<std::uint8_t>(i);
                d.color.ramp[i] = {level, static_cast<std::uint8_t>(255 - level),
                                   static_cast<std::uint8_t>(7 * i)};
            }
        });
    }
    check({sprites, {"voronoi", {{"smooth", false}}, ""}}, [](OwnDrawing& d) {
        d.color.toned = true;
        for (std::size_t i = 0; i < 256; ++i) d.color.ramp[i].fill(static_cast<std::uint8_t>(255 - i));
        d.color.byIntensity = factors(5000, 60000);
    });
}

TEST_P(GlLayerDrawing, ClassesClipBoxAndDroppedRegions) {
    check({sprites, cells}, [](OwnDrawing& d) {
        d.view().filter.classes.emplace();
        for (std::size_t c = 0; c < 256; c += 2) (*d.view().filter.classes)[c] = true;
    });
    check({sprites, blended}, [](OwnDrawing& d) {
        d.view().filter.clip = ClipBox{{-0.6, -2, -0.8}, {0.9, 3, 0.7}};
        Region wedge;
        wedge.planes[0] = {0.6, 0, 0.8, -0.2};
        wedge.planes[1] = {0, -1, 0, 0.1};
        wedge.count = 2;
        Region slab;
        slab.planes[0] = {1, 0, 0, 0.4};
        slab.planes[1] = {-1, 0, 0, -0.2};
        slab.count = 2;
        d.view().filter.dropped = {wedge, slab};
    });
    check({sprites, cells}, [](OwnDrawing& d) {
        d.view().filter.shapes =
            clipRegions(ClipShapes{TurnedBox{{0, 0, 0}, {1.5, 2, 1}, {30, 20, 10}},
                                   TurnedBox{{0.3, 0.5, 0}, {1, 1, 2}, {70, 0, 0}},
                                   TurnedBox{{0.1, 0.2, 0.1}, {0.4, 0.5, 0.6}, {15, 0, 0}, true},
                                   HalfSpace{{0, 0, 0.7}, {0, 0, -1}}},
                        {});
    });
}

TEST_P(GlLayerDrawing, OutliersWhereAskedFor) {
    check({sprites, blended, cells}, [](OwnDrawing& d) { d.view().filter.outliers = true; });
}

TEST_P(GlLayerDrawing, RunsDrawnInPart) {
    const Cut faded = withShares(sharedScene().cut());
    check(
        {sprites, cells}, [](OwnDrawing&) {}, &faded);
}

TEST_P(GlLayerDrawing, WindowsNearAndFarAndBackgrounds) {
    Viewpoint near = from_;
    near.near = 3.1;
    near.far = 4.6;
    check({sprites, blended, cells}, [&](OwnDrawing& d) {
        d.view().viewpoint = near;
        d.window = {37, 21, 90, 83};
        d.background.kind = Background::Kind::Gradient;
        d.background.bottom = {200, 100, 50};
    });
}

/// Each picture has a layer of its own, and its tables are made anew, in the buffers of the one before: the
/// same picture again needs others.
TEST_P(GlLayerDrawing, PicturesAfterTheFirstMakeNoBuffers) {
    REQUIRE_BACKEND(backend, GetParam());
    const auto current = gl::Context::Current::enter(*backend.context);
    ASSERT_TRUE(current);
    SurfelScene s(from_, sharedScene().cut(), passesOf(cells, Shading::Unlit));
    const LayerCase c = layerCase(s.drawing);
    gl::NotedGl noting(backend.context->functions());
    GlDrawing gl(backend, c, {}, 0, &noting.functions);
    gl.draw();
    ASSERT_TRUE(gl.drawn) << gl.drawn.error().message;
    const int first = noting.noted.created;
    EXPECT_GE(first, 5) << "a layer's tables at least";
    const std::vector<std::uint32_t> rgba = gl.read(gl.rgba);
    for (int i = 0; i < 3; ++i) {
        gl.draw();
        ASSERT_TRUE(gl.drawn);
        EXPECT_EQ(gl.read(gl.rgba), rgba);
    }
    EXPECT_EQ(noting.noted.created, first);
}

/// Where doubles do not round as the processor's, runs are composed by the host: the same bytes.
TEST_P(GlLayerDrawing, RunsComposedByTheHost) {
    GlLimitsOfTest limits;
    limits.exactDoubles = false;
    check(
        {sprites}, [](OwnDrawing&) {}, nullptr, limits);
}

/// Of the same runs, from elsewhere, the GPU learns where from, and nothing else. The oracle is the cpu device.
TEST_P(GlLayerDrawing, WhatStaysIsToldOnce) {
    REQUIRE_BACKEND(backend, GetParam());
    const auto current = gl::Context::Current::enter(*backend.context);
    ASSERT_TRUE(current);
    Cut cut = sharedScene().cut();
    cut.source = newSource();
    SurfelScene s(from_, cut, passesOf(sprites, Shading::Unlit));
    LayerCase c = layerCase(s.drawing);
    gl::NotedGl noting(backend.context->functions());
    GlDrawing gl(backend, c, {}, 0, &noting.functions);
    const auto told = [&] {
        const GLsizeiptr before = noting.noted.copied;
        gl.draw();
        EXPECT_TRUE(gl.drawn);
        const Pixels cpu = drawOnCpu(c);
        EXPECT_EQ(differing(cpu.depth, gl.read(gl.depth)), 0u) << "depths";
        EXPECT_EQ(differing(cpu.rgba, gl.read(gl.rgba)), 0u) << "colours";
        return noting.noted.copied - before;
    };
    Viewpoint& viewpoint = s.drawing.view().viewpoint;
    EXPECT_GT(told(), 0);
    viewpoint = lookAt({0.5, -4, 1}, {0, 0, 0}, viewpoint.width, viewpoint.height, 50);
    EXPECT_EQ(told(), 0) << "moved by three degrees";
    viewpoint = lookAt({4, 0, 1}, {0, 0, 0}, viewpoint.width, viewpoint.height, 50);
    const GLsizeiptr reordered = told();
    EXPECT_GT(reordered, 0) << "from the side: another order";
    c.drawing.color.low = 0.25;
    EXPECT_GT(told(), 0) << "another range";
    EXPECT_EQ(told(), 0);
}

/// A storage block that holds a third of the picture's sums: bands of rows.
TEST_P(GlLayerDrawing, BandByBand) {
    GlLimitsOfTest limits;
    limits.storageBlockBytes = 500'000;
    check(
        {blended, cells}, [](OwnDrawing&) {}, nullptr, limits);
    // So few texels as no driver has.
    limits.texels = 5000;
    check(
        {sprites, cells}, [](OwnDrawing&) {}, nullptr, limits);
}

/// Room for a quarter of the samples, in small pages: batches, and runs dealt out to several places.
TEST_P(GlLayerDrawing, BatchByBatch) {
    GlLimitsOfTest limits;
    limits.samples = {40'000, 16'384};
    check(
        {sprites, blended, cells}, [](OwnDrawing&) {}, nullptr, limits);
}

/// Work groups of as many threads as a GPU likes.
TEST_P(GlLayerDrawing, GroupsOfAGpu) {
    GlLimitsOfTest limits;
    limits.software = false;
    check(
        {sprites, {"sphere", {{"sizePx", 23.0}}, ""}, blended, cells}, [](OwnDrawing&) {}, nullptr, limits);
}

/// What a work group's threads did with their fragments (shaders/splat/sums.glsl).
struct Adds {
    std::uint32_t direct = 0, inTiles = 0, pixelsOfTiles = 0;

    std::uint32_t fragments() const { return direct + inTiles; }
    /// Pixels whose sums were added to, in memory that all groups share.
    std::uint32_t toMemory() const { return direct + pixelsOfTiles; }
};

/// Draws on OpenGL, expects the cpu device's bytes, and tells how sums were added up.
void drawCounted(GlLayers::Backend& backend, const LayerCase& c, const Pixels& cpu,
                 const GlLimitsOfTest& limits, Adds& adds) {
    constexpr unsigned counts = 7;  // as sums.glsl numbers it
    const auto current = gl::Context::Current::enter(*backend.context);
    ASSERT_TRUE(current) << current.error().message;
    GlDrawing gl(backend, c, limits);
    gl::Buffer counted(gl.functions, "counts");
    ASSERT_TRUE(counted.write(std::as_bytes(std::span(&adds, 1))));
    counted.bindStorage(counts);
    gl.draw();
    ASSERT_TRUE(gl.drawn) << gl.drawn.error().message;
    EXPECT_EQ(differing(cpu.depth, gl.read(gl.depth)), 0u) << "depths";
    EXPECT_EQ(differing(cpu.rgba, gl.read(gl.rgba)), 0u) << "colours";
    EXPECT_EQ(differing(cpu.normals, gl.read(gl.normals)), 0u) << "normals";
    counted.read(std::as_writable_bytes(std::span(&adds, 1)));
}

/// Sums in shared memory first: without it, with as much as drivers have, and with so little that many fragments lie outside
/// of every tile. Each fragment is added once, by either way, and by whichever it is the picture stays the same.
TEST_P(GlLayerDrawing, SumsInTilesAndBesideThem) {
    REQUIRE_BACKEND(backend, GetParam());
    const std::pair<MethodCase, bool> cases[] = {
        {blended, true}, {{"hqs", {{"sizePx", 21.0}}, ""}, false}, {{"ewa", {}, ""}, false}, {cells, false}};
    for (const auto& [method, software] : cases) {
        SCOPED_TRACE(method.method);
        SurfelScene s(from_, sharedScene().cut(), passesOf(method, Shading::Phong));
        const LayerCase c = layerCase(s.drawing);
        const Pixels cpu = drawOnCpu(c);
        GlLimitsOfTest limits;
        limits.software = software;
        limits.countAdds = true;
        const auto drawn = [&](std::uint32_t tileBytes) {
            Adds adds;
            limits.tileBytes = tileBytes;
            drawCounted(backend, c, cpu, limits, adds);
            return adds;
        };
        const Adds without = drawn(0), few = drawn(8192), usual = drawn(32768);
        EXPECT_GT(without.direct, 10'000u);
        EXPECT_EQ(without.inTiles, 0u);
        for (const Adds& adds : {few, usual}) {
            EXPECT_EQ(adds.fragments(), without.direct);
            EXPECT_GT(adds.inTiles, 0u);
            EXPECT_LE(adds.pixelsOfTiles, adds.inTiles);
        }
        EXPECT_GT(few.direct, 0u) << "nothing lies outside of a tile";
        EXPECT_LT(usual.toMemory(), without.toMemory());
        std::printf("    %s: %u fragments, added to memory: %u with tiles in 8 KiB, %u in 32 KiB\n",
                    method.method, without.direct, few.toMemory(), usual.toMemory());
    }
}

/// 500 points in one run, each as large as the picture: Mesa's rasteriser ends a thread's loops after 65,535
/// turns, which one work group would need for a third of them.
TEST_P(GlLayerDrawing, NoThreadLoopsLongerThanTheDriverLetsIt) {
    Numbers numbers(29);
    std::vector<AnalyticPoint> points(500);
    for (AnalyticPoint& p : points) {
        p.position = 0.3 * numbers.onSphere();
        p.rgb = numbers.color();
    }
    const AnalyticCloud cloud(points, 0.06, 1000);
    check(
        {{"paraboloid", {{"sizePx", 256.0}}, ""}}, [](OwnDrawing&) {}, &cloud.cut());
}

/// 30,000 points in a few pixels, with normals of both signs: sums of more than 32 bits.
TEST_P(GlLayerDrawing, SumsBeyond32Bits) {
    Numbers numbers(23);
    std::vector<AnalyticPoint> points;
    for (int i = 0; i < 30'000; ++i) {
        AnalyticPoint p;
        p.position = 0.02 * numbers.onSphere();
        p.rgb = {250, static_cast<std::uint8_t>(i), 255};
        p.surfel = surfelOf({i % 3 ? -1.0 : 0.8, -1, 0.3}, 0.3);
        points.push_back(p);
    }
    const AnalyticCloud cloud(points, 0.3, 7000);
    check(
        {blended, {"ewa", {}, ""}}, [](OwnDrawing& d) { d.oriented = true; }, &cloud.cut());
}

/// A mirror's layer lies inside the picture's planes: not a word around its area changes.
TEST_P(GlLayerDrawing, LeavesTheRestOfThePlanesAlone) {
    REQUIRE_BACKEND(backend, GetParam());
    SurfelScene s(from_, sharedScene().cut(), passesOf(cells, Shading::Phong));
    s.drawing.window = {40, 30, 70, 50};
    const LayerCase c = layerCase(s.drawing);
    const Pixels cpu = drawOnCpu(c);
    const auto current = gl::Context::Current::enter(*backend.context);
    ASSERT_TRUE(current);
    constexpr int border = 5;
    GlDrawing gl(backend, c, limits_, border);
    gl.draw();
    ASSERT_TRUE(gl.drawn) << gl.drawn.error().message;
    const auto rgba = gl.read(gl.rgba), depth = gl.read(gl.depth), normals = gl.read(gl.normals);
    for (int y = -border; y < c.area.w + border; ++y) {
        for (int x = -border; x < c.area.z + border; ++x) {
            const bool inside = x >= 0 && y >= 0 && x < c.area.z && y < c.area.w;
            const auto at = static_cast<std::size_t>((y + border) * gl.planes.area.z + x + border);
            const auto in = static_cast<std::size_t>(y * c.area.z + x);
            ASSERT_EQ(rgba[at], inside ? cpu.rgba[in] : GlDrawing::untouched) << x << ", " << y;
            ASSERT_EQ(depth[at], inside ? cpu.depth[in] : GlDrawing::untouched) << x << ", " << y;
            ASSERT_EQ(normals[at], inside ? cpu.normals[in] : GlDrawing::untouched) << x << ", " << y;
        }
    }
}

TEST_P(GlLayerDrawing, IsAbandonedWhenAsked) {
    REQUIRE_BACKEND(backend, GetParam());
    SurfelScene s(from_, sharedScene().cut(), passesOf(cells, Shading::Phong));
    const LayerCase c = layerCase(s.drawing);
    const auto current = gl::Context::Current::enter(*backend.context);
    ASSERT_TRUE(current);
    GlDrawing gl(backend, c, limits_);
    std::stop_source stop;
    stop.request_stop();
    gl.draw(stop.get_token());
    ASSERT_FALSE(gl.drawn);
    EXPECT_EQ(gl.drawn.error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace scancast::test
