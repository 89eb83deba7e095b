// Layer against layer: what the gl device splats and resolves is, on Mesa's rasteriser, byte for byte what
// the cpu device does - colours, depths and normals, for the passes of every method. Right because both do
// the same float operations in the same order (`precise`, no contraction), their reductions are integers, and
// nothing else is shared.
#include <tuple>

#include "tests/oracle/gl/layer_drawing.hpp"

namespace scancast::test {
namespace {

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

class GlLayerDrawing : public LayerDrawing {};
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
