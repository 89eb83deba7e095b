// What the headers of PCD and PLY files have in common: lines of words that say how many of what follow.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace scancast::import_pcl {

/// More than any file holds; keeps products within 64 bits.
inline constexpr std::uint64_t mostItems = std::uint64_t(1) << 48;

/// The words of a line, between spaces, tabs and carriage returns.
std::vector<std::string_view> words(std::string_view line);

}  // namespace scancast::import_pcl
