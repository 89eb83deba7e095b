// How exposure changes the points' own colours: docs/spec/shading.md §8. A pure function.
#pragma once

#include <array>
#include <cstdint>

namespace scancast {

/// By sRGB value: what a channel is drawn as when its light is 2^stops times as much. Monotone; black stays
/// black, white becomes no more than white, and 0 stops change nothing.
std::array<std::uint8_t, 256> toneCurve(double stops);

}  // namespace scancast
