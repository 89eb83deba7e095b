#include "renderer/pick/pick.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <queue>

#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/file/exact_places.hpp"
#include "renderer/cloud/surfel_codec.hpp"
#include "renderer/residency/pictured_octree.hpp"
#include "renderer/select/viewpoint.hpp"
#include "renderer/style.hpp"
#include "renderer/together/together.hpp"
#include "renderer/together/together_columns.hpp"

namespace scancast {

bool isDrawn(const SampleFilter& filter, const glm::dvec3& p, const Sample& sample) {
    if (filter.classes && !(*filter.classes)[sample.classification]) return false;
    if (filter.clip) {
        for (int axis = 0; axis < 3; ++axis)
            if (p[axis] < filter.clip->min[axis] || p[axis] > filter.clip->max[axis]) return false;
    }
    return filter.shapes.contains(p) &&
           std::ranges::none_of(filter.dropped, [&](const Region& region) { return region.contains(p); });
}

namespace {

// A picture's depth is a float, hence the tolerance.
bool isGlass(const Cloud& cloud, const glm::dvec3& place, double depth) {
    const double tolerance = 1e-5 * depth;
    return std::any_of(cloud.mirrors.begin(), cloud.mirrors.end(), [&](const Mirror& mirror) {
        const glm::dvec3 offset = place - (mirror.center - cloud.origin);
        const glm::dvec3 right = glm::cross(mirror.up, mirror.normal);
        return std::abs(glm::dot(offset, mirror.normal)) <= tolerance &&
               std::abs(glm::dot(offset, right)) <= mirror.width / 2 + tolerance &&
               std::abs(glm::dot(offset, mirror.up)) <= mirror.height / 2 + tolerance;
    });
}

double distanceToBox(const Node& node, const glm::dvec3& p) {
    const glm::dvec3 low = glm::max(node.boxMin - p, glm::dvec3(0));
    const glm::dvec3 high = glm::max(p - node.boxMax, glm::dvec3(0));
    return glm::length(low + high);
}

/// Whether shapes leave nothing of a node: then its samples need not be had.
bool isCutAway(const SampleFilter& filter, const Node& node) {
    return filter.shapes.overlap(node.boxMin - node.step, node.boxMax + node.step) == Overlap::None;
}

// Three digits finer than the grid: enough for every step of it, and too few for the noise of adding doubles.
double withoutNoise(double value, double step) {
    const double digits = std::clamp(3 - std::floor(std::log10(step)), 0.0, 15.0);
    const double unit = std::pow(10.0, digits);
    const double scaled = value * unit;
    return std::abs(scaled) < 9e15 ? std::round(scaled) / unit : value;
}

struct Nearest {
    double distance = std::numeric_limits<double>::infinity();
    std::uint32_t node = noNode;
    std::size_t index = 0;  ///< in the run
    SampleRun run{};        ///< the node's samples

