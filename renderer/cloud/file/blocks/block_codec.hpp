// A node's samples as bytes in a cloud file, and back: exact, and smaller. Pure functions, from any thread.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/cloud/sample.hpp"

namespace scancast {

/// Deterministic: the same samples give the same bytes.
std::vector<std::byte> encodeSamples(std::span<const Sample> samples);
/// `into` has as many samples as were encoded. Malformed if the bytes do not decode to exactly those.
Expected<void> decodeSamples(std::span<const std::byte> block, std::span<Sample> into);

/// Rows of `rowBytes` bytes each.
std::vector<std::byte> encodeRows(std::span<const std::byte> rows, std::size_t rowBytes);
Expected<std::vector<std::byte>> decodeRows(std::span<const std::byte> block, std::size_t rowBytes,
                                            std::size_t rows);

}  // namespace scancast
