#include "importers/e57/value_scale.hpp"

#include <algorithm>

namespace scancast::import_e57 {

namespace {

constexpr unsigned mostSpeakingBits = 16;  ///< a field that can hold more says nothing about what is in it

Scale stretched(const Limits& limits, double greatest) {
    // Halved before subtracting: the difference of two doubles can be infinite.
    const double half = limits.maximum / 2 - limits.minimum / 2;
    return {.shift = limits.minimum, .factor = half > 0 ? greatest / 2 / half : 0};
}

const Field& fieldOf(const ScanDescription& scan, Role role) {
    return scan.fields[static_cast<std::size_t>(scan.fieldOf[role])];
}

bool isSixteenBits(const Limits& limits) {
    return limits.minimum == 0 && limits.maximum == 65535;
}

}  // namespace

std::optional<Scale> intensityScale(const ScanDescription& scan) {
    const auto& field = fieldOf(scan, Role::Intensity);
    if (scan.intensity) return stretched(*scan.intensity, 65535);
    if (field.limits && field.bits <= (field.isInteger() ? mostSpeakingBits : 64U))
        return stretched(*field.limits, 65535);
    return std::nullopt;
}

std::optional<Scale> colorScale(const ScanDescription& scan, std::size_t channel) {
    const auto& field = fieldOf(scan, static_cast<Role>(static_cast<std::size_t>(Role::Red) + channel));
    const auto& limits = scan.color[channel] ? scan.color[channel] : field.limits;
    if (!limits) return std::nullopt;
    if (!scan.color[channel]) {
        if (field.bits > (field.isInteger() ? mostSpeakingBits : 64U)) return std::nullopt;
        if (isSixteenBits(*limits)) return std::nullopt;
    }
    if (field.isInteger() && isSixteenBits(*limits)) return Scale{.factor = 1.0 / 256, .cut = true};
    return stretched(*limits, 255);
}

Scale intensityScale(const Measured& met) {
    if (met.least < 0 || met.greatest > 65535) return stretched({met.least, met.greatest}, 65535);
    if (!met.integers && met.greatest <= 1) return {.factor = 65535};
    if (!met.integers && met.greatest <= 255) return {.factor = 257};
    return {};
}

Scale colorScale(const Measured& met) {
    if (!met.integers && met.greatest <= 1) return {.factor = 255};
    if (met.greatest <= 255) return {};
    if (met.greatest <= 65535) return {.factor = 1.0 / 256, .cut = true};
    return stretched({0, met.greatest}, 255);
}

}  // namespace scancast::import_e57
