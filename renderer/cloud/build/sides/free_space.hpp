// What can be seen from a cloud's facets: rays through a coarse grid in which whatever has a facet is solid.
// Pipeline: facets → **free space** → sides. Immutable; any thread may ask.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "renderer/cloud/build/sides/facet.hpp"

namespace scancast {

class FreeSpace {
  public:
    explicit FreeSpace(std::span<const Facet> facets);

    /// How far it is to what the ray meets, as a share of the farthest that is looked, 1 if that is nothing; nullopt
    /// where it leaves the cloud before. What is next to the place does not count.
    std::optional<float> wayToNext(const glm::vec3& from, const glm::vec3& direction) const;

    /// 14 unit vectors: along the axes and the diagonals.
    static const std::array<glm::vec3, 14>& directions();

  private:
    std::size_t cell(const std::array<int, 3>& at) const {
        return (std::size_t(at[2]) * std::size_t(size_[1]) + std::size_t(at[1])) * std::size_t(size_[0]) +
               std::size_t(at[0]);
    }

    glm::vec3 low_{0};
    float width_ = 1;
    std::array<int, 3> size_{1, 1, 1};
    std::vector<bool> solid_;
};

}  // namespace scancast
