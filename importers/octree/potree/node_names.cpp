#include "importers/octree/potree/node_names.hpp"

#include <algorithm>

namespace scancast::import_octree {

bool isNodeName(std::string_view name) {
    return name.starts_with('r') &&
           std::all_of(name.begin() + 1, name.end(), [](char c) { return c >= '0' && c <= '7'; });
}

std::string nodePath(const std::string& name, std::size_t step) {
    if (step == 0) return name;
    std::string path = "r/";
    for (std::size_t at = 1; at + step <= name.size(); at += step) path += name.substr(at, step) + '/';
    return path + name;
}

glm::dvec3 cornerOf(std::string_view name, const glm::dvec3& least, const glm::dvec3& size) {
    glm::dvec3 corner = least;
    glm::dvec3 half = size / 2.0;
    for (const char digit : name.substr(1)) {
        for (int axis = 0; axis < 3; ++axis)
            if (((digit - '0') & (4 >> axis)) != 0) corner[axis] += half[axis];
        half /= 2.0;
    }
    return corner;
}

}  // namespace scancast::import_octree
