#include "renderer/profile/point_colors.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "renderer/plan.hpp"
#include "renderer/select/viewpoint.hpp"
#include "renderer/style.hpp"

namespace scancast {
namespace {

constexpr double last = 255;

/// Column: points of picturedLeaves() have where between its ends their values lie for intensities.
bool isOfPoints(ColorSource source) {
    using enum ColorSource;
    return source == Column || source == Rgb || source == Intensity || source == Elevation ||
           source == Classification || source == Normal || source == Flat;
}

std::size_t indexOf(double value, double low, double high) {
    const double at = (value - low) / (high - low) * last;
    return std::size_t(std::clamp(std::isfinite(at) ? at : 0.0, 0.0, last));
}

}  // namespace

Expected<PointColors> PointColors::create(const Cloud& cloud, const Style& style) {
    const Style decided = decidedStyle(cloud, style);
    if (!isOfPoints(decided.color))
        return fail(
            ErrorCode::Unsupported,
            "color: a profile cannot be coloured by " + std::string(name(decided.color)) +
                "; it can by rgb, intensity, elevation, classification, normal, a kept column and #rrggbb",
            "picture.color");
    const auto viewpoint = Viewpoint::create(defaultView(cloud), cloud.origin, cloud.bounds);
    if (!viewpoint) return passOn(viewpoint);
    auto rule = colorRule(cloud, decided, *viewpoint);
    if (!rule) {
        Error error = rule.error();
        error.field = "picture." + error.field;
        return tl::unexpected(std::move(error));
    }
    PointColors made;
    made.rule_ = std::move(*rule);
    made.originZ_ = cloud.origin.z;
    return made;
}

const Rgb8& PointColors::onRamp(double value) const {
    return rule_.ramp[indexOf(value, rule_.low, rule_.high)];
}

Rgb8 PointColors::plain(const PointBatch& batch, std::size_t i) const {
    switch (rule_.source) {
        case ColorSource::Intensity:
            return onRamp(batch.intensity.empty() ? 0 : batch.intensity[i]);
        case ColorSource::Elevation:
            return onRamp(batch.position[i].z - originZ_);
        case ColorSource::Classification:
            return rule_.ramp[batch.classification.empty() ? 0 : batch.classification[i]];
        case ColorSource::Normal: {
            Rgb8 color{128, 128, 128};
            for (int a = 0; a < 3 && !batch.normal.empty(); ++a)
                color[std::size_t(a)] = std::uint8_t(
                    std::lround((std::clamp(double(batch.normal[i][a]), -1.0, 1.0) * 0.5 + 0.5) * last));
            return color;
        }
        case ColorSource::Flat:
            return rule_.flat;
        default:
            break;
    }
    Rgb8 color = batch.color.empty() ? Rgb8{255, 255, 255} : batch.color[i];
    if (rule_.toned)
        for (std::size_t c = 0; c < 3; ++c) color[c] = rule_.ramp[color[c]][c];
    return color;
}

Rgb8 PointColors::of(const PointBatch& batch, std::size_t i) const {
    Rgb8 color = plain(batch, i);
    if (!rule_.byIntensity) return color;
    const auto& by = *rule_.byIntensity;
    const double intensity = batch.intensity.empty() ? 0 : batch.intensity[i];
    const unsigned factor = by.factors[indexOf(intensity, by.low, by.high)];
    for (std::uint8_t& channel : color) channel = std::uint8_t(std::min(channel * factor / 256, 255U));
    return color;
}

}  // namespace scancast
