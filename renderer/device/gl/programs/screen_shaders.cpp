#include "renderer/device/gl/programs/screen_shaders.hpp"

namespace scancast::gl {
namespace {

constexpr int groupWidth = 32, groupHeight = 8;

}  // namespace

ScreenShaders::ScreenShaders(const GlFunctions& gl, Programs& programs)
    : gl_(gl), programs_(programs), params_(gl, "parameters of screen passes") {
    GLint64 bytes = 0;
    gl_.GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
    if (bytes > 0) largestBuffer_ = static_cast<std::size_t>(bytes);
}

Expected<void> ScreenShaders::run(std::string_view shader, int groupsX, int groupsY,
                                  std::span<const Define> defines, const std::uint32_t* base) {
    const auto program = programs_.get(shader, defines);
    if (!program) return passOn(program);
    (*program)->use();
    if (base != nullptr) gl_.Uniform1ui(0, *base);
    gl_.DispatchCompute(static_cast<GLuint>(groupsX), static_cast<GLuint>(groupsY), 1);
    gl_.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    return {};
}

Expected<void> ScreenShaders::overPixels(std::string_view shader, int width, int height,
                                         std::span<const Define> defines) {
    return run(shader, tilesOf(width, groupWidth), tilesOf(height, groupHeight), defines);
}

}  // namespace scancast::gl
