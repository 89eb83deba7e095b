// How much of a GPU's memory samples may take where nobody says, and how large a picture may be beside them.
// Needs a Current scope, where it is given functions. Place: device's options → **memory limit** → sample
// cache, device.
#pragma once

#include <cstdint>

#include "renderer/device/gl/memory/sample_cache.hpp"

namespace scancast::gl {

/// What is said, or else: of a GPU three quarters of what its driver says is free, at least 64 MiB, 1 GiB
/// where it does not say; half a GiB of the machine's memory where a driver draws on the CPU. A GPU gets
/// large pages at once; on the CPU, where a page's memory is filled with zeros first, they begin small.
SampleCacheOptions sampleCacheOptions(const GlFunctions& gl, bool software, std::uint64_t limit);

/// Bytes that a picture which need not be complete may upload: what is said, or else 64 MiB to a GPU, a few
/// milliseconds of its bus; 256 MiB where a driver draws on the CPU: it takes longer to draw than to copy.
std::uint64_t uploadBudget(bool software, std::uint64_t said);

/// Bytes that are free beside the samples' limit: of the GPU's memory, or of the machine's (unused pages;
/// what a control group allows is not known here) where a driver draws on the CPU. 0 where nobody says.
std::uint64_t memoryBeside(const GlFunctions& gl, bool software, std::uint64_t samples);

struct PictureRoom {
    bool software = false;
    std::uint64_t bytes = 0;  ///< memoryBeside()
    std::size_t storageBlockBytes = 0;
};
/// Device::pixelsAtOnce(): of a GPU what half of that memory holds, at 128 bytes a pixel - planes 12, keys
/// and sums up to 76, the mean and what is read back 16 - and no more than a screen of 7680 x 4320 has, so
/// that posters can be abandoned between tiles. On the CPU a screen of 3840 x 2160 where 4 GiB are free: it
/// took up to 70 MB more than tiles did (ewa), and half (point) to nine tenths (paraboloid) of their time.
std::int64_t pixelsAtOnce(const PictureRoom& room);

}  // namespace scancast::gl
