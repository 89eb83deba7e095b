#include "renderer/cloud/build/value_ranges.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <numeric>
#include <span>

namespace scancast {

namespace {

/// Rec. 709 weights of the stored bytes, in 256ths.
std::size_t brightnessOf(const std::array<std::uint8_t, 3>& color) {
    return std::size_t(54 * color[0] + 183 * color[1] + 19 * color[2]) >> 8;
}

/// The least value at or below which the share `q` of all counted lies.
double quantile(std::span<const std::uint64_t> counts, double q) {
    const auto all = std::accumulate(counts.begin(), counts.end(), std::uint64_t(0));
    std::uint64_t below = 0;
    for (std::size_t value = 0; value < counts.size(); ++value) {
        below += counts[value];
        if (below > 0 && double(below) >= q * double(all)) return double(value);
    }
    return 0;
}

}  // namespace

void ValueRanges::add(const PointBatch& batch) {
    for (const auto& color : batch.color)
        for (std::size_t c = 0; c < color.size(); ++c) {
            colorLow_[c] = std::min(colorLow_[c], color[c]);
            colorHigh_[c] = std::max(colorHigh_[c], color[c]);
        }
    for (const auto& color : batch.color) ++brightness_[brightnessOf(color)];
    batch.position.forEach([&](const glm::dvec3& p) {
        for (int a = 0; a < 3; ++a) position_[std::size_t(a)].add(p[a]);
    });
    for (const std::uint16_t i : batch.intensity) ++intensities_[i];
    for (const std::uint16_t i : batch.intensity) {
        intensity_[0] = std::min(intensity_[0], i);
        intensity_[1] = std::max(intensity_[1], i);
    }
    for (const std::uint16_t i : batch.nearInfrared) {
        nearInfrared_[0] = std::min(nearInfrared_[0], i);
        nearInfrared_[1] = std::max(nearInfrared_[1], i);
    }
}

void ValueRanges::join(const ValueRanges& other) {
    for (std::size_t c = 0; c < colorLow_.size(); ++c) {
        colorLow_[c] = std::min(colorLow_[c], other.colorLow_[c]);
        colorHigh_[c] = std::max(colorHigh_[c], other.colorHigh_[c]);
    }
    const auto widen = [](std::array<std::uint16_t, 2>& range, const std::array<std::uint16_t, 2>& by) {
        range = {std::min(range[0], by[0]), std::max(range[1], by[1])};
    };
    widen(intensity_, other.intensity_);
    widen(nearInfrared_, other.nearInfrared_);
    for (std::size_t a = 0; a < position_.size(); ++a) position_[a].join(other.position_[a]);
    for (std::size_t i = 0; i < intensities_.size(); ++i) intensities_[i] += other.intensities_[i];
    for (std::size_t i = 0; i < brightness_.size(); ++i) brightness_[i] += other.brightness_[i];
}

std::vector<std::string> ValueRanges::notes(std::uint64_t points) const {
    const auto infrared = constantNearInfrared();
    if (!infrared || (points == 1 && *infrared != 0)) return {};
    return {fmt::format("all points have the same near infrared, {}: that is taken for none", *infrared)};
}

std::optional<std::uint16_t> ValueRanges::constantNearInfrared() const {
    const auto [low, high] = nearInfrared_;
    return low == high ? std::optional(low) : std::nullopt;
}

void ValueRanges::settle(CloudFacts& facts) const {
    UsualRanges& usual = facts.usual.emplace();
    for (int a = 0; a < 3; ++a) {
        const auto [low, high] = position_[std::size_t(a)].usual();
        usual.position[0][a] = low;
        usual.position[1][a] = high;
    }
    usual.intensity = {quantile(intensities_, 0.01), quantile(intensities_, 0.99)};
    if (facts.attributes.intensity && intensity_[0] < intensity_[1]) {
        const HistogramParts parts = histogramParts({double(intensity_[0]), double(intensity_[1])},
                                                    usual.intensity, 1);
        facts.intensityHistogram = parts.empty();
        for (std::size_t value = 0; value < intensities_.size(); ++value)
            addTo(*facts.intensityHistogram, double(value), intensities_[value]);
    }
    usual.brightness = {quantile(brightness_, 0.05) / 255, quantile(brightness_, 0.5) / 255,
                        quantile(brightness_, 0.95) / 255};
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
    if (const auto all = constantNearInfrared(); all && (!oneIsAll || *all == 0))
        facts.attributes.nearInfrared = false;
}

}  // namespace scancast
