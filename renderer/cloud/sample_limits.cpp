#include "renderer/cloud/sample_limits.hpp"

#include <algorithm>

#include "renderer/cloud/surfel_codec.hpp"

namespace scancast {

std::vector<SampleLimits> limitsOf(std::span<const Sample> samples) {
    std::vector<SampleLimits> all;
    all.reserve((samples.size() + samplesPerLimits - 1) / samplesPerLimits);
    for (std::size_t first = 0; first < samples.size(); first += samplesPerLimits) {
        SampleLimits limits{{0xffff, 0xffff, 0xffff}, {0, 0, 0}};
        for (const Sample& s : samples.subspan(first, std::min(samplesPerLimits, samples.size() - first))) {
            const std::uint16_t place[3] = {s.x, s.y, s.z};
            for (int a = 0; a < 3; ++a) {
                limits.low[a] = std::min(limits.low[a], place[a]);
                limits.high[a] = std::max(limits.high[a], place[a]);
            }
            const bool known = s.logRadius != noRadius && s.logRadius != outlierRadius;
            limits.largestRadius = std::max(limits.largestRadius, known ? s.logRadius : noRadius);
            limits.plain = limits.plain || !known;
        }
        all.push_back(limits);
    }
    return all;
}

}  // namespace scancast
