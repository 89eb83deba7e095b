// Into which parts a column's values are counted (ValueHistogram): most of what there is, so that one stray value does not leave
// the rest in a single part. Pure functions. Pipeline: staging → **histogram** → facts.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

struct HistogramParts {
    double low = 0, high = 1;
    std::size_t count = 1;
    bool whole = false;  ///< values are multiples of a step

    ValueHistogram empty() const { return {low, high, std::vector<std::uint64_t>(count)}; }
};

/// `range`: least and greatest; `usual`: between which most lie; `step`: between two values that follow each other, 0 where there
/// is none.
inline HistogramParts histogramParts(const std::array<double, 2>& range, const std::array<double, 2>& usual,
                                     double step) {
    const double values = step > 0 ? std::round((range[1] - range[0]) / step) + 1 : 0;
    if (values >= 1 && values <= double(ValueHistogram::mostBins))
        return {range[0] - step / 2, range[1] + step / 2, std::size_t(values), true};
    auto [low, high] = usual[0] < usual[1] ? usual : range;
    // A value that is the same everywhere stands in the middle.
    if (!(low < high)) {
        const double half = low == 0 ? 0.5 : std::abs(low) / 2;
        return {low - half, low + half, 1, step > 0};
    }
    return {low, high, ValueHistogram::mostBins, step > 0};
}

/// Nowhere, where the value lies beyond it. The greatest belongs to the last part.
inline void addTo(ValueHistogram& histogram, double value, std::uint64_t count) {
    if (!(value >= histogram.low && value <= histogram.high)) return;
    const double share = (value - histogram.low) / (histogram.high - histogram.low);
    const auto part = std::size_t(share * double(histogram.counts.size()));
    histogram.counts[std::min(part, histogram.counts.size() - 1)] += count;
}

}  // namespace scancast
