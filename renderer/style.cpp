#include "renderer/style.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/image/colormap.hpp"
#include "renderer/mirrors.hpp"

namespace scancast {

namespace {

/// Attributes that are the same everywhere are not offered, but drawn when asked for: they are what the scan
/// has.
bool has(const CloudFacts& cloud, ColorSource source) {
    switch (source) {
        case ColorSource::Rgb:
            return cloud.attributes.color || cloud.constant.color;
        case ColorSource::Intensity:
            return cloud.attributes.intensity || cloud.constant.intensity;
        case ColorSource::Classification:
            return cloud.attributes.classification;
        case ColorSource::Normal:
            return cloud.attributes.normal;
        case ColorSource::Elevation:
        case ColorSource::Depth:
        case ColorSource::Lod:
        case ColorSource::Flat:
            return true;
    }
    return false;
}

std::string available(const CloudFacts& cloud) {
    std::string list;
    for (const auto source :
         {ColorSource::Rgb, ColorSource::Intensity, ColorSource::Classification, ColorSource::Normal}) {
        if (has(cloud, source)) list += std::string(name(source)) + ", ";
    }
    return list + "elevation, depth, lod and #rrggbb";
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

std::array<double, 2> naturalRange(const Cloud& cloud, ColorSource source, const Viewpoint& viewpoint) {
    switch (source) {
        case ColorSource::Intensity:
            return {static_cast<double>(cloud.intensityRange[0]),
                    static_cast<double>(cloud.intensityRange[1])};
        case ColorSource::Elevation:
            return {cloud.bounds[0].z, cloud.bounds[1].z};
        case ColorSource::Depth:
            return depthRange(cloud, viewpoint);
        default:
            return {0, 1};
    }
}

}  // namespace

ColorSource bestColorSource(const Attributes& attributes) {
    if (attributes.color) return ColorSource::Rgb;
    return attributes.intensity ? ColorSource::Intensity : ColorSource::Elevation;
}

Expected<ColorRule> colorRule(const Cloud& cloud, const Style& style, const Viewpoint& viewpoint) {
    if (!has(cloud, style.color)) {
        return fail(ErrorCode::Unsupported,
                    "this cloud has no " + std::string(name(style.color)) + " to colour by; it has " +
                        available(cloud),
                    "color");
    }
    const auto ramp = colormap(style.colormap);
    if (!ramp) {
        return fail(ErrorCode::InvalidArgument,
                    "there is no colour map '" + style.colormap + "'; there are viridis, turbo and grey",
                    "colormap");
    }
    ColorRule rule;
    rule.source = style.color;
    rule.flat = style.flatColor;
    rule.ramp = *ramp;
    if (style.color == ColorSource::Classification) rule.ramp = classificationColors();
    if (style.color == ColorSource::Lod) rule.ramp = levelColors();
    const auto range = style.range.value_or(naturalRange(cloud, style.color, viewpoint));
    rule.low = range[0];
    // A range of no width (one value everywhere) is drawn in the ramp's first colour instead of dividing by
    // zero.
    rule.high = range[1] == range[0] ? range[0] + 1 : range[1];
    if (style.color == ColorSource::Elevation) {
        rule.low -= cloud.origin.z;
        rule.high -= cloud.origin.z;
    }
    return rule;
}

SampleFilter sampleFilter(const Cloud& cloud, const Style& style) {
    SampleFilter filter;
    if (style.classes) {
        filter.classes.emplace();
        for (const auto wanted : *style.classes) (*filter.classes)[wanted] = true;
    }
    if (style.clip) filter.clip = ClipBox{style.clip->min - cloud.origin, style.clip->max - cloud.origin};
    if (!style.behindMirrors) filter.dropped = behindMirrors(cloud);
    filter.outliers = style.outliers == Outliers::Show;
    return filter;
}

}  // namespace scancast
