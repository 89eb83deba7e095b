// Samples as sixteen planes of bytes that compress well, and back: exact for any samples. Pure functions.
// Pipeline: samples → **transposed** → planes → block.
//
// Positions become differences to the sample before (neighbours in Morton order are neighbours in space) and
// colours differences to green and to the sample before; both with the sign in the lowest bit, so that small
// means small in either direction. The rest stands as it is.
#pragma once

#include <cstddef>
#include <span>

#include "renderer/cloud/sample.hpp"

namespace scancast {

/// `planes` has samples.size() · 16 bytes: all first bytes, all second bytes …
void toPlanes(std::span<const Sample> samples, std::span<std::byte> planes);
void fromPlanes(std::span<const std::byte> planes, std::span<Sample> samples);

}  // namespace scancast
