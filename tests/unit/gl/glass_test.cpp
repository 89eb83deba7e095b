// A mirror's glass on the GPU against the cpu device's kernels, byte by byte: which pixels see it, what they
// show, its tint and depth.
#include "renderer/device/gl/passes/glass.hpp"

#include <glm/geometric.hpp>

#include "renderer/device/cpu/simd_level.hpp"
#include "renderer/device/host/screens.hpp"
#include "tests/support/pictures/analytic_cut.hpp"
#include "tests/support/pictures/on_gl.hpp"

namespace scancast::test {
namespace {

class GlGlass : public OnGl {};
INSTANTIATE_ON_GL(GlGlass);

PixelPlanes randomGlass(const glm::ivec4& area, std::uint64_t seed, bool normals) {
    PixelPlanes planes;
    planes.area = area;
    Numbers numbers(seed);
    for (std::size_t i = 0; i < planes.pixels(); ++i) {
        planes.rgba.push_back(static_cast<std::uint32_t>(numbers.next()));
        const bool background = numbers.uniform() < 0.2;
        planes.depth.push_back(background ? std::numeric_limits<float>::infinity()
                                          : static_cast<float>(numbers.uniform(2, 8)));
        if (normals) planes.normals.push_back(static_cast<std::uint32_t>(numbers.next()));
    }
    return planes;
}

/// A tilted mirror about 5 units in front of the eye.
CutView tiltedMirror(bool perspective) {
    CutView view;
    MirrorGlass& m = view.glass.emplace();
    view.viewpoint.width = 180;
    view.viewpoint.height = 130;
    view.viewpoint.projection = perspective ? Projection::Perspective : Projection::Orthographic;
    view.viewpoint.pixelsPerUnit = perspective ? 150 : 28;
    m.center = {0.3, -0.2, -5};
    m.normal = glm::normalize(glm::dvec3(0.5, 0.2, 1));
    m.right = 1.4 * glm::normalize(glm::cross(glm::dvec3(0, 1, 0), m.normal));
    m.up = 0.9 * glm::normalize(glm::cross(m.normal, m.right));
    m.tint = {250, 128, 3};
    m.margin = 0.3;
    return view;
}

cpu::Glass onCpu(const GlassNumbers& numbers, const glm::ivec4& area, PixelPlanes& picture) {
    cpu::Glass g;
    static_cast<GlassNumbers&>(g) = numbers;
    const std::ptrdiff_t first =
        std::ptrdiff_t{area.y - picture.area.y} * picture.area.z + (area.x - picture.area.x);
    g.rgba = picture.rgba.data() + first;
    g.depth = picture.depth.data() + first;
    if (!picture.normals.empty()) g.normals = picture.normals.data() + first;
    g.stride = picture.area.z;
    g.x = area.x;
    g.y = area.y;
    g.width = area.z;
    g.height = area.w;
    return g;
}

void expectEqual(const PixelPlanes& a, const PixelPlanes& b) {
    EXPECT_EQ(differences(a.rgba, b.rgba), 0u);
    EXPECT_EQ(differences(a.depth, b.depth), 0u);
    EXPECT_EQ(differences(a.normals, b.normals), 0u);
}

// On a driver that rounds divisions, too: the glass's depth is one, but 1/x of a few numbers.
TEST_P(GlGlass, IsTheCpus) {
    const cpu::Kernels& kernels = *cpu::chooseSimdLevel({}).value()->kernels;
    const bool software = gl::describeDriver(shaders().functions())->software;
    PlaneBuffers pictures(shaders().functions()), reflections(shaders().functions());
    for (const bool perspective : {true, false}) {
        for (const bool normals : {true, false}) {
            const CutView mirror = tiltedMirror(perspective);
            LayerView layerView;
            layerView.viewpoint = &mirror.viewpoint;
            layerView.pad = 7;
            const GlassNumbers glass = glassNumbers(*mirror.glass, layerView, {0.25, -0.125});
            PixelPlanes here = randomGlass({4, 6, 171, 123}, 1, normals);
            const PixelPlanes before = here;
            PixelPlanes seen = randomGlass({40, 29, 101, 77}, 2, normals), there = here;
            const gl::GpuPlanes picture = pictures.upload(there);
            ASSERT_TRUE(gl::lookThrough(glass, reflections.upload(seen), picture, shaders()));
            pictures.download(there);

            cpu::Glass g = onCpu(glass, seen.area, here);
            g.reflected = seen.rgba.data();
            g.reflectedDepth = seen.depth.data();
            g.reflectedNormals = seen.normals.data();
            g.reflectedStride = seen.area.z;
            kernels.lookThrough(g);
            const std::size_t changed = differences(before.rgba, here.rgba);
            EXPECT_GT(changed, 500u);
            EXPECT_LT(changed, seen.pixels() - 500u);
            if (software) expectEqual(there, here);
            EXPECT_LE(differences(there.rgba, here.rgba), 5u);

            // From the same pixels on, whatever the first step has rounded.
            pictures.upload(here);
            ASSERT_TRUE(gl::tintGlass(glass, seen.area, picture, shaders()));
            pictures.download(there);
            kernels.tintGlass(onCpu(glass, seen.area, here));
            if (software) expectEqual(there, here);
            EXPECT_LE(differences(there.rgba, here.rgba), 5u);
        }
    }
}

}  // namespace
}  // namespace scancast::test
