// The `cpu` device: native, SIMD, all cores; the default where there is no real GPU.
//
// A picture in three steps: prepare the cut's runs (prepare.hpp), cut the picture into tiles of equal work
// (tiles.hpp), draw each tile start to end on one thread (kernels/). Between pictures nothing remains but
// buffers to use again, so an abandoned picture leaves no trace. Bytes do not depend on threads, tiles or
// SIMD level.
#pragma once

#include <memory>

#include "renderer/device/device.hpp"

namespace scancast {

/// `threads` 0 = all cores. The environment variable SCANCAST_SIMD (v2, v3, v4) forces a SIMD level. Errors:
/// InvalidArgument for a wrong thread count or level name; DeviceUnavailable where the processor lacks the
/// level.
Expected<std::unique_ptr<Device>> createCpuDevice(int threads);

}  // namespace scancast
