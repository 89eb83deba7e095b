#include "tests/support/pictures/reference_renderer.hpp"
#include "renderer/cloud/curvature.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scancast::test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Rgb8 onRamp(const ColorRule& rule, double value) {
    const double t = std::clamp((value - rule.low) / (rule.high - rule.low), 0.0, 1.0);
    return rule.ramp[static_cast<std::size_t>(std::lround(t * 255))];
}

Rgb8 toned(const ColorRule& rule, Rgb8 color) {
    for (std::size_t c = 0; rule.toned && c < 3; ++c) color[c] = rule.ramp[color[c]][c];
    return color;
}

Rgb8 brightened(const ColorRule& rule, const Sample& s, Rgb8 color) {
    if (!rule.byIntensity) return color;
    const auto& [factors, low, high] = *rule.byIntensity;
    const double t = std::clamp((s.intensity - low) / (high - low), 0.0, 1.0);
    const unsigned factor = factors[static_cast<std::size_t>(std::lround(t * 255))];
    for (auto& channel : color)
        channel = static_cast<std::uint8_t>(std::min(255u, (channel * factor + 128) / 256));
    return color;
}

Rgb8 sourceColor(const ColorRule& rule, const Node& node, const Sample& s, BesideWord beside,
                 const glm::dvec3& place, double depth) {
    switch (rule.source) {
        case ColorSource::Auto:  // a rule names what was chosen
        case ColorSource::Rgb:
            return toned(rule, {s.r, s.g, s.b});
        case ColorSource::Cloud:   // rgb or flat by then
        case ColorSource::Column:  // intensity by then
        case ColorSource::Visibility:
        case ColorSource::Flat:
            return rule.flat;
        case ColorSource::Intensity:
            return onRamp(rule, s.intensity);
        case ColorSource::Elevation:
            return onRamp(rule, place.z);
        case ColorSource::Depth:
            return onRamp(rule, depth);
        case ColorSource::Classification:
            return rule.ramp[s.classification];
        case ColorSource::Lod:
            return rule.ramp[node.level];
        case ColorSource::Infrared: {
            ColorRule byRamp = rule;
            byRamp.toned = true;
            return toned(byRamp, {nearInfraredIn(beside), s.r, s.g});
        }
        case ColorSource::Curvature: {
            const Curvature c = decodeCurvature(curvatureIn(beside), decodeNormal(s.normal), node.radiusUnit);
            return onRamp(rule, 0.5 * (double(c.k1) + double(c.k2)));
        }
        case ColorSource::Normal:
            break;
    }
    const glm::vec3 n = decodeNormal(s.normal);
    Rgb8 color;
    for (int c = 0; c < 3; ++c) {
        color[static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(std::lround((n[c] * 0.5 + 0.5) * 255));
    }
    return color;
}

Rgb8 colorOf(const ColorRule& rule, const Node& node, const Sample& s, BesideWord beside,
             const glm::dvec3& place, double depth) {
    return brightened(rule, s, sourceColor(rule, node, s, beside, place, depth));
}

bool wanted(const SampleFilter& filter, const Sample& s, const glm::dvec3& p) {
    if (filter.classes && !(*filter.classes)[s.classification]) return false;
    if (!filter.shapes.contains(p)) return false;
    if (!filter.clip) return true;
    for (int a = 0; a < 3; ++a) {
        if (p[a] < filter.clip->min[a] || p[a] > filter.clip->max[a]) return false;
    }
    return true;
}

/// Nothing where the fragment at (u, v) is not covered, else 1 - w.
bool covered(const NearestPass& pass, double u, double v) {
    const bool inSquare = u > -1 && u <= 1 && v > -1 && v <= 1;
    const bool round = pass.footprint == Footprint::Circle || pass.profile == Profile::Sphere;
    return round ? u * u + v * v <= 1 : inSquare;
}

double oneMinusWeight(Profile profile, double u, double v) {
    const double t = u * u + v * v;
    switch (profile) {
        case Profile::Flat:
            return 0;
        case Profile::Paraboloid:
            return t;
        case Profile::Cone:
            return std::sqrt(t);
        case Profile::Sphere:
            return 1 - std::sqrt(std::max(0.0, 1 - t));
    }
    return 0;
}

struct FlatSplat {
    double x, y, depth, p, q;
    std::uint64_t ordinal;
    Rgb8 color;
};

void draw(const FlatSplat& s, const NearestPass& pass, ReferencePicture& picture) {
    const double reach = s.p / 2 + 1;
    for (int y = std::max(0, int(std::floor(s.y - reach)));
         y <= std::min(picture.height - 1, int(s.y + reach)); ++y) {
        for (int x = std::max(0, int(std::floor(s.x - reach)));
             x <= std::min(picture.width - 1, int(s.x + reach)); ++x) {
            const double dx = x + 0.5 - s.x, dy = y + 0.5 - s.y;
            const double u = dx / (s.p / 2), v = dy / (s.p / 2);
            const bool center = std::floor(s.x) == x && std::floor(s.y) == y;
            if (!center && (pass.footprint == Footprint::Pixel || !covered(pass, u, v))) continue;
            const double radius = s.p / 2 / s.q;
            ReferenceFragment f;
            f.order = center ? s.depth : s.depth + pass.gain * oneMinusWeight(pass.profile, u, v) * radius;
            const double half = std::max(s.p / 2, 0.5);
            f.distance = (dx * dx + dy * dy) / (half * half);
            f.sample = s.ordinal;
            f.color = s.color;
            ReferenceFragment& now = picture.pixels[static_cast<std::size_t>(y) * picture.width + x];
            if (f.order < now.order || (f.order == now.order && f.distance < now.distance)) now = f;
        }
    }
}

}  // namespace

