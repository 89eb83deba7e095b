#include "renderer/cloud/surfels/kernels/levels.hpp"

#include <cstdlib>
#include <string_view>

namespace scancast {

std::vector<const surfel::SurfelKernels*> availableSurfelKernels() {
    const bool hasV3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
                       __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma");
    const bool hasV4 = hasV3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                       __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                       __builtin_cpu_supports("avx512vl");
    std::vector<const surfel::SurfelKernels*> kernels;
    if (hasV4) kernels.push_back(&surfel::v4::kernels);
    if (hasV3) kernels.push_back(&surfel::v3::kernels);
    kernels.push_back(&surfel::v2::kernels);
    return kernels;
}

const surfel::SurfelKernels& surfelKernels() {
    static const surfel::SurfelKernels* const chosen = [] {
        const char* variable = std::getenv("SCANCAST_SIMD");
        const std::string_view forced = variable != nullptr ? variable : "";
        const auto available = availableSurfelKernels();
        for (const surfel::SurfelKernels* k : available)
            if ((forced == "v2" && k == &surfel::v2::kernels) ||
                (forced == "v3" && k == &surfel::v3::kernels))
                return k;
        return available.front();
    }();
    return *chosen;
}

}  // namespace scancast