    const Sample& sample() const { return run.samples[index]; }
};

void compare(const Node& node, std::uint32_t index, const SampleRun& run, const glm::dvec3& place,
             const SampleFilter& filter, Nearest& best) {
    for (std::size_t i = 0; i < run.samples.size(); ++i) {
        const Sample& sample = run.samples[i];
        const glm::dvec3 p = position(node, sample);
        const double distance = glm::distance(p, place);
        const bool nearer = distance < best.distance || (distance == best.distance && index < best.node);
        if (nearer && isDrawn(filter, p, sample)) best = {distance, index, i, run};
    }
}

// Nearest boxes first: what is left when a box is farther than the best point need not be looked at.
Expected<Nearest> nearestLeafSample(const Octree& octree, const glm::dvec3& place, const SampleFilter& filter,
                                    const std::stop_token& stop) {
    Nearest best;
    using Entry = std::pair<double, std::uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (std::uint32_t root = 0; root < octree.roots(); ++root)
        queue.emplace(distanceToBox(octree.node(root), place), root);
    while (!queue.empty() && queue.top().first <= best.distance) {
        const std::uint32_t index = queue.top().second;
        queue.pop();
        const Node& node = octree.node(index);
        if (isCutAway(filter, node)) continue;
        if (!node.isLeaf()) {
            for (std::uint32_t child = node.firstChild; child < node.firstChild + node.childCount; ++child)
                queue.emplace(distanceToBox(octree.node(child), place), child);
            continue;
        }
        const auto run = octree.store().load(index, stop);
        if (!run) return passOn(run);
        compare(node, index, *run, place, filter, best);
    }
    return best;
}

/// All that is known of it: from its file, or, in memory, what its sample says.
Expected<KeptPoint> keptPoint(const Cloud& cloud, const Octree& octree, const Nearest& found) {
    const Node& node = octree.node(found.node);
    KeptPoint point;
    if (const auto file = octree.store().cloudFile()) {
        auto kept = file->point(found.node, found.run.samples, found.index);
        if (!kept) return kept;
        point = std::move(*kept);
    } else {
        const ExactPlaces places(cloud, nullptr);
        if (auto ok =
                places.of(found.node, node, std::span(&found.sample(), 1), std::span(&point.position, 1));
            !ok)
            return passOn(ok);
        point.exact = places.isExact(node);
        point.precision = places.precision(node, point.position);
    }
    if (!point.exact)
        for (int axis = 0; axis < 3; ++axis)
            point.position[axis] = withoutNoise(point.position[axis], point.precision[axis]);
    return point;
}

/// Of several clouds, the one that has it, where `found` is then.
Expected<Picked::Of> ownerOf(const Together& together, const Style& filtered, Nearest& found,
                             const std::stop_token& stop) {
    const Together::Place& place = together.places[found.node];
    const TogetherMember& member = together.members[place.member];
    const auto pictured = picturedOctree(*member.cloud, filtered);
    if (!pictured) return passOn(pictured);
    const Octree& octree = *pictured ? **pictured : member.cloud->octree;
    auto run = octree.store().load(place.node, stop);
    if (!run) return passOn(std::move(run));
    found.node = place.node;
    found.run = std::move(*run);
    return Picked::Of{member.cloud, member.name, member.shift};
}

// What was drawn may stand beside the scan's surface: a sprite faces the viewer, whichever way that lies.
glm::dvec3 onSurface(const Octree& octree, const Nearest& found, const glm::dvec3& place,
                     const glm::dvec3& ray) {
    constexpr double grazing = 0.15;  // rays along the plane meet it anywhere
    if (found.sample().normal == noNormal) return place;
    const Node& node = octree.node(found.node);
    const glm::dvec3 normal(decodeNormal(found.sample().normal));
    const double against = glm::dot(normal, ray);
    if (!(std::abs(against) > grazing)) return place;
    const double ahead = glm::dot(normal, position(node, found.sample()) - place) / against;
    return std::abs(ahead) <= 2 * double(node.meanSpacing) ? place + ahead * ray : place;
}

double radiusOf(const Cloud& cloud, const Node& node, const Sample& sample) {
    if (!cloud.surfels || sample.logRadius == 0 || sample.logRadius == outlierRadius) return 0;
    return double(surfelRadii()[sample.logRadius]) * double(node.radiusUnit);
}

}  // namespace

Expected<glm::dvec3> placeUnder(const Cloud& cloud, const View& view, const glm::ivec2& pixel, double depth) {
    const auto viewpoint = Viewpoint::create(view, cloud.origin, cloud.bounds);
    if (!viewpoint) return passOn(viewpoint);
    const double q = viewpoint->q(depth);
    const glm::dvec4 seen((pixel.x + 0.5 - view.width * 0.5) / q, (view.height * 0.5 - pixel.y - 0.5) / q,
                          -depth, 1);
    return glm::dvec3(glm::inverse(viewpoint->cloudToView) * seen);
}

Expected<std::optional<Picked>> pick(const Cloud& cloud, const View& view, const glm::ivec2& pixel,
                                     double depth, std::stop_token stop) {
    if (!std::isfinite(depth)) return std::nullopt;
    const auto place = placeUnder(cloud, view, pixel, depth);
    if (!place) return passOn(place);
    if (view.style.mirrors && isGlass(cloud, *place, depth)) return std::nullopt;
    Style filtered = view.style;
    filtered.color = ColorSource::Auto;  // else samples would have a column's values for intensities
    const auto pictured = picturedOctreeOf(cloud, filtered);
    if (!pictured) return passOn(pictured);
    const Octree& octree = *pictured ? **pictured : cloud.octree;
    auto nearest = nearestLeafSample(octree, *place, sampleFilter(cloud, view.style), stop);
    if (!nearest) return passOn(nearest);
    if (nearest->node == noNode) return std::nullopt;
    const auto before = placeUnder(cloud, view, pixel, depth / 2);
    if (!before) return passOn(before);
    Picked picked;
    picked.surface = cloud.origin + onSurface(octree, *nearest, *place, glm::normalize(*place - *before));
    if (cloud.together) {
        auto owner = ownerOf(*cloud.together, filtered, *nearest, stop);
        if (!owner) return passOn(std::move(owner));
        picked.of = std::move(*owner);
        picked.surface -= picked.of->shift;
    }
    const Cloud& own = picked.of ? *picked.of->cloud : cloud;
    const auto ofOwn = picked.of ? picturedOctree(own, filtered) : pictured;
    if (!ofOwn) return passOn(ofOwn);
    auto point = keptPoint(own, *ofOwn ? **ofOwn : own.octree, *nearest);
    if (!point) return passOn(std::move(point));
    picked.point = std::move(*point);
    picked.sample = nearest->sample();
    picked.radius = radiusOf(own, own.octree.node(nearest->node), picked.sample);
    picked.depth = depth;
    picked.distance = nearest->distance;
    return picked;
}

}  // namespace scancast
