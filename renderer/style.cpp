#include "renderer/style.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/nearest_name.hpp"
#include "renderer/cloud/columns/color_sources.hpp"
#include "renderer/cloud/columns/pictured_file.hpp"
#include "renderer/image/colormap.hpp"
#include "renderer/image/tone_curve.hpp"
#include "renderer/mirrors.hpp"

namespace scancast {

namespace {

/// Of a colour, where intensity is least and where it is greatest.
constexpr double darkest = 0.45, brightest = 1.15;
/// Median brightness (sRGB, 0-1) beyond which exposure is levelled, and the exponent that makes light of it.
constexpr double tooDark = 0.28, tooBright = 0.78, gamma = 2.2;

ColorSource bestColorSource(const Attributes& attributes) {
    if (attributes.color) return ColorSource::Rgb;
    return attributes.intensity ? ColorSource::Intensity : ColorSource::Elevation;
}

std::string available(const CloudFacts& cloud) {
    std::string list;
    for (const auto source : {ColorSource::Rgb, ColorSource::Infrared, ColorSource::Intensity,
                              ColorSource::Classification, ColorSource::Normal, ColorSource::Curvature}) {
        if (canColorBy(cloud, source)) list += std::string(name(source)) + ", ";
    }
    for (const std::size_t c : choosableColumns(cloud)) {
        list += "column:";
        list += quoteText(cloud.columns[c].column.name);
        list += ", ";
    }
    return list + "elevation, depth, lod, cloud and #rrggbb";
}

/// Least and greatest depth of the cloud's bounding box, in front of the eye.
std::array<double, 2> depthRange(const Cloud& cloud, const Viewpoint& viewpoint) {
    std::array<double, 2> range{INFINITY, -INFINITY};
    for (unsigned corner = 0; corner < 8; ++corner) {
        glm::dvec3 p;
        for (int axis = 0; axis < 3; ++axis)
            p[axis] = cloud.bounds[corner >> axis & 1][axis] - cloud.origin[axis];
        const double depth = -(viewpoint.cloudToView * glm::dvec4(p, 1)).z;
        range = {std::min(range[0], depth), std::max(range[1], depth)};
    }
    return {std::max(range[0], viewpoint.near), std::max(range[1], viewpoint.near)};
}

/// Where most values lie, where that is known: one stray value must not take the colours from all others.
std::array<double, 2> intensityRange(const Cloud& cloud) {
    const std::array<double, 2> all{double(cloud.intensityRange[0]), double(cloud.intensityRange[1])};
    return cloud.usual && cloud.usual->intensity[0] < cloud.usual->intensity[1] ? cloud.usual->intensity
                                                                                : all;
}

std::array<double, 2> elevationRange(const Cloud& cloud) {
    const auto& box = cloud.usual && cloud.usual->position[0].z < cloud.usual->position[1].z
                          ? cloud.usual->position
                          : cloud.bounds;
    return {box[0].z, box[1].z};
}

/// Around 0, which is the middle of its colours. 1 / cloud units.
std::array<double, 2> curvatureRange(const CloudFacts& cloud) {
    double most = cloud.usual ? std::max(-cloud.usual->curvature[0], cloud.usual->curvature[1]) : 0;
    if (!(most > 0)) most = cloud.spacing > 0 ? 1 / cloud.spacing : 1;
    return {-most, most};
}

std::optional<std::array<double, 2>> naturalRange(const Cloud& cloud, const Style& style,
                                                  const Viewpoint& viewpoint) {
    switch (style.color) {
        case ColorSource::Intensity:
            return intensityRange(cloud);
        case ColorSource::Elevation:
            return elevationRange(cloud);
        case ColorSource::Curvature:
            return curvatureRange(cloud);
        case ColorSource::Depth:
            return depthRange(cloud, viewpoint);
        case ColorSource::Column:
            return naturalEnds(cloud, style.column);
        default:
            return std::nullopt;
    }
}

Expected<void> checkHas(const Cloud& cloud, ColorSource source) {
    if (canColorBy(cloud, source)) return {};
    const std::string what(source == ColorSource::Infrared ? "near infrared" : name(source));
    return fail(ErrorCode::Unsupported,
                "this cloud has no " + what + " to colour by; it has " + available(cloud), "color");
}

Expected<std::array<Rgb8, 256>> rampOf(const Style& style) {
    const auto ramp = colormap(style.colormap);
    if (!ramp) {
        return fail(ErrorCode::InvalidArgument,
                    "there is no colour map '" + style.colormap + "'; there are viridis, turbo and grey",
                    "colormap");
    }
    if (style.color == ColorSource::Classification) return classificationColors();
    if (style.color == ColorSource::Lod) return levelColors();
    if (style.color == ColorSource::Curvature) return curvatureColors();
    return *ramp;
}

void setRange(const Cloud& cloud, const Style& style, const Viewpoint& viewpoint, ColorRule& rule) {
    if (style.color == ColorSource::Column) {
        // Samples bring where between the ends their values lie (picturedFile()).
        rule.low = 0;
        rule.high = greatestCode;
        return;
    }
    const auto range = rampEnds(cloud, style, viewpoint).value_or(std::array{0.0, 1.0});
    rule.low = range[0];
    // A range of no width (one value everywhere) is drawn in the ramp's first colour instead of dividing by
    // zero.
    rule.high = range[1] == range[0] ? range[0] + 1 : range[1];
    if (style.color == ColorSource::Elevation) {
        rule.low -= cloud.origin.z;
        rule.high -= cloud.origin.z;
    }
}

/// Only what was measured has an exposure: other colours are chosen ones.
void setTone(const Style& style, ColorRule& rule) {
    const double stops = style.exposure.value_or(0);
    const bool infrared = style.color == ColorSource::Infrared;
    if (!infrared && (style.color != ColorSource::Rgb || stops == 0)) return;
    const auto curve = toneCurve(stops);
    rule.toned = true;
    for (std::size_t i = 0; i < 256; ++i) rule.ramp[i].fill(curve[i]);
}

/// None where intensity is the same everywhere: it says nothing about brightness.
std::optional<IntensityFactors> intensityFactors(const Cloud& cloud) {
    const auto [low, high] = intensityRange(cloud);
    if (!(low < high)) return std::nullopt;
    IntensityFactors made{.low = low, .high = high};
    for (std::size_t i = 0; i < 256; ++i) {
        const double factor = darkest + (brightest - darkest) * double(i) / 255;
        made.factors[i] = static_cast<std::uint16_t>(std::lround(256 * factor));
    }
    return made;
}

}  // namespace

double automaticExposure(const CloudFacts& cloud) {
    if (!cloud.usual) return 0;
    const double median = cloud.usual->brightness[1];
    if (median > 0 && median < tooDark) return std::min(1.0, gamma * std::log2(tooDark / median));
    if (median > tooBright) return std::max(-1.0, gamma * std::log2(tooBright / median));
    return 0;
}

Style decidedStyle(const Cloud& cloud, Style style) {
    if (style.color == ColorSource::Auto) {
        if (cloud.look && cloud.look->style.color != ColorSource::Auto) {
            const Style& own = cloud.look->style;
            style.color = own.color;
            style.column = own.column;
            style.byIntensity = own.byIntensity;
            style.flatColor = own.flatColor;
            if (style.colormap == Style().colormap) style.colormap = own.colormap;
            if (!style.range) style.range = own.range;
        } else {
            style.color = bestColorSource(cloud.attributes);
        }
    }
    if (!style.exposure && cloud.look) style.exposure = cloud.look->style.exposure;
    if (!style.exposure) style.exposure = automaticExposure(cloud);
    return style;
}

Expected<ColorRule> colorRule(const Cloud& cloud, const Style& style, const Viewpoint& viewpoint) {
    if (auto ok = checkHas(cloud, style.color); !ok) return passOn(ok);
    if (style.byIntensity)
        if (auto ok = checkHas(cloud, ColorSource::Intensity); !ok) return passOn(ok);
    const auto ramp = rampOf(style);
    if (!ramp) return passOn(ramp);
    ColorRule rule;
    // What points look like does not matter where the picture is of labels.
    rule.source = style.color == ColorSource::Visibility ? ColorSource::Flat : style.color;
    if (style.color == ColorSource::Column) rule.source = ColorSource::Intensity;
    rule.flat = style.flatColor;
    // Of several, the samples have the colours of their clouds already (renderer/together); one alone has the first.
    if (style.color == ColorSource::Cloud) {
        rule.source = cloud.together ? ColorSource::Rgb : ColorSource::Flat;
        rule.flat = cloudColors.front();
    }
    rule.ramp = *ramp;
    setRange(cloud, style, viewpoint, rule);
    setTone(style, rule);
    if (style.byIntensity) rule.byIntensity = intensityFactors(cloud);
    return rule;
}

std::optional<std::array<double, 2>> rampEnds(const Cloud& cloud, const Style& style,
                                              const Viewpoint& viewpoint) {
    if (style.color == ColorSource::Column && style.range) return style.range;
    const auto natural = naturalRange(cloud, style, viewpoint);
    return natural && style.range ? style.range : natural;
}

SampleFilter sampleFilter(const Cloud& cloud, const Style& style) {
    SampleFilter filter;
    if (style.classes) {
        filter.classes.emplace();
        for (const auto wanted : *style.classes) (*filter.classes)[wanted] = true;
    }
    if (style.clip) filter.clip = ClipBox{style.clip->min - cloud.origin, style.clip->max - cloud.origin};
    filter.shapes = clipRegions(style.clips, cloud.origin);
    if (!style.behindMirrors) filter.dropped = behindMirrors(cloud);
    filter.outliers = style.outliers == Outliers::Show;
    return filter;
}

}  // namespace scancast
