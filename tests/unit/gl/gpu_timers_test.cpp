#include "renderer/device/gl/passes/gpu_timers.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <thread>

#include "renderer/device/gl/context/egl_context.hpp"
#include "renderer/device/gl/context/osmesa_context.hpp"

namespace scancast::gl {
namespace {

/// Work that no compiler can leave out; its amount is a uniform.
constexpr const char* worker =
    "#version 450 core\n"
    "layout(local_size_x = 64) in;\n"
    "layout(std430, binding = 0) buffer Values { uint values[]; };\n"
    "layout(location = 0) uniform uint rounds;\n"
    "void main() {\n"
    "    uint v = gl_GlobalInvocationID.x;\n"
    "    for (uint i = 0u; i < rounds; ++i) v = v * 1664525u + 1013904223u;\n"
    "    values[gl_GlobalInvocationID.x] = v;\n"
    "}\n";

using Backend = std::string;

class GpuTimersTest : public testing::TestWithParam<std::tuple<Backend, GpuTimers::Clock>> {
  protected:
    void SetUp() override {
        const Backend backend = std::get<0>(GetParam());
        auto opened = backend == "egl" ? createEglContext() : createOsmesaContext();
        if (!opened) GTEST_SKIP() << "MISSING BACKEND " << backend << ": " << opened.error().message;
        context_ = std::move(*opened);
        current_.emplace(*Context::Current::enter(*context_));
        auto compiled = Program::compile(gl(), "worker", worker);
        ASSERT_TRUE(compiled) << compiled.error().message;
        program_.emplace(std::move(*compiled));
        values_.emplace(gl(), "values");
        ASSERT_TRUE(values_->reserve(groups * 64 * 4));
        values_->bindStorage(0);
        program_->use();
        work(1);  // drivers compile once more at the first dispatch
        ASSERT_TRUE(waitForGpu(gl()));
    }
    void TearDown() override {
        values_.reset();
        program_.reset();
        current_.reset();
    }

    GpuTimers::Clock clock() const { return std::get<1>(GetParam()); }
    const GlFunctions& gl() const { return context_->functions(); }
    void work(unsigned rounds) const {
        gl().Uniform1ui(0, rounds);
        gl().DispatchCompute(groups, 1, 1);
    }

    static constexpr unsigned groups = 256;
    std::unique_ptr<Context> context_;
    std::optional<Context::Current> current_;
    std::optional<Program> program_;
    std::optional<Buffer> values_;
};
INSTANTIATE_TEST_SUITE_P(Gl, GpuTimersTest,
                         testing::Combine(testing::Values("egl", "osmesa"),
                                          testing::Values(GpuTimers::Clock::Gpu, GpuTimers::Clock::Host)));

/// Oracle: the process's own clock around everything, an idle GPU at both ends. Stages lie inside, one after
/// the other, so they cannot add up to more (but for what two clocks may drift apart).
TEST_P(GpuTimersTest, StagesLieWithinTheTimeThatAllTook) {
    GpuTimers timers(gl(), clock());
    FrameStats stats;
    const auto start = std::chrono::steady_clock::now();
    {
        StageTimes times(timers);
        for (int i = 0; i < 3; ++i) {
            {
                const StageTimes::Scope stage(times, "much");
                work(2'000);
            }
            const StageTimes::Scope stage(times, "little");
            work(1);
        }
        ASSERT_TRUE(waitForGpu(gl()));
        ASSERT_TRUE(times.collect(stats));
    }
    const double all =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    ASSERT_EQ(stats.stages.size(), 2u) << "repeated stages add up";
    EXPECT_EQ(stats.stages[0].name, "much");
    EXPECT_EQ(stats.stages[1].name, "little");
    EXPECT_GT(stats.stages[0].milliseconds, 0);
    EXPECT_GE(stats.stages[1].milliseconds, 0);
    EXPECT_LE(stats.stages[0].milliseconds + stats.stages[1].milliseconds, all * 1.01);
}

/// The clock that is chosen sees the work: nearly all of the time that all took passes within the stage.
TEST_P(GpuTimersTest, TheClockThatIsChosenSeesTheWork) {
    GpuTimers timers(gl());
    StageTimes times(timers);
    const auto start = std::chrono::steady_clock::now();
    times.begin("work");
    work(2'000);
    times.end();
    ASSERT_TRUE(waitForGpu(gl()));
    const double all =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    FrameStats stats;
    ASSERT_TRUE(times.collect(stats));
    EXPECT_GE(stats.stages[0].milliseconds, all / 4);
    EXPECT_LE(stats.stages[0].milliseconds, all * 1.01);
}

TEST_P(GpuTimersTest, TwoPicturesAtATimeKeepTheirTimesApart) {
    GpuTimers timers(gl(), clock());
    for (int i = 0; i < 20; ++i) {
        StageTimes first(timers);
        first.begin("a");
        work(10);
        first.end();
        StageTimes second(timers);
        second.begin("b");
        work(10);
        second.end();
        FrameStats a, b;
        ASSERT_TRUE(first.collect(a));
        ASSERT_TRUE(second.collect(b));
        ASSERT_EQ(a.stages.size(), 1u);
        ASSERT_EQ(b.stages.size(), 1u);
        EXPECT_EQ(a.stages[0].name, "a");
        EXPECT_EQ(b.stages[0].name, "b");
    }
    EXPECT_TRUE(checkErrors(gl(), "timing"));
}

TEST_P(GpuTimersTest, APictureThatIsAbandonedLeavesNothing) {
    GpuTimers timers(gl(), clock());
    for (int i = 0; i < 5; ++i) {
        StageTimes times(timers);
        const StageTimes::Scope stage(times, "never read");
        work(1);
    }
    StageTimes none(timers);
    FrameStats stats;
    EXPECT_TRUE(none.collect(stats));
    EXPECT_TRUE(stats.stages.empty());
    EXPECT_TRUE(checkErrors(gl(), "timing"));
}

/// The host's own work is told first, however late in the picture it was, and once.
TEST_P(GpuTimersTest, TheHostsStagesComeFirstAndAddUp) {
    GpuTimers timers(gl(), clock());
    StageTimes times(timers);
    const auto host = [&] {
        const StageTimes::HostScope timed(times, "prepare");
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    };
    host();
    {
        const StageTimes::Scope stage(times, "pass");
        work(1);
        host();
    }
    FrameStats stats;
    ASSERT_TRUE(times.collect(stats));
    ASSERT_EQ(stats.stages.size(), 2u);
    EXPECT_EQ(stats.stages[0].name, "prepare");
    EXPECT_GE(stats.stages[0].milliseconds, 4);
    EXPECT_EQ(stats.stages[1].name, "pass");
}

TEST_P(GpuTimersTest, AddToWhatIsThereAlready) {
    GpuTimers timers(gl(), clock());
    StageTimes times(timers);
    times.begin("select");
    work(1000);
    times.end();
    FrameStats stats;
    stats.add("select", 1000);
    ASSERT_TRUE(times.collect(stats));
    ASSERT_EQ(stats.stages.size(), 1u);
    EXPECT_GE(stats.stages[0].milliseconds, 1000);
}

}  // namespace
}  // namespace scancast::gl
