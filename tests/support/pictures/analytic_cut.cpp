#include "tests/support/pictures/analytic_cut.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <tuple>

#include "renderer/cloud/surfel_codec.hpp"

namespace scancast::test {
namespace {

using Points = std::vector<AnalyticPoint>;

std::array<glm::dvec3, 2> boundsOf(std::span<const AnalyticPoint> points) {
    std::array<glm::dvec3, 2> box{points[0].position, points[0].position};
    for (const AnalyticPoint& p : points) {
        box[0] = glm::min(box[0], p.position);
        box[1] = glm::max(box[1], p.position);
    }
    return box;
}

std::uint64_t mortonCode(const Sample& s) {
    std::uint64_t code = 0;
    for (int bit = 15; bit >= 0; --bit) {
        code = code << 3 | (s.x >> bit & 1u) << 2 | (s.y >> bit & 1u) << 1 | (s.z >> bit & 1u);
    }
    return code;
}

void sortByMorton(std::span<Sample> samples, std::span<CurvatureCode> curvatures) {
    std::vector<std::pair<Sample, CurvatureCode>> both;
    for (std::size_t i = 0; i < samples.size(); ++i) both.emplace_back(samples[i], curvatures[i]);
    std::ranges::sort(both, {}, [](const auto& one) { return mortonCode(one.first); });
    for (std::size_t i = 0; i < both.size(); ++i) std::tie(samples[i], curvatures[i]) = both[i];
}

/// Splits at the median of the longest axis until every part is small; calls `leaf` from first to last.
template <class Leaf>
void splitAtMedians(std::span<AnalyticPoint> points, std::uint32_t leafPoints, const Leaf& leaf) {
    if (points.size() <= leafPoints) return leaf(points);
    const auto box = boundsOf(points);
    const glm::dvec3 size = box[1] - box[0];
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t half = points.size() / 2;
    std::ranges::nth_element(points, points.begin() + static_cast<std::ptrdiff_t>(half), {},
                             [axis](const AnalyticPoint& p) { return p.position[axis]; });
    splitAtMedians(points.first(half), leafPoints, leaf);
    splitAtMedians(points.subspan(half), leafPoints, leaf);
}

glm::dmat4 viewMatrix(glm::dvec3 eye, glm::dvec3 target) {
    const glm::dvec3 direction = glm::normalize(target - eye);
    const glm::dvec3 up = std::abs(direction.z) > 0.999 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    return glm::lookAt(eye, target, up);
}

}  // namespace

AnalyticCloud::AnalyticCloud(std::span<const AnalyticPoint> points, double spacing, std::uint32_t leafPoints,
                             bool mortonOrder) {
    Points own(points.begin(), points.end());
    samples_.reserve(own.size());
    if (!own.empty()) {
        splitAtMedians(std::span(own), leafPoints,
                       [&](std::span<AnalyticPoint> leaf) { addLeaf(leaf, spacing); });
    }
    const bool bent = std::ranges::any_of(curvatures_, [](CurvatureCode code) { return code != 0; });
    std::uint32_t ordinal = 0;
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
        const Node& node = nodes_[i];
        const std::span<Sample> run(samples_.data() + node.firstSample, node.sampleCount);
        const std::span<CurvatureCode> codes(curvatures_.data() + node.firstSample, node.sampleCount);
        if (mortonOrder) sortByMorton(run, codes);
        cut_.runs.push_back({.nodeIndex = i, .samples = run, .firstOrdinal = ordinal});
        if (bent) cut_.runs.back().beside = codes;
        ordinal += node.sampleCount;
    }
    // The vector's memory moves with the object, so these stay true.
    for (std::size_t i = 0; i < nodes_.size(); ++i) cut_.runs[i].node = &nodes_[i];
    cut_.samples = cut_.points = ordinal;
}

void AnalyticCloud::addLeaf(std::span<const AnalyticPoint> points, double spacing) {
    const auto box = boundsOf(points);
    Node node;
    node.boxMin = box[0];
    node.boxMax = box[1];
    node.step = glm::max((box[1] - box[0]) / 65535.0, glm::dvec3(1e-9));
    node.center = (box[0] + box[1]) * 0.5;
    node.radius = glm::length(box[1] - box[0]) * 0.5;
    node.spacing = static_cast<float>(spacing);
    node.radiusUnit = node.spacing;
    node.sampleCount = static_cast<std::uint32_t>(points.size());
    node.firstSample = samples_.size();
    node.points = points.size();
    for (const AnalyticPoint& p : points) {
        const glm::dvec3 q = glm::round((p.position - node.boxMin) / node.step);
        Sample s{};
        s.x = static_cast<std::uint16_t>(q.x);
        s.y = static_cast<std::uint16_t>(q.y);
        s.z = static_cast<std::uint16_t>(q.z);
        s.intensity = p.intensity;
        s.r = p.rgb[0];
        s.g = p.rgb[1];
        s.b = p.rgb[2];
        s.classification = p.classification;
        s.normal = p.normal;
        if (p.surfel) encodeSurfel(*p.surfel, node.radiusUnit, s);
        samples_.push_back(s);
        curvatures_.push_back(p.surfel ? curvatureCodeOf(*p.surfel, s, node.radiusUnit) : 0);
    }
    nodes_.push_back(node);
}

Cut AnalyticCloud::joined(const AnalyticCloud& other) const {
    Cut cut = cut_;
    for (CutRun run : other.cut_.runs) {
        run.nodeIndex += static_cast<std::uint32_t>(nodes_.size());
        run.firstOrdinal += static_cast<std::uint32_t>(cut_.samples);
        cut.runs.push_back(run);
    }
    cut.samples += other.cut_.samples;
    cut.points += other.cut_.points;
    return cut;
}

Viewpoint lookAt(glm::dvec3 eye, glm::dvec3 target, int width, int height, double fovDegrees, double near,
                 double far) {
    Viewpoint v;
    v.width = width;
    v.height = height;
    v.cloudToView = viewMatrix(eye, target);
    v.pixelsPerUnit = height / (2 * std::tan(fovDegrees * 3.14159265358979323846 / 360));
    v.near = near;
    v.far = far;
    return v;
}

Viewpoint lookAtOrthographic(glm::dvec3 eye, glm::dvec3 target, int width, int height, double viewHeight,
                             double near, double far) {
    Viewpoint v = lookAt(eye, target, width, height, 60, near, far);
    v.projection = Projection::Orthographic;
    v.pixelsPerUnit = height / viewHeight;
    return v;
}

std::uint64_t Numbers::next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

double Numbers::uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(next() >> 11) * 0x1p-53;
}

glm::dvec3 Numbers::onSphere() {
    const double z = uniform(-1, 1), angle = uniform(0, 2 * 3.14159265358979323846), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
}

Rgb8 Numbers::color() {
    const std::uint64_t n = next();
    return {static_cast<std::uint8_t>(n), static_cast<std::uint8_t>(n >> 8),
            static_cast<std::uint8_t>(n >> 16)};
}

}  // namespace scancast::test
