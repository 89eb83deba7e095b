// Which side of every patch was scanned, decided once for all ranks: all facets come to rank 0, where they are judged together, and each
// rank hears of its own patches. Serial, and in proportion to the surface, not to the points. Pipeline: leaves → **sides** → leaves.
#pragma once

#include "ranks/mpi/communicator.hpp"
#include "renderer/cloud/build/octree_builder.hpp"

namespace scancast {

/// All ranks call it, those whose leaves could not be `grown`, too. Facets and borders count this rank's patches from 0, in the order of
/// its chunks, and so does the answer. Errors: those of growing, of any rank.
Expected<Sides> decideTogether(const Expected<void>& grown, std::vector<Facet>& facets,
                               std::span<const PatchCount> patches, std::span<const Border> borders,
                               bool upIsZ, const Communicator& ranks);

}  // namespace scancast
