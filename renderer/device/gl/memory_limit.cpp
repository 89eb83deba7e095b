#include "renderer/device/gl/memory_limit.hpp"

#include <algorithm>

namespace scancast::gl {

namespace {

constexpr std::uint64_t mib = std::uint64_t(1) << 20;

std::uint64_t defaultLimit(const GlFunctions& gl, bool software) {
    if (software) return 512 * mib;
    const auto free = freeGpuMemory(gl);
    // A GPU that others have filled may have room again when it is needed.
    return free ? std::max(*free / 4 * 3, 64 * mib) : 1024 * mib;
}

}  // namespace

SampleCacheOptions sampleCacheOptions(const GlFunctions& gl, bool software, std::uint64_t limit) {
    return {.memoryLimit = limit > 0 ? limit : defaultLimit(gl, software),
            .firstPage = software ? 32 * mib : 128 * mib};
}

std::uint64_t uploadBudget(bool software, std::uint64_t said) {
    if (said > 0) return said;
    return (software ? 256 : 64) * mib;
}

}  // namespace scancast::gl
