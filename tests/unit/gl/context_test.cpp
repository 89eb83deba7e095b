#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <thread>
#include <vector>

#include "renderer/device/gl/context/egl_context.hpp"
#include "renderer/device/gl/context/osmesa_context.hpp"
#include "renderer/device/gl/programs/arithmetic.hpp"
#include "renderer/device/gl/programs/gl_handles.hpp"

namespace scancast::gl {
namespace {

Expected<std::unique_ptr<Context>> open(const std::string& backend) {
    return backend == "egl" ? createEglContext() : createOsmesaContext();
}

#define REQUIRE_CONTEXT(NAME, BACKEND)                                                           \
    auto NAME##Opened = open(BACKEND);                                                           \
    if (!NAME##Opened)                                                                           \
        GTEST_SKIP() << "MISSING BACKEND " << (BACKEND) << ": " << NAME##Opened.error().message; \
    std::unique_ptr<Context> NAME = std::move(*NAME##Opened)

constexpr const char* doubler =
    "#version 450 core\n"
    "layout(local_size_x = 32) in;\n"
    "layout(std430, binding = 0) buffer Values { uint values[]; };\n"
    "void main() { values[gl_GlobalInvocationID.x] = 2u * values[gl_GlobalInvocationID.x] + 1u; }\n";

/// Oracle: the GPU's arithmetic on numbers of our own, so that a call which landed elsewhere is seen.
void expectThatItComputes(Context& context, std::uint32_t seed) {
    const auto current = Context::Current::enter(context);
    ASSERT_TRUE(current) << current.error().message;
    const GlFunctions& gl = context.functions();
    const auto program = Program::compile(gl, "doubler", doubler);
    ASSERT_TRUE(program) << program.error().message;
    std::vector<std::uint32_t> values(64);
    for (std::uint32_t i = 0; i < 64; ++i) values[i] = seed + i;
    Buffer buffer(gl, "values");
    ASSERT_TRUE(buffer.write(std::as_bytes(std::span(values))));
    buffer.bindStorage(0);
    program->use();
    gl.DispatchCompute(2, 1, 1);
    gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    ASSERT_TRUE(waitForGpu(gl));
    buffer.read(std::as_writable_bytes(std::span(values)));
    for (std::uint32_t i = 0; i < 64; ++i) ASSERT_EQ(values[i], 2 * (seed + i) + 1);
    EXPECT_TRUE(checkErrors(gl, "testing"));
}

class GlContext : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Gl, GlContext, testing::Values("egl", "osmesa"),
                         [](const testing::TestParamInfo<std::string>& c) { return c.param; });

TEST_P(GlContext, OpensAndClosesAgainAndAgain) {
    for (std::uint32_t i = 0; i < 10; ++i) {
        REQUIRE_CONTEXT(context, GetParam());
        expectThatItComputes(*context, i);
        EXPECT_EQ(context->backend(), GetParam());
    }
}

TEST_P(GlContext, SaysWhatItRunsOn) {
    REQUIRE_CONTEXT(context, GetParam());
    const auto current = Context::Current::enter(*context);
    ASSERT_TRUE(current);
    const auto driver = describeDriver(context->functions());
    ASSERT_TRUE(driver) << driver.error().message;
    EXPECT_FALSE(driver->vendor.empty());
    EXPECT_FALSE(driver->version.empty());
    const bool rasteriser = driver->renderer.find("llvmpipe") != std::string::npos;
    EXPECT_TRUE(driver->software || !rasteriser);
    if (GetParam() == "egl") {
        EXPECT_TRUE(driver->tellsLoss) << "nobody would hear that a GPU was reset";
    }
}

TEST_P(GlContext, AShaderThatDoesNotCompileIsShownWithLineNumbers) {
    REQUIRE_CONTEXT(context, GetParam());
    const auto current = Context::Current::enter(*context);
    ASSERT_TRUE(current);
    const auto program =
        Program::compile(context->functions(), "broken.comp",
                         "#version 450 core\nlayout(local_size_x = 1) in;\nvoid main() { oops; }\n");
    ASSERT_FALSE(program);
    EXPECT_EQ(program.error().code, ErrorCode::Internal);
    EXPECT_NE(program.error().message.find("broken.comp"), std::string::npos);
    EXPECT_NE(program.error().message.find("   3: void main() { oops; }"), std::string::npos);
    EXPECT_NE(program.error().message.find("oops"), program.error().message.rfind("oops"))
        << "log and source name it";
}

TEST_P(GlContext, ErrorsAreNamed) {
    REQUIRE_CONTEXT(context, GetParam());
    const auto current = Context::Current::enter(*context);
    ASSERT_TRUE(current);
    context->functions().Enable(0x12345);
    const auto checked = checkErrors(context->functions(), "doing nonsense");
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().message, "OpenGL reports GL_INVALID_ENUM while doing nonsense.");
    EXPECT_TRUE(checkErrors(context->functions(), "doing nothing")) << "an error is told once";
}

/// A reset is told by the next call that looks, whatever it was about: by a driver that says so of its own
/// context.
TEST_P(GlContext, AResetIsToldWithWhoseFaultItWas) {
    REQUIRE_CONTEXT(context, GetParam());
    const auto current = Context::Current::enter(*context);
    ASSERT_TRUE(current);
    GlFunctions gl = context->functions();
    const auto expectLost = [&](const char* words) {
        for (const auto& looked : {checkErrors(gl, "testing"), waitForGpu(gl)}) {
            ASSERT_FALSE(looked);
            EXPECT_EQ(looked.error().code, ErrorCode::DeviceLost);
            EXPECT_NE(looked.error().message.find(words), std::string::npos) << looked.error().message;
        }
    };
    gl.GetGraphicsResetStatus = [] { return GLenum(GL_GUILTY_CONTEXT_RESET); };
    expectLost("by what Scancast asked of it");
    gl.GetGraphicsResetStatus = [] { return GLenum(GL_INNOCENT_CONTEXT_RESET); };
    expectLost("by what another program asked of it");
    gl.GetGraphicsResetStatus = [] { return GLenum(GL_UNKNOWN_CONTEXT_RESET); };
    expectLost("does not say why");
    gl = context->functions();
    EXPECT_TRUE(waitForGpu(gl));
}

/// Oracle: the processor's quotients and roots. Spoilt ones must be found out, and what corrects them found.
TEST_P(GlContext, HowTheDriverRoundsIsFoundOut) {
    REQUIRE_CONTEXT(context, GetParam());
    const auto current = Context::Current::enter(*context);
    ASSERT_TRUE(current);
    const GlFunctions& gl = context->functions();
    const auto found = findArithmetic(gl, {});
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_TRUE(found->exact);
    const auto spoilt = isExact(gl, {}, {.rounding = Rounding::Own, .rough = true});
    ASSERT_TRUE(spoilt) << spoilt.error().message;
    EXPECT_FALSE(*spoilt);
    const auto corrected = findArithmetic(gl, {}, true);
    ASSERT_TRUE(corrected) << corrected.error().message;
    EXPECT_NE(corrected->rounding, Rounding::Own);
    EXPECT_TRUE(corrected->exact);
}

TEST(GlContexts, LiveSideBySideInOneProcess) {
    REQUIRE_CONTEXT(egl, "egl");
    REQUIRE_CONTEXT(osmesa, "osmesa");
    REQUIRE_CONTEXT(secondEgl, "egl");
    for (std::uint32_t i = 0; i < 5; ++i) {
        expectThatItComputes(*egl, 10 * i);
        expectThatItComputes(*osmesa, 20 * i);
        expectThatItComputes(*secondEgl, 30 * i);
    }
    // EGL hands out one display per device: closing one context must not close the other's.
    egl.reset();
    expectThatItComputes(*secondEgl, 5);
    osmesa.reset();
    expectThatItComputes(*secondEgl, 6);
}

/// Each device has a render thread of its own, which opens, uses and closes it.
TEST(GlContexts, LiveOnThreadsOfTheirOwn) {
    for (const char* backend : {"egl", "osmesa"}) {
        REQUIRE_CONTEXT(probe, backend);
    }
    std::vector<std::thread> threads;
    for (std::uint32_t t = 0; t < 4; ++t) {
        threads.emplace_back([t] {
            const auto context = open(t % 2 ? "egl" : "osmesa");
            ASSERT_TRUE(context) << context.error().message;
            for (std::uint32_t i = 0; i < 10; ++i) expectThatItComputes(**context, 1000 * t + i);
        });
    }
    for (std::thread& thread : threads) thread.join();
}

TEST(GlContexts, AnEglDeviceThatIsNotThereIsNamed) {
    const auto devices = listEglDevices();
    if (!devices) GTEST_SKIP() << "MISSING BACKEND egl: " << devices.error().message;
    const auto context = createEglContext(4321);
    ASSERT_FALSE(context);
    EXPECT_EQ(context.error().code, ErrorCode::DeviceUnavailable);
    EXPECT_NE(context.error().message.find("4321"), std::string::npos);
    EXPECT_NE(context.error().message.find("--list-backends"), std::string::npos);
}

}  // namespace
}  // namespace scancast::gl
