// A drawing (renderer/device/device.hpp) as bytes, on its way from the rank that shows to the others: everything that decides the
// picture, and of its cuts which nodes, in their order; samples stay where they are. Between processes of one program on one kind of
// machine: numbers travel as they lie in memory. Pure functions; any thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/error.hpp"
#include "ranks/mpi/rank_bytes.hpp"
#include "renderer/cloud/octree.hpp"
#include "renderer/device/device.hpp"
#include "renderer/residency/node_share.hpp"

namespace scancast {

RankBytes packDrawing(const CloudPlace& cloud, const Drawing& drawing);

/// Owns what its drawing refers to. Its runs know their nodes once findNodes() has been called, and have no samples.
struct UnpackedDrawing {
    CloudPlace cloud;
    std::vector<CutView> cuts;
    std::optional<CutView> sun;
    PassList passes;
    std::vector<glm::dvec2> jitter;
    Drawing drawing;

    /// All cuts, the sun's last.
    std::vector<CutView*> allCuts();
    /// InvalidArgument: this is not the cloud that it was drawn of.
    Expected<void> findNodes(const Octree& octree);
};

/// Internal: these are not the bytes of a drawing.
Expected<std::unique_ptr<UnpackedDrawing>> unpackDrawing(std::span<const std::byte> bytes);

}  // namespace scancast
