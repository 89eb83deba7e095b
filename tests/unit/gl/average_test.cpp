// The mean of frames on the GPU against the cpu device's kernels, byte by byte, and parts of planes against a
// loop over pixels.
#include "renderer/device/gl/passes/frame_average.hpp"

#include "renderer/device/cpu/simd_level.hpp"
#include "tests/support/pictures/analytic_cut.hpp"
#include "tests/support/pictures/on_gl.hpp"

namespace scancast::test {
namespace {

class GlAverage : public OnGl {};
INSTANTIATE_ON_GL(GlAverage);

PixelPlanes randomPlanes(const glm::ivec4& area, std::uint64_t seed, bool transparent) {
    PixelPlanes planes;
    planes.area = area;
    Numbers numbers(seed);
    for (std::size_t i = 0; i < planes.pixels(); ++i) {
        const bool covered = !transparent || numbers.uniform() < 0.6;
        planes.rgba.push_back(covered ? static_cast<std::uint32_t>(numbers.next()) | 0xff000000u : 0u);
        planes.depth.push_back(static_cast<float>(numbers.uniform(1, 9)));
    }
    return planes;
}

std::vector<std::uint32_t> partOf(const PixelPlanes& planes, const glm::ivec4& window) {
    std::vector<std::uint32_t> part;
    for (int y = window.y; y < window.y + window.w; ++y) {
        for (int x = window.x; x < window.x + window.z; ++x) {
            const int at = (y - planes.area.y) * planes.area.z + (x - planes.area.x);
            part.push_back(planes.rgba[static_cast<std::size_t>(at)]);
        }
    }
    return part;
}

struct Case {
    glm::ivec4 area, window;
};
const Case cases[] = {{{0, 0, 70, 41}, {0, 0, 70, 41}},
                      {{30, 20, 100, 50}, {41, 23, 77, 40}},
                      {{5, 6, 1, 1}, {5, 6, 1, 1}},
                      {{0, 32, 129, 65}, {128, 96, 1, 1}}};

TEST_P(GlAverage, CutsPartsOut) {
    PlaneBuffers buffers(shaders().functions());
    gl::Buffer out(shaders().functions(), "part");
    for (const Case& c : cases) {
        const PixelPlanes planes = randomPlanes(c.area, 1, false);
        const gl::GpuPlanes there = buffers.upload(planes);
        ASSERT_TRUE(gl::crop(*there.rgba, c.area, c.window, out, shaders()));
        const std::vector<std::uint32_t> expected = partOf(planes, c.window);
        std::vector<std::uint32_t> part(expected.size());
        out.read(std::as_writable_bytes(std::span(part)));
        EXPECT_EQ(part, expected);
    }
}

TEST_P(GlAverage, IsTheCpus) {
    const cpu::Kernels& kernels = *cpu::chooseSimdLevel({}).value()->kernels;
    PlaneBuffers buffers(shaders().functions());
    gl::FrameAverage average(shaders());
    gl::Buffer out(shaders().functions(), "mean");
    for (const Case& c : cases) {
        for (const int frames : {1, 2, 7, 256}) {
            for (const bool transparent : {false, true}) {
                ASSERT_TRUE(average.begin(c.window.z, c.window.w));
                std::vector<std::uint16_t> sums;
                for (int i = 0; i < frames; ++i) {
                    const PixelPlanes planes =
                        randomPlanes(c.area, static_cast<std::uint64_t>(i), transparent);
                    ASSERT_TRUE(average.add(buffers.upload(planes), c.window));
                    const std::vector<std::uint32_t> part = partOf(planes, c.window);
                    sums.resize(part.size() * 4);
                    kernels.accumulate(reinterpret_cast<const std::uint8_t*>(part.data()), sums.data(),
                                       static_cast<int>(sums.size()));
                }
                std::vector<std::uint32_t> expected(sums.size() / 4), mean(sums.size() / 4);
                kernels.average(sums.data(), reinterpret_cast<std::uint8_t*>(expected.data()),
                                static_cast<int>(expected.size()), frames);
                ASSERT_TRUE(average.write(out));
                out.read(std::as_writable_bytes(std::span(mean)));
                ASSERT_EQ(differences(mean, expected), 0u) << frames << " frames";
            }
        }
    }
}

}  // namespace
}  // namespace scancast::test
