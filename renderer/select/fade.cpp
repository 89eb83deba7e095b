#include "renderer/select/fade.hpp"

#include <algorithm>
#include <cmath>

namespace scancast {

namespace {

// Children appear during this part of the band, and the node leaves during the rest: equal parts of the band
// then change about equally many pixels (docs/decisions/008-fading-levels.md).
constexpr double arrival = 0.4;
constexpr double widestBand = 0.5, bandPerSquarePixel = 0.1;

}  // namespace

double fadeBand(double detail) {
    return std::min(widestBand, bandPerSquarePixel * detail * detail);
}

FadeShares fadeShares(double spacing, double detail, double band) {
    if (!(spacing > detail)) return {1, 0};
    if (!(spacing < detail * (1 + band))) return {0, 1};
    // In equal steps of a zoom, equally far through the band.
    const double progress = std::log(spacing / detail) / std::log1p(band);
    return {std::clamp((1 - progress) / (1 - arrival), 0.0, 1.0), std::clamp(progress / arrival, 0.0, 1.0)};
}

}  // namespace scancast
