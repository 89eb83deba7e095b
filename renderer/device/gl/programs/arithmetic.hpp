// How a driver rounds quotients and roots, and what shaders do about it (shaders/exact.glsl): found out once,
// when a device opens, by asking for some thousands and comparing them with the processor's. Only with IEEE
// 754's results are a device's pictures the cpu device's, byte by byte. Place: driver → **arithmetic** →
// programs.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "renderer/device/gl/context/gl_functions.hpp"
#include "renderer/device/gl/programs/shader_source.hpp"

namespace scancast::gl {

/// As shaders/exact.glsl numbers them.
enum class Rounding : std::uint8_t {
    Own,          ///< the driver's own are rounded correctly
    ByFma,        ///< corrected by a fused multiply-add
    BySplitting,  ///< corrected by products of half as many bits, where fma() rounds twice
};

struct Arithmetic {
    Rounding rounding = Rounding::Own;
    bool exact = true;   ///< everything that was asked came out as IEEE 754 says
    bool rough = false;  ///< for tests: the driver's own are spoilt as far as OpenGL allows
};

/// What all shaders of a device are given.
std::array<Define, 2> definesOf(const Arithmetic& arithmetic);

/// The first rounding that is exact here; where none is, ByFma and not exact. `rough` and `programFolder`
/// (programs.hpp) as the device will have them. Inside a Current scope. Errors: Internal, ResourceLimit,
/// DeviceLost.
Expected<Arithmetic> findArithmetic(const GlFunctions& gl, const std::filesystem::path& programFolder,
                                    bool rough = false);

/// Whether one rounding is exact here.
Expected<bool> isExact(const GlFunctions& gl, const std::filesystem::path& programFolder,
                       const Arithmetic& arithmetic);

}  // namespace scancast::gl
