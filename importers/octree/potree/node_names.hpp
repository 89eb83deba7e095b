// Names of the nodes of a Potree octree: "r" is the root, each digit a child of what stands before it. Pure functions.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>

namespace scancast::import_octree {

inline constexpr std::size_t mostPotreeNodes = 2'000'000;
inline constexpr std::size_t longestNodeName = 60;

/// 'r' and digits from 0 to 7.
bool isNodeName(std::string_view name);
/// Where the files of a node are: "r/012345/r012345678" with steps of 6; without steps beside each other.
std::string nodePath(const std::string& name, std::size_t step);
/// Lower corner of a node's cube: every digit halves it; bit 2 is x, bit 1 is y, bit 0 is z.
glm::dvec3 cornerOf(std::string_view name, const glm::dvec3& least, const glm::dvec3& size);

}  // namespace scancast::import_octree
