#include "renderer/device/gl/context/gl_context.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <string_view>

namespace scancast::gl {
namespace {

std::string text(const GlFunctions& gl, GLenum what) {
    const GLubyte* bytes = gl.GetString(what);
    return bytes ? reinterpret_cast<const char*>(bytes) : "";
}

void APIENTRY onMessage(GLenum, GLenum type, GLuint id, GLenum severity, GLsizei length,
                        const GLchar* message, const void*) {
    const std::string_view words(message, length >= 0 ? static_cast<std::size_t>(length) : 0);
    if (type == GL_DEBUG_TYPE_ERROR || severity == GL_DEBUG_SEVERITY_HIGH)
        spdlog::error("OpenGL driver, message {}: {}", id, words);
    else
        spdlog::debug("OpenGL driver, message {}: {}", id, words);
}

/// All of it where the driver says how much that is, else what is free, else 0.
std::uint64_t gpuMemory(const GlFunctions& gl) {
    constexpr GLenum totalAvailableMemoryNvx = 0x9048;  // GL_NVX_gpu_memory_info; KiB
    GLint kib = 0;
    if (hasExtension(gl, "GL_NVX_gpu_memory_info")) gl.GetIntegerv(totalAvailableMemoryNvx, &kib);
    return kib > 0 ? std::uint64_t(kib) * 1024 : freeGpuMemory(gl).value_or(0);
}

}  // namespace

Expected<DriverStrings> describeDriver(const GlFunctions& gl) {
    DriverStrings driver{text(gl, GL_VENDOR), text(gl, GL_RENDERER), text(gl, GL_VERSION)};
    constexpr std::array rasterisers{"llvmpipe", "softpipe",    "swrast",
                                     "SWR",      "SwiftShader", "Software Rasterizer"};
    for (const char* name : rasterisers) driver.software |= driver.renderer.find(name) != std::string::npos;

    GLint major = 0, minor = 0;
    gl.GetIntegerv(GL_MAJOR_VERSION, &major);
    gl.GetIntegerv(GL_MINOR_VERSION, &minor);
    if (major * 10 + minor < 45)
        return fail(ErrorCode::DeviceUnavailable,
                    fmt::format("The driver \"{}\" offers OpenGL {}.{}; 4.5 is needed.", driver.renderer,
                                major, minor));
    driver.memory = gpuMemory(gl);
    driver.atomics64 = hasExtension(gl, "GL_NV_shader_atomic_int64");
    GLint strategy = 0;
    gl.GetIntegerv(GL_RESET_NOTIFICATION_STRATEGY, &strategy);
    driver.tellsLoss = strategy == GL_LOSE_CONTEXT_ON_RESET;
    return driver;
}

bool hasExtension(const GlFunctions& gl, std::string_view name) {
    GLint count = 0;
    gl.GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; ++i) {
        const GLubyte* const bytes = gl.GetStringi(GL_EXTENSIONS, static_cast<GLuint>(i));
        if (bytes && name == reinterpret_cast<const char*>(bytes)) return true;
    }
    return false;
}

std::optional<std::uint64_t> freeGpuMemory(const GlFunctions& gl) {
    // Of extensions that the core's header does not know; both answer in KiB.
    constexpr GLenum currentAvailableVidmemNvx = 0x9049;  // GL_NVX_gpu_memory_info
    constexpr GLenum vboFreeMemoryAti = 0x87FB;           // GL_ATI_meminfo: of four numbers, the first is all
    GLint kib[4] = {};
    if (hasExtension(gl, "GL_NVX_gpu_memory_info"))
        gl.GetIntegerv(currentAvailableVidmemNvx, kib);
    else if (hasExtension(gl, "GL_ATI_meminfo"))
        gl.GetIntegerv(vboFreeMemoryAti, kib);
    if (kib[0] <= 0) return std::nullopt;
    return std::uint64_t(kib[0]) * 1024;
}

void logDriverMessages(const GlFunctions& gl) {
    gl.Enable(GL_DEBUG_OUTPUT);
    gl.DebugMessageCallback(&onMessage, nullptr);
    gl.DebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DEBUG_SEVERITY_NOTIFICATION, 0, nullptr, GL_FALSE);
}

}  // namespace scancast::gl