ReferencePicture referenceNearest(const Drawing& drawing) {
    const Viewpoint& v = drawing.mainView().viewpoint;
    const auto& pass = std::get<NearestPass>(drawing.passes[0]);
    ReferencePicture picture{v.width, v.height, {}};
    ReferenceFragment nothing;
    nothing.order = infinity;
    picture.pixels.assign(static_cast<std::size_t>(v.width) * v.height, nothing);
    for (const CutRun& run : drawing.mainView().cut.runs) {
        for (std::size_t i = 0; i < run.samples.size(); ++i) {
            const glm::dvec3 place = position(*run.node, run.samples[i]);
            const glm::dvec4 eye = v.cloudToView * glm::dvec4(place, 1);
            FlatSplat s;
            s.depth = -eye.z;
            if (!(s.depth >= v.near && s.depth <= v.far) || !(s.depth > 0)) continue;
            if (!wanted(drawing.mainView().filter, run.samples[i], place)) continue;
            s.q = v.projection == Projection::Perspective ? v.pixelsPerUnit / s.depth : v.pixelsPerUnit;
            s.x = v.width / 2.0 + drawing.jitter[0].x + s.q * eye.x;
            s.y = v.height / 2.0 + drawing.jitter[0].y - s.q * eye.y;
            const SplatSize& size = pass.size;
            s.p = size.sizePx > 0 ? size.sizePx
                                  : std::clamp(2.0 * run.node->spacing * size.scale * s.q, double(size.minPx),
                                               double(size.maxPx));
            s.ordinal = run.firstOrdinal + i;
            const BesideWord beside = run.beside.empty() ? 0 : run.beside[i];
            s.color = colorOf(drawing.color, *run.node, run.samples[i], beside, place, s.depth);
            draw(s, pass, picture);
        }
    }
    return picture;
}

double referenceEyeDome(const Frame& depths, int x, int y, const EyeDomePass& pass) {
    const auto depthAt = [&](int i, int j) {
        const bool inside = i >= 0 && i < depths.width && j >= 0 && j < depths.height;
        return inside ? double(depths.depth[static_cast<std::size_t>(j) * depths.width + i]) : infinity;
    };
    double sum = 0;
    for (int k = 0; k < 8; ++k) {
        const double angle = k * 3.14159265358979323846 / 4;
        const double d = depthAt(x + int(std::lround(pass.radiusPx * std::cos(angle))),
                                 y + int(std::lround(pass.radiusPx * std::sin(angle))));
        if (d < infinity) sum += std::max(0.0, std::log2(depthAt(x, y)) - std::log2(d));
    }
    return std::exp(-300 * pass.strength * sum / 8);
}

}  // namespace scancast::test
