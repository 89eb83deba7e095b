// How the colours and intensities of a text are meant, and what they become. Pure functions.
//
// Text says nothing of the range of its numbers. A look at a few hundred lines from all over the file
// decides, once for all lines; a later line that contradicts is an error where it would give wrong colours.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

namespace scancast {

/// What the numbers of some columns have been seen to be.
struct SeenValues {
    double least = std::numeric_limits<double>::infinity();
    double most = -std::numeric_limits<double>::infinity();
    bool fractions = false;  ///< some are written with a point or an exponent
    bool parts = false;      ///< some are no whole numbers: 0.5, not 128.000

    void see(double value, bool fraction) {
        if (value < least) least = value;
        if (value > most) most = value;
        fractions = fractions || fraction;
        parts = parts || (fraction && value != std::floor(value));
    }
    void see(const SeenValues& other) {
        if (other.least < least) least = other.least;
        if (other.most > most) most = other.most;
        fractions = fractions || other.fractions;
        parts = parts || other.parts;
    }
    bool within(double low, double high) const { return least >= low && most <= high; }
};

enum class ColorScale : std::uint8_t {
    Byte,  ///< 0–255
    Word,  ///< 0–65535: the high byte is kept
    Unit,  ///< 0–1
};

enum class IntensityScale : std::uint8_t {
    Plain,   ///< 0–65535 as it stands, rounded
    Unit,    ///< 0–1 becomes 0–65535
    Signed,  ///< −2048…2047, as PTS has it, becomes 0–65535: (i + 2048) · 65535 / 4095, rounded
};

/// nullopt: these are no colours.
std::optional<ColorScale> colorScale(const SeenValues& seen);
/// `pts`: the file is a PTS, whose intensities are signed unless they plainly are not.
IntensityScale intensityScale(const SeenValues& seen, bool pts);

/// False for a value that contradicts the scale (or is NaN).
inline bool toColor(double value, ColorScale scale, std::uint8_t& out) {
    const double most = scale == ColorScale::Unit ? 1 : scale == ColorScale::Byte ? 255 : 65535;
    if (!(value >= 0 && value <= most)) return false;
    if (scale == ColorScale::Unit) value *= 255;
    out = scale == ColorScale::Word ? static_cast<std::uint8_t>(static_cast<unsigned>(value) >> 8)
                                    : static_cast<std::uint8_t>(value + 0.5);
    return true;
}

/// What lies beyond the ends becomes the end; NaN becomes 0.
inline std::uint16_t toIntensity(double value, IntensityScale scale) {
    if (scale == IntensityScale::Unit) value *= 65535;
    if (scale == IntensityScale::Signed) value = (value + 2048) * (65535.0 / 4095.0);
    if (!(value > 0)) return 0;
    return value >= 65535 ? std::uint16_t(65535) : static_cast<std::uint16_t>(value + 0.5);
}

}  // namespace scancast
