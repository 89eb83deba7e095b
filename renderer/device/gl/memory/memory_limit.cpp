#include "renderer/device/gl/memory/memory_limit.hpp"

#include <unistd.h>

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
    return {
        .memoryLimit = limit > 0 ? limit : defaultLimit(gl, software),
        .firstPage = software ? 32 * mib : 128 * mib,
        // A dispatch sees one page: of large clouds there are to be few. A rasteriser's memory is the server's own.
        .largestPage = software ? 128 * mib : 2048 * mib};
}

std::uint64_t memoryBeside(const GlFunctions& gl, bool software, std::uint64_t samples) {
    const auto freePages = [] {
        return std::uint64_t(std::max(::sysconf(_SC_AVPHYS_PAGES), 0L)) *
               std::uint64_t(std::max(::sysconf(_SC_PAGESIZE), 0L));
    };
    const std::uint64_t free = software ? freePages() : freeGpuMemory(gl).value_or(0);
    return free - std::min(free, samples);
}

std::int64_t pixelsAtOnce(const PictureRoom& room) {
    constexpr std::uint64_t bytesPerPixel = 128, screen4K = 3840 * 2160, screen8K = 7680 * 4320;
    // The largest thing of a picture that a shader sees at once has four bytes a pixel, and guard bands.
    const std::uint64_t block = room.storageBlockBytes / 8;
    if (room.software) return room.bytes < 4096 * mib ? 0 : std::int64_t(std::min(block, screen4K));
    return std::int64_t(std::min({room.bytes / 2 / bytesPerPixel, block, screen8K}));
}

std::uint64_t uploadBudget(bool software, std::uint64_t said) {
    if (said > 0) return said;
    return (software ? 256 : 64) * mib;
}

}  // namespace scancast::gl
