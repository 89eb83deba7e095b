// What neighbours say of each other's surfaces: the density of every position, by its own neighbourhood and its
// witnesses' - who stands nearest or, on a line, beside it. Owned by estimateSurfels() for one call; filled by
// many threads, each its own positions, then read. Pipeline: solved neighbourhoods → **evidence** → surfels.
// Source: docs/spec/surfels.md §8.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "renderer/cloud/density.hpp"
#include "renderer/cloud/surfels/kernels/surfel_kernels.hpp"
#include "renderer/cloud/surfels/neighbours.hpp"

namespace scancast {

class Evidence {
  public:
    /// Says nothing before every position of the index was added.
    explicit Evidence(const NeighbourIndex& index);

    void add(const surfel::Solved& solved);

    /// The lower median of the witnesses' radii; its own where it has none, or none is much smaller.
    float usualRadius(std::uint32_t p) const;
    /// Never Stray. Who is large for the spacing of the node that it is drawn with has to have more evidence.
    Density density(std::uint32_t p, float spacing) const;
    /// Of foliage: how much it looks like a rough surface with points all around, 0 - 1.
    float rough(std::uint32_t p) const;
    float radius(std::uint32_t p) const { return facts_[p].radius; }
    float nearby(std::uint32_t p) const { return facts_[p].nearby; }
    const glm::vec3& normal(std::uint32_t p) const { return facts_[p].normal; }
    /// Of its neighbourhood, from the position: where the normal of a plane that lies nearest to all of it is the surface's.
    const glm::vec3& middle(std::uint32_t p) const { return facts_[p].middle; }
    /// Where more is known of it than its neighbours tell.
    void setNormal(std::uint32_t p, const glm::vec3& normal) {
        facts_[p].normal = normal;
        facts_[p].middle = glm::vec3(0);
    }
    std::span<const std::uint32_t> witnesses(std::uint32_t p) const {
        return std::span(witnesses_[p]).first(facts_[p].witnesses);
    }

  private:
    struct Facts {
        float radius, nearby;
        glm::vec3 normal, middle;
        std::uint8_t witnesses;
        bool flat, extended, line;
    };

    /// Whether witnesses' witnesses and the point lie in a plane that goes on: the surface under the noise.
    bool flatFarther(std::uint32_t p, double mostRatio, double leastWidth) const;

    const NeighbourIndex& index_;
    std::vector<Facts> facts_;
    std::vector<std::array<std::uint32_t, surfel::mostWitnesses>> witnesses_;
};

}  // namespace scancast
