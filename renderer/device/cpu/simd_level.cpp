#include "renderer/device/cpu/simd_level.hpp"

#include <array>
#include <string>

#include "protocol/nearest_name.hpp"

namespace scancast::cpu {
namespace {

// The compiler's own check, which also asks whether the operating system saves the wide registers.
bool hasV2() {
    return __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt");
}

bool hasV3() {
    return hasV2() && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
           __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma");
}

bool hasV4() {
    return hasV3() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
}

}  // namespace

std::span<const SimdLevel> simdLevels() {
    static const std::array<SimdLevel, 3> levels{{
        {"v4", "AVX-512 (F, BW, CD, DQ, VL)", hasV4, &v4::kernels},
        {"v3", "AVX2, BMI2 and FMA", hasV3, &v3::kernels},
        {"v2", "SSE 4.2", hasV2, &v2::kernels},
    }};
    return levels;
}

Expected<const SimdLevel*> chooseSimdLevel(std::string_view forced) {
    for (const SimdLevel& level : simdLevels()) {
        if (!forced.empty() && forced != level.name) continue;
        if (level.available()) return &level;
        if (!forced.empty()) {
            return fail(ErrorCode::DeviceUnavailable,
                        "SCANCAST_SIMD=" + std::string(forced) + " needs a processor with " +
                            std::string(level.needs) + ", which this one lacks; unset SCANCAST_SIMD.");
        }
    }
    if (forced.empty()) {
        return fail(ErrorCode::DeviceUnavailable,
                    "The cpu device needs a processor with SSE 4.2 (x86-64-v2).");
    }
    return fail(
        ErrorCode::InvalidArgument,
        "SCANCAST_SIMD is " + quoteText(forced) + "; known are v2, v3 and v4, as in SCANCAST_SIMD=v3.",
        "SCANCAST_SIMD");
}

}  // namespace scancast::cpu
