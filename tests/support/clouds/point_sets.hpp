// Small point sets that a search for neighbours must survive. Deterministic.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <tuple>
#include <vector>

#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast::test {

using Points = std::vector<glm::vec3>;

inline glm::vec3 randomPoint(std::uint64_t i, std::uint64_t stream = 0) {
    return {float(uniform(i, 3 * stream)), float(uniform(i, 3 * stream + 1)),
            float(uniform(i, 3 * stream + 2))};
}

inline Points randomCube() {
    Points p(20000);
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = randomPoint(i) * 100.0f;
    return p;
}

/// Lines 1 apart, points 0.01 apart on them, with noise: k has to be doubled to see past the line.
inline Points scanLines() {
    Points p;
    for (int line = 0; line < 20; ++line)
        for (int i = 0; i < 1000; ++i) {
            const glm::vec3 noise = randomPoint(p.size()) * 0.002f;
            p.push_back(glm::vec3(float(i) * 0.05f, float(line), 0) + noise);
        }
    return p;
}

/// A thousandfold range of densities.
inline Points clusters() {
    Points p;
    for (int c = 0; c < 20; ++c) {
        const glm::vec3 at = randomPoint(std::uint64_t(c), 7) * 1000.0f;
        const float size = std::pow(10.0f, float(c % 4) - 1);
        for (int i = 0; i < 500; ++i) p.push_back(at + randomPoint(p.size()) * size);
    }
    return p;
}

inline Points duplicates() {
    Points p;
    for (std::size_t i = 0; i < 3000; ++i) p.push_back(randomPoint(i % 700) * 10.0f);
    for (std::size_t i = 0; i < 100000; ++i) p.push_back({5, 5, 5});
    for (std::size_t i = 0; i < 20000; ++i) p.push_back({5, 5, std::nextafter(5.0f, 6.0f)});
    return p;
}

/// Whole numbers: nearly all distances occur several times.
inline Points gridded() {
    Points p;
    for (int x = 0; x < 40; ++x)
        for (int y = 0; y < 40; ++y)
            for (int z = 0; z < 3; ++z) p.push_back({float(x), float(y), float(z)});
    return p;
}

inline Points farOutlier() {
    Points p;
    for (std::size_t i = 0; i < 20000; ++i) p.push_back(randomPoint(i) * 0.05f);
    p.push_back({1e6f, -1e6f, 3e5f});
    return p;
}

inline Points line() {
    Points p;
    for (int i = 0; i < 5000; ++i) p.push_back({float(i), 2 * float(i), -float(i)});
    return p;
}

inline Points few() {
    return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5f}, {1, 0, 0}};
}

inline Points distinct(Points p) {
    const auto place = [](const glm::vec3& v) { return std::tuple(v.x, v.y, v.z); };
    std::sort(p.begin(), p.end(),
              [&](const glm::vec3& a, const glm::vec3& b) { return place(a) < place(b); });
    p.erase(std::unique(p.begin(), p.end()), p.end());
    return p;
}

}  // namespace scancast::test
