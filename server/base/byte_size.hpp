// Sizes as people write them: 2G, 512M, 1.5 GiB. Pure functions.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "protocol/error.hpp"

namespace scancast {

/// A number and k, M, G or T (each 1024 of the former), with or without B or iB behind it; none = bytes.
/// InvalidArgument, naming `flag`.
Expected<std::uint64_t> parseByteSize(std::string_view text, std::string_view flag);

/// What --gpu-memory-limit says; nothing = 0, for what is usual there. InvalidArgument, also below 16M: each
/// picture would be drawn in a hundred parts.
Expected<std::uint64_t> parseGpuMemoryLimit(std::string_view text);

/// "950 bytes", "12.5 MB", "2.00 GB": three digits, powers of ten.
std::string byteSizeText(std::uint64_t bytes);

}  // namespace scancast
