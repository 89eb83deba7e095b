// What shader_compile_test.cpp compiles of the shaders that draw splats.
#pragma once

#include <vector>

#include "renderer/device/gl/programs/splat_variants.hpp"

namespace scancast::gl {

/// Every variant that some list of passes can ask for, of splat.comp and the three that resolve, each once.
std::vector<ShaderVariant> everySplatVariant();

}  // namespace scancast::gl
