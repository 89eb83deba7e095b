// Move-only owners of OpenGL objects, and waiting. Everything here is called, and destroyed, inside a Current
// scope of the context whose functions were given.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "renderer/device/gl/context/gl_context.hpp"
#include "renderer/device/gl/programs/program_files.hpp"

namespace scancast::gl {

/// Nothing that is asked of a GPU in one piece takes longer, unless it is lost.
inline constexpr GLuint64 longestWaitNs = 10'000'000'000;

/// A buffer that grows and is used again from frame to frame.
class Buffer {
  public:
    enum class Use : std::uint8_t {
        Device,  ///< small writes by write(), work on the GPU, read back by read()
        Copies,  ///< filled by the GPU, which copies from other buffers
    };

    Buffer(const GlFunctions& gl, const char* what, Use use = Use::Device)
        : gl_(&gl), what_(what), use_(use) {}
    Buffer(Buffer&& other) noexcept
        : gl_(other.gl_),
          what_(other.what_),
          use_(other.use_),
          name_(std::exchange(other.name_, 0)),
          capacity_(std::exchange(other.capacity_, 0)) {}
    Buffer& operator=(Buffer&&) = delete;
    ~Buffer();

    /// Makes room for `bytes`; what was in it is lost where it has to grow. ResourceLimit when there is no
    /// memory.
    Expected<void> reserve(std::size_t bytes);
    /// reserve() and fill from the start.
    Expected<void> write(std::span<const std::byte> bytes);
    /// Sets the first `words` 32-bit words.
    void clear(std::size_t words, std::uint32_t value);
    /// Reads from the start; waits for the GPU.
    void read(std::span<std::byte> out) const;

    void bindStorage(unsigned binding) const {
        gl_->BindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, name_);
    }
    void bindUniform(unsigned binding) const { gl_->BindBufferBase(GL_UNIFORM_BUFFER, binding, name_); }
    GLuint name() const { return name_; }

  private:
    const GlFunctions* gl_;
    const char* what_;  ///< for people: "sample page"
    Use use_;
    GLuint name_ = 0;
    std::size_t capacity_ = 0;
};

/// What is in a buffer, to be fetched as texels of one, two or four words (uvec4). Read so where every thread
/// reads another place: texels come through the texture units, and Mesa's rasteriser fetches them a vector at
/// a time, while it reads a storage block lane by lane.
class Texels {
  public:
    /// The buffer outlives them, and grows no more.
    Texels(const GlFunctions& gl, const Buffer& buffer, std::size_t words);
    Texels(Texels&& other) noexcept : gl_(other.gl_), name_(std::exchange(other.name_, 0)) {}
    Texels& operator=(Texels&&) = delete;
    ~Texels();

    void bind(unsigned unit) const { gl_->BindTextureUnit(unit, name_); }

  private:
    const GlFunctions* gl_;
    GLuint name_ = 0;
};

/// Texels that a buffer may have, at least the 65,536 that OpenGL promises.
std::size_t mostTexels(const GlFunctions& gl);

/// A linked compute program.
class Program {
  public:
    /// Internal, with the driver's log and the numbered source, when it does not compile.
    static Expected<Program> compile(const GlFunctions& gl, const std::string& name,
                                     const std::string& source);
    /// What binary() gave earlier. Unsupported when the driver takes it no longer.
    static Expected<Program> fromBinary(const GlFunctions& gl, const std::string& name,
                                        const ProgramBinary& binary);
    Program(Program&& other) noexcept : gl_(other.gl_), name_(std::exchange(other.name_, 0)) {}
    Program& operator=(Program&&) = delete;
    ~Program();

    void use() const { gl_->UseProgram(name_); }
    /// What the driver made of the source; no bytes where it gives none.
    ProgramBinary binary() const;

  private:
    /// `name` for the driver's messages.
    Program(const GlFunctions& gl, const std::string& name);
    const GlFunctions* gl_;
    GLuint name_;
};

/// Waits for a fence and deletes it. DeviceLost, naming `during`, when the GPU was reset, or takes more than
/// ten seconds: slices of work are milliseconds long.
Expected<void> finishFence(const GlFunctions& gl, GLsync fence, const std::string& during);

/// Waits until everything asked of the GPU so far is done. DeviceLost as above.
Expected<void> waitForGpu(const GlFunctions& gl);

/// What went wrong since the last look: ResourceLimit, DeviceLost, Internal.
Expected<void> checkErrors(const GlFunctions& gl, const std::string& during);

}  // namespace scancast::gl
