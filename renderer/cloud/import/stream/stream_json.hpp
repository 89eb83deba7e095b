// What descriptions in a point stream are made of: lists of three numbers. Pure functions.
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

namespace scancast::point_stream {

inline nlohmann::json numbers(const glm::dvec3& v) {
    return nlohmann::json::array({v.x, v.y, v.z});
}

/// False where it is not three finite numbers.
inline bool takeVector(const nlohmann::json& list, glm::dvec3& into) {
    if (!list.is_array() || list.size() != 3) return false;
    for (int a = 0; a < 3; ++a) {
        const nlohmann::json& value = list[std::size_t(a)];
        if (!value.is_number()) return false;
        into[a] = value.get<double>();
        if (!std::isfinite(into[a])) return false;
    }
    return true;
}

}  // namespace scancast::point_stream
