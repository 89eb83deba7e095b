// Numbers of points as people write them: 20M, 1.5e6, 2_000_000, 500k, 1G.
#pragma once

#include <cstdint>
#include <string_view>

#include "protocol/error.hpp"

namespace scancast {

/// Errors: InvalidArgument for what is no whole number of points from 1 to 10^12.
Expected<std::uint64_t> parsePointCount(std::string_view text);

}  // namespace scancast
