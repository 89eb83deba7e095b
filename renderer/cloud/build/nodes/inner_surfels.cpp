#include "renderer/cloud/build/nodes/inner_surfels.hpp"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "renderer/cloud/curvature.hpp"
#include "renderer/cloud/surfel_codec.hpp"
#include "renderer/cloud/surfels/sizes.hpp"
#include "renderer/cloud/surfels/surfels.hpp"

namespace scancast {

namespace {

/// Spacings around a node that its samples' neighbours are looked for in.
constexpr double reachOfNeighbours = 4;
/// A handful of averages apart from everything else - a mast, birds - finds its later neighbours far away,
/// and too few to be called outliers: no inner sample's radius exceeds so many spacings of its node. Not
/// fewer, as terrestrial scans get that sparse with distance.
constexpr double mostSpacings = 6;

struct Box {
    glm::dvec3 low, high;
    bool touches(const Bounds& b) const {
        return glm::all(glm::lessThanEqual(b.low, high)) && glm::all(glm::lessThanEqual(low, b.high));
    }
    bool holds(const glm::dvec3& p) const {
        return glm::all(glm::lessThanEqual(p, high)) && glm::all(glm::lessThanEqual(low, p));
    }
};

void findNeighbours(const BuildNode& from, const BuildNode& node, const Box& box,
                    std::vector<const BuildNode*>& found) {
    if (&from == &node || !box.touches(from.content.bounds)) return;
    if (from.level == node.level || from.isLeaf()) {
        found.push_back(&from);
        return;
    }
    for (const auto& child : from.children) findNeighbours(*child, node, box, found);
}

Box boxAround(const NodeContent& content) {
    const double around = reachOfNeighbours * content.spacing;
    return {content.bounds.low - around, content.bounds.high + around};
}

glm::dvec3 positionOf(const Sample& s, const NodeContent& content) {
    return content.corner + content.step * glm::dvec3(s.x, s.y, s.z);
}

/// Whatever was averaged must be covered, however regular the averages themselves are.
void cover(Surfel& surfel, float reach) {
    if (!(surfel.radius < reach)) return;
    const float ratio = surfel.major > 0 ? surfel.minor / surfel.major : 1.0f;
    surfel.radius = reach;
    surfel.major = std::max(surfel.major, surfel.radius * majorPerRadius);
    surfel.minor = surfel.major * ratio;
}

/// The points below say what it is, not the averages: a roof of three cells is as flat, and a crown of three as
/// leafy, as from near. But large is a surface only where the averages say so, too; else it is as large as what
/// was averaged, or as a cell.
void resize(Surfel& surfel, Density below, float reach, double spacing) {
    const bool closed = surfel.density == Density::Surface;
    surfel.density = below;
    surfel.outlier = below == Density::Stray;
    if (below != Density::Surface) return shrink(surfel, largestRadius(surfel, below, spacing));
    const float most = largestRadius(surfel, closed ? Density::Surface : Density::Edge, spacing);
    shrink(surfel, std::min(most, float((closed ? mostSpacings : 1.0) * spacing)));
    cover(surfel, reach);
}

}  // namespace

std::vector<const BuildNode*> neighboursOf(const BuildNode& node, const BuildNode& root) {
    std::vector<const BuildNode*> neighbours;
    findNeighbours(root, node, boxAround(node.content), neighbours);
    return neighbours;
}

Expected<void> addInnerSurfels(const BuildNode& node, const AveragedFacts& facts, const BuildNode& root,
                               const OctreeInput& input, const SamplesOf& samplesOf,
                               std::span<Sample> samples, std::span<BesideWord> beside) {
    const NodeContent& content = node.content;
    std::vector<glm::vec3> offsets;
    for (const Sample& s : samples) offsets.emplace_back(positionOf(s, content) - content.bounds.low);

    const Box box = boxAround(content);
    for (const BuildNode* neighbour : neighboursOf(node, root)) {
        const auto theirs = samplesOf(*neighbour);
        if (!theirs) return passOn(theirs);
        for (const Sample& s : *theirs)
            if (const glm::dvec3 p = positionOf(s, neighbour->content); box.holds(p))
                offsets.emplace_back(p - content.bounds.low);
    }

    std::vector<Surfel> surfels(samples.size());
    const std::vector<float> spacings(samples.size(), float(content.spacing));
    estimateSurfels(
        offsets,
        {.neighbours = input.shape.neighbours, .spacings = spacings, .bends = input.shape.curvatures()},
        surfels);
    const float unit = radiusUnit(content.spacing);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        Surfel surfel = surfels[i];
        if (const glm::vec3 averaged = decodeNormal(samples[i].normal); averaged != glm::vec3(0))
            surfel.normal = averaged;
        resize(surfel, facts.densities[i], facts.reaches[i], content.spacing);
        const bool twoSided = samples[i].ellipse == twoSidedCircle;
        encodeSurfel(surfel, unit, samples[i]);
        if (twoSided) makeTwoSided(samples[i]);
        if (!input.shape.curvatures()) continue;
        surfel.normal = surfels[i].normal;
        beside[i] = withCurvature(beside[i], curvatureCodeOf(surfel, samples[i], unit));
    }
    return {};
}

}  // namespace scancast
