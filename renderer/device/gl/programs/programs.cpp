#include "renderer/device/gl/programs/programs.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <iterator>
#include <vector>

namespace scancast::gl {
namespace {

/// Everything that the driver says of itself; what it compiled, only the same one can take.
std::string driverName(const GlFunctions& gl) {
    std::string name;
    for (const GLenum what : {GL_VENDOR, GL_RENDERER, GL_VERSION, GL_SHADING_LANGUAGE_VERSION}) {
        const GLubyte* const words = gl.GetString(what);
        name.append(words ? reinterpret_cast<const char*>(words) : "").append("\n");
    }
    return name;
}

/// "splat.comp SHAPE=2 CLASSES=0": the variant in logs, labels and error messages.
std::string variantName(std::string_view shader, std::span<const Define> defines) {
    std::string name(shader);
    for (const Define& define : defines) name += fmt::format(" {}={}", define.name, define.value);
    return name;
}

}  // namespace

Programs::Programs(const GlFunctions& gl, const std::filesystem::path& folder, const Arithmetic& arithmetic)
    : gl_(gl), arithmetic_(arithmetic), driver_(driverName(gl)) {
    GLint formats = 0;
    gl_.GetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &formats);
    if (!folder.empty() && formats > 0) files_.emplace(folder);
}

Expected<const Program*> Programs::get(std::string_view shader, std::span<const Define> defines) {
    std::string name = variantName(shader, defines);
    if (const auto found = programs_.find(name); found != programs_.end()) return &found->second;
    std::vector<Define> all(defines.begin(), defines.end());
    std::ranges::copy(definesOf(arithmetic_), std::back_inserter(all));
    const auto source = assembleShader(shader, all);
    if (!source) return passOn(source);
    auto made = make(name, *source);
    if (!made) return passOn(made);
    return &programs_.emplace(std::move(name), std::move(*made)).first->second;
}

Expected<Program> Programs::make(const std::string& name, const std::string& source) const {
    if (!files_) return Program::compile(gl_, name, source);
    const ProgramKey key = ProgramKey::of(source, driver_);
    if (const auto kept = files_->read(key)) {
        if (auto program = Program::fromBinary(gl_, name, *kept)) return std::move(*program);
        spdlog::debug("The driver no longer takes what it compiled of {}; it is compiled again.", name);
    }
    auto compiled = Program::compile(gl_, name, source);
    if (compiled) {
        if (const ProgramBinary binary = compiled->binary(); !binary.bytes.empty())
            files_->write(key, binary);
    }
    return compiled;
}

}  // namespace scancast::gl
