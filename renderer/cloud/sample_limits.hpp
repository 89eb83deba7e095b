// What is known of a few dozen samples in a row without looking at them: where they lie and how large the
// largest is. Samples follow a space-filling curve, so such a row is small, and devices leave out what is
// hidden or elsewhere for a hundredth of what reading it would cost. Made once, when samples come into
// memory.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/cloud/sample.hpp"

namespace scancast {

struct SampleLimits {
    std::uint16_t low[3], high[3];   ///< of x, y, z, inclusive
    std::uint8_t largestRadius = 0;  ///< code (surfel_codec.hpp); 0 = no radius is known
    bool plain = false;              ///< some radius is not known
    std::uint16_t unused = 0;
};
static_assert(sizeof(SampleLimits) == 16);

inline constexpr std::size_t samplesPerLimits = 64;

constexpr std::uint64_t limitsBytes(std::uint64_t samples) {
    return (samples + samplesPerLimits - 1) / samplesPerLimits * sizeof(SampleLimits);
}

/// One for every samplesPerLimits samples, the last for what is left.
std::vector<SampleLimits> limitsOf(std::span<const Sample> samples);

}  // namespace scancast
