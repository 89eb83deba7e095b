#include "renderer/device/gl/programs/gl_handles.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/device/gl/programs/shader_source.hpp"

namespace scancast::gl {
namespace {

constexpr std::size_t smallestBuffer = 256;

/// A shader object while its program is being linked.
struct Shader {
    const GlFunctions& gl;
    GLuint name;
    explicit Shader(const GlFunctions& functions) : gl(functions), name(gl.CreateShader(GL_COMPUTE_SHADER)) {}
    Shader(const Shader&) = delete;
    Shader& operator=(const Shader&) = delete;
    ~Shader() { gl.DeleteShader(name); }
};

std::string logOf(GLuint name, PFNGLGETSHADERIVPROC get, PFNGLGETSHADERINFOLOGPROC getLog) {
    GLint length = 0;
    get(name, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(std::clamp(length, 0, 1 << 20)), '\0');
    if (!log.empty()) getLog(name, static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(std::min(log.size(), static_cast<std::size_t>(std::max(length, 0))));
    return log;
}

/// What the driver's messages call an object; drivers take at least 256 characters.
void label(const GlFunctions& gl, GLenum kind, GLuint object, std::string_view words) {
    constexpr std::size_t longest = 255;
    gl.ObjectLabel(kind, object, static_cast<GLsizei>(std::min(words.size(), longest)), words.data());
}

/// DeviceLost, and by whose fault, where the context tells such things (egl_context.cpp).
Expected<void> checkReset(const GlFunctions& gl, const std::string& during) {
    const char* fault = nullptr;
    switch (gl.GetGraphicsResetStatus()) {
        case GL_NO_ERROR:
            return {};
        case GL_GUILTY_CONTEXT_RESET:
            fault = "by what Scancast asked of it";
            break;
        case GL_INNOCENT_CONTEXT_RESET:
            fault = "by what another program asked of it";
            break;
        default:
            fault = "and the driver does not say why";
    }
    return fail(ErrorCode::DeviceLost, fmt::format("The GPU was reset while {}, {}.", during, fault));
}

}  // namespace

Buffer::~Buffer() {
    if (name_) gl_->DeleteBuffers(1, &name_);
}

Expected<void> Buffer::reserve(std::size_t bytes) {
    if (bytes <= capacity_ && name_) return {};
    if (name_) gl_->DeleteBuffers(1, &name_);
    capacity_ = 0;
    gl_->CreateBuffers(1, &name_);
    label(*gl_, GL_BUFFER, name_, what_);
    const std::size_t size = std::max(bytes, smallestBuffer);
    const GLbitfield access = use_ == Use::Copies ? 0 : GL_DYNAMIC_STORAGE_BIT;
    gl_->NamedBufferStorage(name_, static_cast<GLsizeiptr>(size), nullptr, access);
    auto made = checkErrors(*gl_, fmt::format("making room for the {} ({} bytes)", what_, size));
    if (made) capacity_ = size;
    return made;
}

Expected<void> Buffer::write(std::span<const std::byte> bytes) {
    if (auto ok = reserve(bytes.size()); !ok) return ok;
    if (!bytes.empty())
        gl_->NamedBufferSubData(name_, 0, static_cast<GLsizeiptr>(bytes.size()), bytes.data());
    return {};
}

void Buffer::clear(std::size_t words, std::uint32_t value) {
    gl_->ClearNamedBufferSubData(name_, GL_R32UI, 0, static_cast<GLsizeiptr>(words * 4), GL_RED_INTEGER,
                                 GL_UNSIGNED_INT, &value);
}

void Buffer::read(std::span<std::byte> out) const {
    gl_->GetNamedBufferSubData(name_, 0, static_cast<GLsizeiptr>(out.size()), out.data());
}

Texels::Texels(const GlFunctions& gl, const Buffer& buffer, std::size_t words) : gl_(&gl) {
    const GLenum format = words == 1 ? GL_R32UI : words == 2 ? GL_RG32UI : GL_RGBA32UI;
    gl.CreateTextures(GL_TEXTURE_BUFFER, 1, &name_);
    gl.TextureBuffer(name_, format, buffer.name());
}

Texels::~Texels() {
    if (name_) gl_->DeleteTextures(1, &name_);
}

std::size_t mostTexels(const GlFunctions& gl) {
    constexpr GLint64 promised = 65536;
    GLint64 texels = 0;
    gl.GetInteger64v(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
    return static_cast<std::size_t>(std::max(texels, promised));
}

Program::Program(const GlFunctions& gl, const std::string& name) : gl_(&gl), name_(gl.CreateProgram()) {
    label(gl, GL_PROGRAM, name_, name);
}

Expected<Program> Program::compile(const GlFunctions& gl, const std::string& name,
                                   const std::string& source) {
    Program program(gl, name);
    const Shader shader(gl);
    const char* const text = source.c_str();
    gl.ShaderSource(shader.name, 1, &text, nullptr);
    gl.CompileShader(shader.name);
    GLint ok = GL_FALSE;
    gl.GetShaderiv(shader.name, GL_COMPILE_STATUS, &ok);
    if (!ok)
        return fail(
            ErrorCode::Internal,
            fmt::format("The driver does not compile the shader {}:\n{}\n{}", name,
                        logOf(shader.name, gl.GetShaderiv, gl.GetShaderInfoLog), withLineNumbers(source)));
    gl.AttachShader(program.name_, shader.name);
    gl.ProgramParameteri(program.name_, GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
    gl.LinkProgram(program.name_);
    gl.GetProgramiv(program.name_, GL_LINK_STATUS, &ok);
    if (!ok)
        return fail(ErrorCode::Internal,
                    fmt::format("The driver does not link the shader {}:\n{}", name,
                                logOf(program.name_, gl.GetProgramiv, gl.GetProgramInfoLog)));
    return program;
}

Expected<Program> Program::fromBinary(const GlFunctions& gl, const std::string& name,
                                      const ProgramBinary& binary) {
    Program program(gl, name);
    gl.ProgramBinary(program.name_, binary.format, binary.bytes.data(),
                     static_cast<GLsizei>(binary.bytes.size()));
    GLint ok = GL_FALSE;
    gl.GetProgramiv(program.name_, GL_LINK_STATUS, &ok);
    // A format that the driver does not know is an OpenGL error, which nobody else shall find.
    const auto clean = checkErrors(gl, "loading the compiled shader " + name);
    if (!clean && clean.error().code == ErrorCode::DeviceLost) return passOn(clean);
    if (!clean || !ok)
        return fail(ErrorCode::Unsupported, "The driver does not take the compiled shader " + name + ".");
    return program;
}

ProgramBinary Program::binary() const {
    GLint length = 0;
    gl_->GetProgramiv(name_, GL_PROGRAM_BINARY_LENGTH, &length);
    constexpr GLint longest = 16 << 20;
    if (length <= 0 || length > longest) return {};
    ProgramBinary binary;
    binary.bytes.resize(static_cast<std::size_t>(length));
    GLsizei written = 0;
    GLenum format = 0;
    gl_->GetProgramBinary(name_, length, &written, &format, binary.bytes.data());
    binary.format = format;
    binary.bytes.resize(static_cast<std::size_t>(std::clamp(written, 0, length)));
    return binary;
}

Program::~Program() {
    if (name_) gl_->DeleteProgram(name_);
}

Expected<void> finishFence(const GlFunctions& gl, GLsync fence, const std::string& during) {
    const GLenum result =
        fence ? gl.ClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, longestWaitNs) : GL_WAIT_FAILED;
    if (fence) gl.DeleteSync(fence);
    // Of a context that was lost, fences count as passed.
    if (auto ok = checkReset(gl, during); !ok) return ok;
    if (result == GL_ALREADY_SIGNALED || result == GL_CONDITION_SATISFIED) return {};
    if (auto ok = checkErrors(gl, during); !ok) return ok;
    return fail(ErrorCode::DeviceLost,
                fmt::format("glClientWaitSync: the GPU was not done within ten seconds, {}.", during));
}

Expected<void> waitForGpu(const GlFunctions& gl) {
    return finishFence(gl, gl.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0), "waiting for the GPU");
}

Expected<void> checkErrors(const GlFunctions& gl, const std::string& during) {
    if (auto ok = checkReset(gl, during); !ok) return ok;
    const GLenum first = gl.GetError();
    if (first == GL_CONTEXT_LOST)
        return fail(ErrorCode::DeviceLost,
                    fmt::format("The GPU was lost while {} (GL_CONTEXT_LOST).", during));
    if (first == GL_NO_ERROR) return {};
    // A second look at most finds the next error; a broken driver must not hold us here.
    for (int i = 0; i < 16 && gl.GetError() != GL_NO_ERROR; ++i) {
    }
    if (first == GL_OUT_OF_MEMORY)
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("The GPU has no memory left (GL_OUT_OF_MEMORY) while {}.", during));
    return fail(ErrorCode::Internal, fmt::format("OpenGL reports {} while {}.", glErrorName(first), during));
}

}  // namespace scancast::gl
