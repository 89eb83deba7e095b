// A kept column's values as numbers, out of the bytes that a plane has of them. Pure functions; any thread.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// One for each stored number: offset + scale * number. Bytes that are no whole number of them are left out.
std::vector<double> valuesOf(std::span<const std::byte> stored, const Column& column);

}  // namespace scancast
