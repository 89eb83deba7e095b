// The device `ranks`: pictures drawn by all ranks together, each with its share of the samples, byte for byte as the cpu device
// draws them (docs/decisions/025-pictures-by-ranks.md). Rank 0 has it, and above it everything that has a device; the others are in
// drawWithFirst() meanwhile.
//
// Owned by one thread, as every device; nobody else may use its communicator as long as it lives.
#pragma once

#include <memory>

#include "ranks/draw/rank_clouds.hpp"
#include "ranks/draw/rank_reduction.hpp"
#include "renderer/device/device.hpp"

namespace scancast {

/// `clouds` tells which drawings are shared; others are drawn by rank 0 alone. `traffic`: of rank 0; outlives it.
Expected<std::unique_ptr<Device>> createRanksDevice(const Communicator& ranks,
                                                    std::shared_ptr<const SharedClouds> clouds, int threads,
                                                    RankTraffic& traffic);

/// What would keep this rank from drawing at all: to be agreed on before anybody waits for it. Errors: createCpuDevice()'s.
Expected<void> canDraw(int threads);
/// All ranks but the first: opens what rank 0 opens and draws what its device draws, until letGo(). Errors: the communicator's.
Expected<void> drawWithFirst(const Communicator& ranks, OpenedClouds& clouds, int threads);
/// Rank 0: the others' drawWithFirst() returns. After its device is gone and its clouds are closed; `opening` is theirs.
Expected<void> letGo(const Communicator& ranks, const Communicator& opening);

}  // namespace scancast
