// How far apart the samples of one node are: the number that decides when a node is fine enough for a view,
// and how large its splats must be to close the surface; and how far apart a cloud's points are. Pipeline: part of
// the octree builder. Pure functions.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "renderer/cloud/file/block_place.hpp"

namespace scancast {

struct Spacing {
    /// √(mean area of the samples' Voronoi cells): how many samples the surface has. A square grid's pitch.
    double mean = 0;
    double closing = 0;  ///< discs of this radius close the surface, see estimateSpacing(); ≥ mean
};

/// `closing`: the pitch of a square grid whose gaps are as large as those between these samples; 0 when there
/// are fewer than two distinct ones. On a square grid it is the pitch itself; randomly placed samples count
/// as a coarser grid than as many regular ones, and scan lines as a grid of nearly the distance between
/// lines, for what matters is the largest gap: discs of this radius close the surface, and drawing fewer
/// samples would open it.
///
/// For 64 samples, evenly spaced in the order given, the neighbourhood is flattened into its tangent plane,
/// and the sample's Voronoi cell there reaches as far as the middle of the largest gap beside it. Cells that
/// are open, at the border of the set, do not count unless nearly all are. Takes a high quantile: holes are
/// where samples are sparsest. Samples should be in an order that keeps neighbours together (Morton): it is
/// then faster.
Spacing estimateSpacing(std::span<const glm::vec3> samples);

/// A cloud's: the median of its leaves' mean spacings, each counting as many times as the leaf has points; 0 without any.
double typicalSpacing(std::span<const StoredNode> nodes);

}  // namespace scancast
