// Which compilation of the kernels runs here: the best that the processor knows, or the one that the
// environment variable SCANCAST_SIMD (v2, v3, v4) names. All give the same bytes; forcing one is for tests
// and for comparing.
#pragma once

#include <span>
#include <string_view>

#include "protocol/error.hpp"
#include "renderer/device/cpu/kernels/kernels.hpp"

namespace scancast::cpu {

struct SimdLevel {
    std::string_view name;   ///< "v2": x86-64-v2, as compilers call it
    std::string_view needs;  ///< what the processor must have, for people
    bool (*available)();
    const Kernels* kernels;
};

/// Best first.
std::span<const SimdLevel> simdLevels();

/// `forced` is the variable's value, or empty. Errors: InvalidArgument for an unknown name, DeviceUnavailable
/// where the processor lacks the level.
Expected<const SimdLevel*> chooseSimdLevel(std::string_view forced);

}  // namespace scancast::cpu
