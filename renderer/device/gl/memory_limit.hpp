// How much of a GPU's memory samples may take where nobody says. Needs a Current scope. Place: device's
// options → **memory limit** → sample cache.
#pragma once

#include <cstdint>

#include "renderer/device/gl/sample_cache.hpp"

namespace scancast::gl {

/// What is said, or else: of a GPU three quarters of what its driver says is free, at least 64 MiB, 1 GiB
/// where it does not say; half a GiB of the machine's memory where a driver draws on the CPU. A GPU gets
/// large pages at once; on the CPU, where a page's memory is filled with zeros first, they begin small.
SampleCacheOptions sampleCacheOptions(const GlFunctions& gl, bool software, std::uint64_t limit);

/// Bytes that a picture which need not be complete may upload: what is said, or else 64 MiB to a GPU, a few
/// milliseconds of its bus; 256 MiB where a driver draws on the CPU: it takes longer to draw than to copy.
std::uint64_t uploadBudget(bool software, std::uint64_t said);

}  // namespace scancast::gl
