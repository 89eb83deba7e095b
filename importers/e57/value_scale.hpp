// What stored intensities and colours become on the stream's scales (0-65535, 0-255). Pure functions.
// Pipeline: columns → **scales** → points.
//
// The scan's limits say what its full range is (intensityLimits, colorLimits). Where they are missing or without a width, a
// field that holds at most 16 bits, or a float with limits of its own, says it by these. What nobody says is measured
// by a pass over all such scans of the file, together:
//   intensity: floats within 0-1 × 65535, within 0-255 × 257; within 0-65535 as it is; else stretched from least to greatest.
//   colour: floats × 255 if none is above 1; as they are if none is above 255; their high byte if none is above 65535; else
//     stretched from 0 to the greatest.
// Integers of exactly 16 bits of colour are cut to their high byte, as in LAS; without limits of the scan's they are measured
// first, because many programs put 8 bits there.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "importers/e57/scan_description.hpp"

namespace scancast::import_e57 {

struct Scale {
    double shift = 0, factor = 1;
    bool cut = false;  ///< downwards instead of rounded

    /// Clamped to 0 - greatest; NaN becomes 0.
    double of(double value, double greatest) const {
        const double scaled = (value - shift) * factor;
        if (!(scaled > 0)) return 0;
        return scaled >= greatest ? greatest : std::floor(cut ? scaled : scaled + 0.5);
    }
};

/// Values that were met, over all scans whose scale nobody says.
struct Measured {
    double least = std::numeric_limits<double>::infinity();
    double greatest = -std::numeric_limits<double>::infinity();
    bool integers = true;  ///< all of them by their fields

    void take(double value) {
        if (!std::isfinite(value)) return;
        if (value < least) least = value;
        if (value > greatest) greatest = value;
    }
};

/// nullopt where it has to be measured.
std::optional<Scale> intensityScale(const ScanDescription& scan);
std::optional<Scale> colorScale(const ScanDescription& scan, std::size_t channel);

Scale intensityScale(const Measured& met);
Scale colorScale(const Measured& met);

}  // namespace scancast::import_e57
