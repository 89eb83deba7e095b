// What each stage of a picture takes on the GPU: time stamps that the GPU itself writes around it, read when
// the picture's pixels are here. Asking for them waits for nothing, so pictures may overlap. A driver without
// time stamps to trust is timed by the clock, from idle GPU to idle GPU.
//
// GpuTimers is a GL device's and lends queries; StageTimes is one picture's, not later than the GpuTimers.
// Everything inside a Current scope of the context, on the device's thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "renderer/device/gl/programs/gl_handles.hpp"
#include "renderer/image/frame.hpp"

namespace scancast::gl {

class GpuTimers {
  public:
    enum class Clock : std::uint8_t {
        Gpu,   ///< time stamps
        Host,  ///< what a driver without them gets, and a rasteriser on the CPU
    };

    /// The GPU's own clock where there is one to trust.
    explicit GpuTimers(const GlFunctions& gl);
    GpuTimers(const GlFunctions& gl, Clock clock) : gl_(gl), clock_(clock) {}
    ~GpuTimers();
    GpuTimers(const GpuTimers&) = delete;
    GpuTimers& operator=(const GpuTimers&) = delete;

    Clock clock() const { return clock_; }

  private:
    friend class StageTimes;
    GLuint take();

    const GlFunctions& gl_;
    Clock clock_;
    std::vector<GLuint> free_;
};

/// The stages of one picture, in the order in which they began. A stage inside another is a part of that one.
class StageTimes {
  public:
    using HostClock = std::chrono::steady_clock;

    explicit StageTimes(GpuTimers& timers) : timers_(&timers) {}
    StageTimes(StageTimes&& other) noexcept = default;
    StageTimes& operator=(StageTimes&&) = delete;
    ~StageTimes();

    void begin(std::string stage);
    void end();

    /// Ends its stage with itself.
    class Scope {
      public:
        Scope(StageTimes& times, std::string stage) : times_(times) { times_.begin(std::move(stage)); }
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;
        ~Scope() { times_.end(); }

      private:
        StageTimes& times_;
    };

    /// Times what the host does as long as it lives, by its own clock: stages before all of the GPU's. Adds
    /// to others of that name.
    class HostScope {
      public:
        HostScope(StageTimes& times, std::string_view stage)
            : times_(times), stage_(times.hostStage(stage)), start_(HostClock::now()) {}
        HostScope(const HostScope&) = delete;
        HostScope& operator=(const HostScope&) = delete;
        ~HostScope() {
            const std::chrono::duration<double, std::milli> passed = HostClock::now() - start_;
            times_.host_[stage_].milliseconds += passed.count();
        }

      private:
        StageTimes& times_;
        const std::size_t stage_;
        const HostClock::time_point start_;
    };

    /// Adds every stage to the picture's; stages of the same name add up. Waits for the GPU where it is not
    /// done yet. DeviceLost when it does not get done.
    Expected<void> collect(FrameStats& stats);

  private:
    struct Stage {
        std::string name;
        GLuint began = 0, ended = 0;
        HostClock::time_point start{};
        double hostMs = 0;
    };

    void waitForHost();
    /// Its place in host_, from now on.
    std::size_t hostStage(std::string_view name);

    GpuTimers* timers_;
    std::vector<StageTime> host_;
    std::vector<Stage> stages_;
    int depth_ = 0;            ///< of stages that have begun
    Expected<void> waited_{};  ///< how waiting went, for the host's clock
};

}  // namespace scancast::gl
