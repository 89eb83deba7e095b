// Which patches of a whole cloud agree on a side: neighbouring facets of different patches vote, and a spanning
// forest takes the surest votes first. Pipeline: facets → **patch graph** → sides. Pure function; uses the
// caller's TBB arena. Source: Hoppe et al., "Surface Reconstruction from Unorganized Points", 1992;
// docs/spec/surfels.md §9.
#pragma once

#include <span>
#include <vector>

#include "renderer/cloud/build/sides/facet.hpp"

namespace scancast {

/// Patches that hang together.
struct PatchForest {
    std::vector<std::uint32_t> tree;  ///< by patch: number of its tree, from 0
    std::vector<bool> turned;         ///< by patch: against the tree's side
    std::vector<float> trust;  ///< by patch: the weakest vote between it and the tree's largest patch, 0-1
    std::uint32_t trees = 0;
};

/// The surest first; those that say nothing left out. `known`: what points have said already.
std::vector<Border> bordersOf(std::span<const Facet> facets, std::span<const Border> known);

/// What a patch says of its own side: for it, against it, and how much was asked.
struct OwnSide {
    double net = 0, all = 0;
};

/// Patches that plainly say the opposite of each other are not joined. `own` may be empty.
PatchForest joinPatches(std::span<const Border> borders, std::span<const PatchCount> patches,
                        std::span<const OwnSide> own);

}  // namespace scancast
