// An OpenGL 4.5 core context without a surface: what EGL and OSMesa have in common.
//
// Owned by one GL device, and kept by the frames that it has lent (read_back.hpp); used on the thread that
// created it, destroyed on any on which no context is current. A context is current only inside a Current
// scope: EGL's and OSMesa's notions of "current" share one dispatch table inside Mesa, so whoever leaves a
// context current would have the other's calls land in it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "renderer/device/gl/context/gl_functions.hpp"

namespace scancast::gl {

class Context {
  public:
    virtual ~Context() = default;
    Context() = default;
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    /// Valid to call only inside a Current scope of this context.
    const GlFunctions& functions() const { return functions_; }
    /// "egl" or "osmesa".
    virtual const char* backend() const = 0;

    /// Makes a context current for as long as it lives. Scopes do not nest.
    class Current {
      public:
        /// DeviceLost, naming the failed call.
        static Expected<Current> enter(Context& context) {
            if (auto ok = context.makeCurrent(); !ok) return passOn(ok);
            return Current(context);
        }
        Current(Current&& other) noexcept : context_(std::exchange(other.context_, nullptr)) {}
        Current& operator=(Current&&) = delete;
        ~Current() {
            if (context_) context_->release();
        }

      private:
        explicit Current(Context& context) : context_(&context) {}
        Context* context_;
    };

  protected:
    virtual Expected<void> makeCurrent() = 0;
    virtual void release() = 0;

    GlFunctions functions_;
};

/// What the driver says of itself.
struct DriverStrings {
    std::string vendor, renderer, version;
    bool software = false;     ///< a rasteriser on the CPU: llvmpipe, softpipe, SwiftShader …
    std::uint64_t memory = 0;  ///< of the GPU: all, or what is free where the driver says no more, bytes
    bool atomics64 = false;    ///< GL_NV_shader_atomic_int64
    bool tellsLoss = false;    ///< glGetGraphicsResetStatus tells when the GPU was reset
};

/// Needs a Current scope. DeviceUnavailable when the version is below 4.5.
Expected<DriverStrings> describeDriver(const GlFunctions& gl);

/// Needs a Current scope.
bool hasExtension(const GlFunctions& gl, std::string_view name);

/// Bytes of the GPU's memory that are free; nullopt where the driver does not say. Needs a Current scope.
std::optional<std::uint64_t> freeGpuMemory(const GlFunctions& gl);

/// Sends the driver's KHR_debug messages to the log: errors as errors, the rest at debug level. Needs a
/// Current scope.
void logDriverMessages(const GlFunctions& gl);

}  // namespace scancast::gl
