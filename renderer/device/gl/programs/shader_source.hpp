// Shader texts, embedded at build: looked up by name, includes put in, variants chosen by #define. Pure
// functions.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "protocol/error.hpp"

namespace scancast::gl {

struct EmbeddedShader {
    std::string_view name;  ///< "splat.comp"
    std::string_view text;
};
extern const EmbeddedShader embeddedShaders[];
extern const std::size_t embeddedShaderCount;

struct Define {
    std::string_view name;
    int value;
};

/// The text as the driver gets it: `#version` first, then the defines, then the rest with every `#include
/// "NAME"` line replaced by that shader's text. Internal for an unknown name, a missing #version or includes
/// more than eight deep.
Expected<std::string> assembleShader(std::string_view name, std::span<const Define> defines,
                                     std::span<const EmbeddedShader> library);
/// The same from what was embedded.
Expected<std::string> assembleShader(std::string_view name, std::span<const Define> defines);

/// "   1: text" per line: what the line numbers in a compiler's log refer to.
std::string withLineNumbers(std::string_view text);

}  // namespace scancast::gl
