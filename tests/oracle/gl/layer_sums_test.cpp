// What the gl device adds up - the methods that have sums - is, by whichever way it is added, byte for byte what the cpu device adds up:
// in tiles of shared memory first, beside them, and beyond 32 bits.
#include "tests/oracle/gl/layer_drawing.hpp"

namespace scancast::test {
namespace {

class GlLayerSums : public LayerDrawing {};
INSTANTIATE_TEST_SUITE_P(Gl, GlLayerSums, testing::Values("egl"),
                         [](const testing::TestParamInfo<std::string>& c) { return c.param; });

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
TEST_P(GlLayerSums, SumsInTilesAndBesideThem) {
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

/// 30,000 points in a few pixels, with normals of both signs: sums of more than 32 bits.
TEST_P(GlLayerSums, SumsBeyond32Bits) {
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

}  // namespace
}  // namespace scancast::test
