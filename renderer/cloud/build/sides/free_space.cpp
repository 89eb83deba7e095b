#include "renderer/cloud/build/sides/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace scancast {

namespace {

/// Cells are as wide as facets, about, and at most so many.
constexpr float facetWidths = 0.8f;
constexpr double mostCellsOfSpace = 1 << 24;
/// Cells that a ray has left before it meets anything, and that it goes at most.
constexpr float cellsOfStart = 2, cellsOfWay = 100;

float usualWidth(std::span<const Facet> facets) {
    std::vector<float> areas;
    for (const Facet& f : facets) areas.push_back(f.area);
    if (areas.empty()) return 0;
    const auto middle = areas.begin() + std::ptrdiff_t(areas.size() / 2);
    std::nth_element(areas.begin(), middle, areas.end());
    return std::sqrt(*middle);
}

}  // namespace

FreeSpace::FreeSpace(std::span<const Facet> facets) {
    glm::vec3 high(-1e30f);
    low_ = glm::vec3(1e30f);
    for (const Facet& f : facets) {
        low_ = glm::min(low_, f.position);
        high = glm::max(high, f.position);
    }
    const glm::vec3 extent = glm::max(high - low_, glm::vec3(0));
    const float longest = std::max({extent.x, extent.y, extent.z});
    width_ = std::max(facetWidths * usualWidth(facets), longest > 0 ? longest / 4096 : 1.0f);
    const auto cells = [&] {
        const glm::dvec3 n = glm::floor(glm::dvec3(extent) / double(width_)) + 1.0;
        return n.x * n.y * n.z;
    };
    while (cells() > mostCellsOfSpace) width_ *= 1.25f;
    for (int a = 0; a < 3; ++a) size_[std::size_t(a)] = int(extent[a] / width_) + 1;
    solid_.resize(std::size_t(size_[0]) * std::size_t(size_[1]) * std::size_t(size_[2]));
    for (const Facet& f : facets) {
        // As wide as the facet, but across it.
        const float reach = 0.6f * std::sqrt(f.area);
        std::array<int, 3> first{}, last{};
        for (std::size_t a = 0; a < 3; ++a) {
            const float along = reach * std::sqrt(std::max(0.0f, 1 - f.normal[int(a)] * f.normal[int(a)]));
            const float at = f.position[int(a)] - low_[int(a)];
            first[a] = std::clamp(int((at - along) / width_), 0, size_[a] - 1);
            last[a] = std::clamp(int((at + along) / width_), 0, size_[a] - 1);
            first[a] = std::max(first[a], last[a] - 8);
        }
        for (int z = first[2]; z <= last[2]; ++z)
            for (int y = first[1]; y <= last[1]; ++y)
                for (int x = first[0]; x <= last[0]; ++x) {
                    // Only cells near the facet's plane.
                    const glm::vec3 middle = low_ + (glm::vec3(x, y, z) + 0.5f) * width_ - f.position;
                    const float off = middle.x * f.normal.x + middle.y * f.normal.y + middle.z * f.normal.z;
                    if (std::abs(off) <= 0.9f * width_) solid_[cell({x, y, z})] = true;
                }
    }
}

std::optional<float> FreeSpace::wayToNext(const glm::vec3& from, const glm::vec3& direction) const {
    glm::vec3 at = (from - low_) / width_ + direction * cellsOfStart;
    for (float way = cellsOfStart;; ++way, at += direction) {
        std::array<int, 3> in{};
        for (int a = 0; a < 3; ++a) {
            if (at[a] < 0 || at[a] >= float(size_[std::size_t(a)])) return std::nullopt;
            in[std::size_t(a)] = int(at[a]);
        }
        if (way > cellsOfWay) return 1.0f;
        if (solid_[cell(in)]) return way / cellsOfWay;
    }
}

const std::array<glm::vec3, 14>& FreeSpace::directions() {
    constexpr float d = 0.57735027f;
    static const std::array<glm::vec3, 14> all{
        glm::vec3{0, 0, 1}, {0, 0, -1}, {1, 0, 0},   {-1, 0, 0}, {0, 1, 0},   {0, -1, 0},  {d, d, d},
        {-d, d, d},         {d, -d, d}, {-d, -d, d}, {d, d, -d}, {-d, d, -d}, {d, -d, -d}, {-d, -d, -d}};
    return all;
}

}  // namespace scancast
