// Lighting of a picture's part gives the same bytes on any number of threads and any SIMD level: every place
// is rounded once, wherever rows and vectors begin.
#include "renderer/device/cpu/screen_passes.hpp"

#include <gtest/gtest.h>

#include "renderer/device/cpu/simd_level.hpp"
#include "tests/support/pictures/analytic_cut.hpp"

namespace scancast::test {
namespace {

struct Part {
    cpu::Rect area;
    std::vector<std::uint32_t> rgba, normals;
    std::vector<float> depth;

    explicit Part(const cpu::Rect& where) : area(where) {
        Numbers numbers(6);
        for (int i = 0; i < area.width() * area.height(); ++i) {
            rgba.push_back(static_cast<std::uint32_t>(numbers.next()) | 0xff000000u);
            normals.push_back(static_cast<std::uint32_t>(numbers.next()) | 0x00010001u);
            depth.push_back(static_cast<float>(numbers.uniform(1, 9)));
        }
    }
    cpu::Planes planes() {
        cpu::Planes p;
        p.area = area;
        p.rgba = rgba.data();
        p.normals = normals.data();
        p.depth = depth.data();
        return p;
    }
};

TEST(ScreenPasses, LightEveryPixelAlikeWhoeverTakesIt) {
    const Viewpoint viewpoint = lookAt({0, -5, 0}, {0, 0, 0}, 1000, 700);
    LayerView layerView;
    layerView.viewpoint = &viewpoint;
    const Pass passes[] = {ShadowPass{0.8f, 0.3f, 0.1f},
                           PhongPass{0.1f, 0.5f, 0.7f, 0.9f, {0.6f, 0, 0.8f}, true}, EyeDomePass{},
                           OcclusionPass{1, 20}};
    const Viewpoint ofSun = lookAtOrthographic({4, -9, 6}, {0, 0, 0}, 211, 173, 9);
    Numbers numbers(7);
    std::vector<float> map(std::size_t{211} * 173);
    for (float& depth : map) depth = static_cast<float>(numbers.uniform(8, 14));
    const cpu::ShadowMap sun{&ofSun, map.data()};
    // From the view axis outwards: there the first place has more digits than the last can keep.
    for (const cpu::Rect& area : {cpu::Rect{500, 350, 1000, 700}, {0, 0, 501, 351}, {499, 349, 640, 360}}) {
        std::vector<std::vector<std::uint32_t>> results;
        for (const cpu::SimdLevel& level : cpu::simdLevels()) {
            if (!level.available()) continue;
            for (const int threads : {1, 2, 5}) {
                tbb::task_arena arena(threads);
                const cpu::Workers workers(arena, threads, {});
                cpu::ScreenMemory memory;
                FrameStats stats;
                Part part(area);
                cpu::runScreenPasses(passes, layerView, {0.3, -0.4}, part.planes(), *level.kernels, workers,
                                     memory, stats, &sun);
                results.push_back(std::move(part.rgba));
            }
        }
        ASSERT_GE(results.size(), 3u);
        for (const auto& result : results) EXPECT_EQ(result, results[0]);
    }
}

}  // namespace
}  // namespace scancast::test
