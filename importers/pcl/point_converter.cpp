#include "importers/pcl/point_converter.hpp"

#include <algorithm>
#include <cmath>

namespace scancast::import_pcl {

namespace {

double at(const RawPoint& point, Meaning m) {
    return point[static_cast<std::size_t>(m)];
}

/// Rounded and clamped to 0-greatest; NaN becomes 0.
double clamped(double value, double greatest) {
    return value > 0 ? std::min(std::floor(value + 0.5), greatest) : 0.0;
}

constexpr Meaning colors[] = {Meaning::Red, Meaning::Green, Meaning::Blue};

}  // namespace

void ValueRanges::take(const RawPoint& point, const PointFields& fields) {
    const auto finite = [&](Meaning m) { return std::isfinite(at(point, m)); };
    if (!finite(Meaning::X) || !finite(Meaning::Y) || !finite(Meaning::Z)) return;  // will be dropped
    if (fields.has(Meaning::Intensity) && finite(Meaning::Intensity)) {
        leastIntensity = std::min(leastIntensity, at(point, Meaning::Intensity));
        greatestIntensity = std::max(greatestIntensity, at(point, Meaning::Intensity));
    }
    for (const auto m : colors)
        if (fields.has(m) && finite(m)) greatestColor = std::max(greatestColor, at(point, m));
}

bool needsRanges(const PointFields& fields) {
    const auto& intensity = fields[Meaning::Intensity];
    if (intensity && *intensity != ColumnType::Uint8 && *intensity != ColumnType::Uint16) return true;
    if (!fields.attributes().color || fields.has(Meaning::PackedColor)) return false;
    return std::any_of(std::begin(colors), std::end(colors), [&](Meaning m) { return !isByte(*fields[m]); });
}

PointConverter::PointConverter(const PointFields& fields, const ValueRanges& ranges,
                               PointStreamWriter& writer)
    : fields_(fields), attributes_(fields.attributes()), writer_(writer) {
    if (const auto& type = fields[Meaning::Intensity]) {
        const auto least = ranges.leastIntensity;
        const auto greatest = ranges.greatestIntensity;
        if (*type == ColumnType::Uint8) {
            intensityFactor_ = 257;
        } else if (*type != ColumnType::Uint16 && (least < 0 || greatest > 65535)) {
            intensityShift_ = least;
            // Halved before subtracting: the difference of two doubles can be infinite.
            const auto half = greatest / 2 - least / 2;
            intensityFactor_ = half > 0 ? 32767.5 / half : 0;
        } else if (isFloat(*type) && greatest <= 1) {
            intensityFactor_ = 65535;
        } else if (isFloat(*type) && greatest <= 255) {
            intensityFactor_ = 257;
        }
    }
    if (attributes_.color && !fields.has(Meaning::PackedColor)) {
        const bool floats =
            std::any_of(std::begin(colors), std::end(colors), [&](Meaning m) { return isFloat(*fields[m]); });
        if (floats && ranges.greatestColor <= 1)
            colorFactor_ = 255;
        else if (ranges.greatestColor > 255)
            colorFactor_ = 1.0 / 256;
    }
}

Expected<void> PointConverter::add(const RawPoint& point) {
    const glm::dvec3 position(at(point, Meaning::X), at(point, Meaning::Y), at(point, Meaning::Z));
    if (!std::isfinite(position.x) || !std::isfinite(position.y) || !std::isfinite(position.z)) {
        ++dropped_;
        return {};
    }
    batch_.position.push_back(position);
    if (attributes_.color) addColor(point);
    if (attributes_.intensity) {
        const auto value = (at(point, Meaning::Intensity) - intensityShift_) * intensityFactor_;
        batch_.intensity.push_back(static_cast<std::uint16_t>(clamped(value, 65535)));
    }
    if (attributes_.classification) {
        const auto value = at(point, Meaning::Class);
        const bool fits = value >= 0 && value <= 255;
        batch_.classification.push_back(fits ? static_cast<std::uint8_t>(value) : std::uint8_t(0));
    }
    if (attributes_.normal) addNormal(point);
    if (batch_.size() < PointSource::batchPoints) return {};
    auto sent = writer_.writeChunk(batch_);
    batch_.clear();
    return sent;
}

void PointConverter::addColor(const RawPoint& point) {
    if (fields_.has(Meaning::PackedColor)) {
        const auto bits = static_cast<std::uint32_t>(at(point, Meaning::PackedColor));
        batch_.color.push_back({static_cast<std::uint8_t>(bits >> 16), static_cast<std::uint8_t>(bits >> 8),
                                static_cast<std::uint8_t>(bits)});
        return;
    }
    std::array<std::uint8_t, 3> color{};
    for (std::size_t i = 0; i < 3; ++i) {
        auto value = at(point, colors[i]);
        // Some programs declare a colour byte as signed ("char"); its bits are meant.
        if (*fields_[colors[i]] == ColumnType::Int8 && value < 0) value += 256;
        // The high byte is cut out, not rounded, as in LAS; floats are rounded.
        const bool cut = colorFactor_ < 1;
        color[i] = static_cast<std::uint8_t>(
            clamped(cut ? std::floor(value * colorFactor_) : value * colorFactor_, 255));
    }
    batch_.color.push_back(color);
}

void PointConverter::addNormal(const RawPoint& point) {
    const glm::dvec3 n(at(point, Meaning::NormalX), at(point, Meaning::NormalY), at(point, Meaning::NormalZ));
    const auto length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    const bool usable = std::isfinite(length) && length > 1e-30;
    batch_.normal.push_back(usable ? glm::vec3(n / length) : glm::vec3(0));
}

Expected<void> PointConverter::finish() {
    if (auto ok = writer_.writeChunk(batch_); !ok) return ok;
    batch_.clear();
    return writer_.finish(dropped_);
}

}  // namespace scancast::import_pcl
