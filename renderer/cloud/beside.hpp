// What stands beside a sample's sixteen bytes, in four more: how the surface bends there, and its near infrared. In a
// cloud file these are planes of their own (file/CLOUD_FILE.md); in memory and on devices they are one word, which
// comes with the samples where somebody asks for it. Plain values.
#pragma once

#include <cstdint>

#include "renderer/cloud/curvature.hpp"

namespace scancast {

/// The lower three bytes: a CurvatureCode. The highest: near infrared, 0-255. 0 each where there is none.
using BesideWord = std::uint32_t;

inline constexpr BesideWord besideCurvature = 0x00ffffff;

constexpr CurvatureCode curvatureIn(BesideWord word) {
    return word & besideCurvature;
}
constexpr std::uint8_t nearInfraredIn(BesideWord word) {
    return std::uint8_t(word >> 24);
}
constexpr BesideWord withCurvature(BesideWord word, CurvatureCode code) {
    return (word & ~besideCurvature) | (code & besideCurvature);
}
constexpr BesideWord withNearInfrared(BesideWord word, std::uint8_t value) {
    return curvatureIn(word) | BesideWord(value) << 24;
}

}  // namespace scancast
