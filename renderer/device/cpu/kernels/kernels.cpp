// Compiled once per SIMD level, with SCANCAST_SIMD_LEVEL = 2, 3 or 4 and the matching -march: see kernels.hpp
// for what that forbids in here.
#include "renderer/device/cpu/kernels/kernels.hpp"

#include "renderer/device/cpu/kernels/screen.hpp"
#include "renderer/device/cpu/kernels/splat.hpp"

#if SCANCAST_SIMD_LEVEL == 4
#define SCANCAST_SIMD_NAMESPACE v4
#elif SCANCAST_SIMD_LEVEL == 3
#define SCANCAST_SIMD_NAMESPACE v3
#else
#define SCANCAST_SIMD_NAMESPACE v2
#endif

namespace scancast::cpu::SCANCAST_SIMD_NAMESPACE {

const Kernels kernels = {clear, splat, hidden, resolve, logDepth, eyeDome, accumulate, average};

}  // namespace scancast::cpu::SCANCAST_SIMD_NAMESPACE
