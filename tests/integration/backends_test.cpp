// `scancast render` on every backend, as people run it: the same view gives the same picture, in every
// method.
#include <gtest/gtest.h>

#include "renderer/image/encode.hpp"
#include "renderer/method/method.hpp"
#include "tests/integration/program_fixture.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/picture_metrics.hpp"

namespace scancast::test {
namespace {

class Backends : public ProgramTest, public testing::WithParamInterface<std::string> {
  protected:
    Frame render(const std::string& backend, const std::string& method) {
        const std::string picture = file(backend + ".png");
        EXPECT_EQ(run({"scancast", "render", file("torus.scan"), "--backend", backend, "--method", method,
                       "--width", "200", "--height", "150", "--samples", "2", "-o", picture}),
                  0)
            << lastError;
        const std::string bytes = contentOf(picture);
        auto frame = decodePng({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
        return frame ? std::move(*frame) : Frame{};
    }
};

TEST_P(Backends, DrawTheSameViewInEveryMethod) {
    REQUIRE_DEVICE(device, GetParam());
    generate("torus.las", "torus");
    ASSERT_EQ(run({"scancast", "ingest", file("torus.las"), "-o", file("torus.scan")}), 0) << lastError;
    for (const Method& method : methods()) {
        const Frame cpu = render("cpu", method.name), gl = render(GetParam(), method.name);
        ASSERT_EQ(cpu.width, 200);
        EXPECT_GE(psnr(gl, cpu).value_or(0), 45) << method.name;
    }
}
INSTANTIATE_TEST_SUITE_P(Gl, Backends, testing::Values("egl", "osmesa"), deviceName);

}  // namespace
}  // namespace scancast::test
