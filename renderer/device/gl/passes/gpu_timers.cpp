#include "renderer/device/gl/passes/gpu_timers.hpp"

#include <algorithm>
#include <cassert>

namespace scancast::gl {
namespace {

/// Rasterisers on the CPU do have time stamps, but not all write them when the work is done: OSMesa's
/// llvmpipe says microseconds for seconds. Waiting costs nothing there, where work is done as it is asked
/// for.
GpuTimers::Clock clockOf(const GlFunctions& gl) {
    const auto driver = describeDriver(gl);
    GLint bits = 0;
    gl.GetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
    const bool trusted = driver && !driver->software && bits > 0;
    return trusted ? GpuTimers::Clock::Gpu : GpuTimers::Clock::Host;
}

}  // namespace

GpuTimers::GpuTimers(const GlFunctions& gl) : GpuTimers(gl, clockOf(gl)) {}

GpuTimers::~GpuTimers() {
    if (!free_.empty()) gl_.DeleteQueries(static_cast<GLsizei>(free_.size()), free_.data());
}

GLuint GpuTimers::take() {
    if (free_.empty()) {
        GLuint made = 0;
        gl_.CreateQueries(GL_TIMESTAMP, 1, &made);
        return made;
    }
    const GLuint query = free_.back();
    free_.pop_back();
    return query;
}

StageTimes::~StageTimes() {
    for (const Stage& stage : stages_) {
        for (const GLuint query : {stage.began, stage.ended})
            if (query) timers_->free_.push_back(query);
    }
}

void StageTimes::waitForHost() {
    if (auto done = waitForGpu(timers_->gl_); !done && waited_) waited_ = std::move(done);
}

void StageTimes::begin(std::string stage) {
    if (depth_++ > 0) return;
    stages_.push_back({std::move(stage)});
    if (timers_->clock_ == GpuTimers::Clock::Gpu) {
        stages_.back().began = timers_->take();
        timers_->gl_.QueryCounter(stages_.back().began, GL_TIMESTAMP);
    } else {
        waitForHost();
        stages_.back().start = HostClock::now();
    }
}

void StageTimes::end() {
    assert(depth_ > 0);
    if (--depth_ > 0) return;
    Stage& stage = stages_.back();
    if (timers_->clock_ == GpuTimers::Clock::Gpu) {
        stage.ended = timers_->take();
        timers_->gl_.QueryCounter(stage.ended, GL_TIMESTAMP);
    } else {
        waitForHost();
        stage.hostMs = std::chrono::duration<double, std::milli>(HostClock::now() - stage.start).count();
    }
}

std::size_t StageTimes::hostStage(std::string_view name) {
    const auto known = std::ranges::find(host_, name, &StageTime::name);
    const auto place = static_cast<std::size_t>(known - host_.begin());
    if (known == host_.end()) host_.push_back({std::string(name), 0});
    return place;
}

Expected<void> StageTimes::collect(FrameStats& stats) {
    assert(depth_ == 0);
    const GlFunctions& gl = timers_->gl_;
    if (!waited_) return waited_;
    // Reading a result waits without a deadline; a fence has one.
    const auto last =
        std::ranges::find_if(stages_.rbegin(), stages_.rend(), [](const Stage& s) { return s.ended != 0; });
    if (last != stages_.rend()) {
        GLuint64 isThere = GL_FALSE;
        gl.GetQueryObjectui64v(last->ended, GL_QUERY_RESULT_AVAILABLE, &isThere);
        if (!isThere) {
            if (auto ok = waitForGpu(gl); !ok) return ok;
        }
    }
    for (const StageTime& stage : host_) stats.add(stage.name, stage.milliseconds);
    for (const Stage& stage : stages_) {
        double ms = stage.hostMs;
        if (stage.ended) {
            GLuint64 began = 0, ended = 0;
            gl.GetQueryObjectui64v(stage.began, GL_QUERY_RESULT, &began);
            gl.GetQueryObjectui64v(stage.ended, GL_QUERY_RESULT, &ended);
            // A clock that was set meanwhile must not make a stage last for centuries.
            ms = ended > began ? static_cast<double>(ended - began) / 1e6 : 0;
        }
        stats.add(stage.name, ms);
    }
    return checkErrors(gl, "reading the times of a picture's stages");
}

}  // namespace scancast::gl
