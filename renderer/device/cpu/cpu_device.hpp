// The `cpu` device: native, SIMD, all cores; the default where there is no real GPU.
//
// A picture in three steps: prepare the cut's runs (prepare.hpp), cut the picture into tiles of equal work
// (tiles.hpp), draw each tile start to end on one thread (kernels/). Between pictures nothing remains but
// buffers to use again, so an abandoned picture leaves no trace. Bytes do not depend on threads, tiles or
// SIMD level.
#pragma once

#include <memory>

#include "renderer/device/cpu/pass_reduction.hpp"
#include "renderer/device/device.hpp"

namespace scancast {

/// `threads` 0 = all cores. The environment variable SCANCAST_SIMD (v2, v3, v4) forces a SIMD level. Errors:
/// InvalidArgument for a wrong thread count or level name; DeviceUnavailable where the processor lacks the
/// level.
/// With a `reduction` its pictures are drawn together with other devices', which are told to draw the same at the same
/// time, each with the samples of its share alone: other runs of the cut have none, but their ordinals. It pauses
/// between passes then; the frames of devices that do not show are empty.
Expected<std::unique_ptr<Device>> createCpuDevice(int threads,
                                                  std::unique_ptr<cpu::PassReduction> reduction = nullptr);

}  // namespace scancast
