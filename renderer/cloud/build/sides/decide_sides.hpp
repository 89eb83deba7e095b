// Which side of every patch was scanned, and how sure that is. Pipeline: facets of a whole cloud → **sides** →
// leaves' samples, averages. Pure function; uses the caller's TBB arena. Source: docs/spec/surfels.md §9.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/cloud/build/sides/facet.hpp"

namespace scancast {

/// What the facets are of, as far as it matters here.
enum class Surroundings : std::uint8_t {
    Object,   ///< things seen from outside
    Open,     ///< ground, and what stands on it, under an open sky
    Interior  ///< what encloses other things: seen from within
};

struct Sides {
    std::vector<bool> turn;                ///< by patch: its normals point to the wrong side
    std::vector<std::uint8_t> confidence;  ///< by patch, as Node::confidence; never certainSide
    Surroundings surroundings = Surroundings::Object;
};

/// `borders`: in the order of low and high. `upIsZ`: the scan says which way is up; else nothing is taken for ground.
Sides decideSides(std::span<const Facet> facets, std::span<const PatchCount> patches,
                  std::span<const Border> borders, bool upIsZ);

}  // namespace scancast
