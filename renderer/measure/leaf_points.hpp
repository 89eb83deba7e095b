// The scan's own points of a region, leaf by leaf, exactly where the scan has them: what measures are made of. Out of core: one
// block, or a few, at a time. Pipeline: cloud file → **leaf points** → volume, fit. Any thread, which waits for blocks.
//
// Blocks of a file on this machine are read beside the block cache: they are looked at once, and would push out what pictures need.
// Those of clouds behind a network come through it, several at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <stop_token>

#include "renderer/cloud/cloud.hpp"
#include "renderer/device/device.hpp"

namespace scancast {

/// File coordinates, its faces included.
struct MeasuredBox {
    glm::dvec3 low{0}, high{0};
};

/// Called with the points of a leaf that are drawn and lie in the box; never with none.
using UsePoints = std::function<void(std::span<const glm::dvec3> places)>;

/// Calls `use` for every leaf that touches the box, in their order. What the filter keeps out is no point, nor are outliers unless it
/// shows them. With `atOnce` above 1, so many leaves are decoded at the same time, in the caller's task arena; `use` is called on this
/// thread, and in the same order, all the same. Errors: the blocks', ExactPlaces'; Cancelled.
Expected<void> forLeafPoints(const Cloud& cloud, const SampleFilter& filter, const MeasuredBox& box,
                             const std::stop_token& stop, const UsePoints& use, int atOnce = 1);

/// Points of the leaves that touch the box: what forLeafPoints() goes over. Of clouds shown as they are, an estimate.
std::uint64_t pointsNear(const Cloud& cloud, const MeasuredBox& box);

}  // namespace scancast
