// The clouds that bench_gpu measures: made in memory by the simulator, with progress on standard error, and
// refused with a sentence where the machine has too little memory.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "renderer/cloud/cloud.hpp"

namespace scancast::bench {

/// While a cloud is built, with room to spare: 69 were measured at 10 million points, 44 at 100 million.
inline constexpr std::uint64_t bytesPerPoint = 72;

struct BuiltForBench {
    std::shared_ptr<const Cloud> cloud;
    double seconds = 0;
};

/// Says what it does before and after, with the rate. Ends the program where that cannot be done.
BuiltForBench buildOrExit(const std::string& scene, std::uint64_t points, bool surfels);

}  // namespace scancast::bench
