#include "renderer/cloud/build/value_ranges.hpp"

#include <algorithm>

namespace scancast {

void ValueRanges::add(const PointBatch& batch) {
    for (const auto& color : batch.color)
        for (std::size_t c = 0; c < color.size(); ++c) {
            colorLow_[c] = std::min(colorLow_[c], color[c]);
            colorHigh_[c] = std::max(colorHigh_[c], color[c]);
        }
    for (const std::uint16_t i : batch.intensity) {
        intensity_[0] = std::min(intensity_[0], i);
        intensity_[1] = std::max(intensity_[1], i);
    }
}

void ValueRanges::settle(CloudFacts& facts) const {
    const bool oneIsAll = facts.points == 1;
    const bool isBlack = colorHigh_ == std::array<std::uint8_t, 3>{};
    if (facts.attributes.color && colorLow_ == colorHigh_ && (!oneIsAll || isBlack)) {
        facts.attributes.color = false;
        facts.constant.color = colorLow_;
    }
    const auto [low, high] = intensity_;
    if (low <= high) facts.intensityRange = intensity_;
    if (facts.attributes.intensity && low == high && (!oneIsAll || high == 0)) {
        facts.attributes.intensity = false;
        facts.constant.intensity = low;
    }
}

}  // namespace scancast
