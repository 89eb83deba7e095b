#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "renderer/cloud/build/nodes/subtree.hpp"
#include "renderer/cloud/surfel_codec.hpp"
#include "renderer/cloud/surfels/sizes.hpp"
#include "renderer/cloud/surfels/surfels.hpp"

namespace scancast {

namespace {

/// Offsets from the chunk's corner: float tells them apart where the scan's own coordinates would not.
std::vector<glm::vec3> offsets(std::span<const BuildPoint> points, std::span<const BuildPoint> halo,
                               const GridBox& box, const Grid& grid) {
    std::vector<glm::vec3> out(points.size() + halo.size());
    const auto offset = [&](const BuildPoint& p) {
        glm::vec3 o;
        for (int a = 0; a < 3; ++a)
            o[a] = float(double(std::int64_t(p.axis(a)) - std::int64_t(box.min[a])) * grid.step[a]);
        return o;
    };
    tbb::parallel_for(std::size_t(0), out.size(), [&](std::size_t i) {
        out[i] = offset(i < points.size() ? points[i] : halo[i - points.size()]);
    });
    return out;
}

/// Where nobody knows the side that was scanned, neighbours at least mostly agree on one: an oblique
/// direction, which few surfaces of a built world are parallel to.
constexpr glm::vec3 obliqueSide(0.36f, 0.48f, 0.8f);

/// Turns an estimated normal to the side that was scanned, where that is known.
glm::vec3 orient(const glm::vec3& normal, const BuildPoint& p, const OctreeInput& input) {
    if (input.findSides) return normal;
    if (input.shape.orientation == Orientation::Up) return normal.z < 0 ? -normal : normal;
    if (input.sights)
        if (const glm::vec3 sight = decodeNormal(p.normal); sight != glm::vec3(0))
            return glm::dot(normal, sight) < 0 ? -normal : normal;
    if (!input.scanner) return glm::dot(normal, obliqueSide) < 0 ? -normal : normal;
    const glm::dvec3 toScanner = *input.scanner - (input.grid.toFile(p.position()) - input.origin);
    return glm::dot(glm::dvec3(normal), toScanner) < 0 ? -normal : normal;
}

Bulk bulkOf(Density density) {
    switch (density) {
        case Density::Surface:
        case Density::Edge:
            return Bulk::Surface;
        case Density::Wire:
            return Bulk::Wire;
        case Density::Foliage:
            return Bulk::Foliage;
        case Density::Stray:
            break;
    }
    return Bulk::Stray;
}

void intoLeaf(BuildNode& leaf, std::span<const Surfel> surfels, const OctreeInput& input) {
    const float unit = radiusUnit(leaf.content.spacing);
    leaf.content.densities.resize(leaf.points.size());
    if (input.hasBeside()) leaf.content.beside.resize(leaf.points.size());
    for (std::size_t i = 0; i < leaf.points.size(); ++i) {
        BuildPoint& p = leaf.points[i];
        Surfel surfel = surfels[i];
        const glm::vec3 own = input.ownNormals ? decodeNormal(p.normal) : glm::vec3(0);
        surfel.normal = own == glm::vec3(0) ? orient(surfel.normal, p, input) : own;
        shrink(surfel, largestRadius(surfel, surfel.density, unit));
        leaf.content.densities[i] = surfel.density;
        p.setBulk(bulkOf(surfel.density));
        encodeSurfel(surfel, unit, leaf.content.samples[i]);
        p.normal = leaf.content.samples[i].normal;
        if (input.shape.curvatures())
            leaf.content.beside[i] = withCurvature(
                leaf.content.beside[i], curvatureCodeOf(surfels[i], leaf.content.samples[i], unit));
    }
}

}  // namespace

SidePatches addLeafSurfels(BuildNode& root, std::span<const BuildPoint> halo, const OctreeInput& input) {
    std::vector<BuildNode*> leaves;
    std::vector<float> spacings(root.points.size());
    const auto firstOf = [&](const BuildNode& leaf) {
        return std::size_t(leaf.points.data() - root.points.data());
    };
    forEachNode(root, [&](BuildNode& n) {
        if (!n.isLeaf()) return;
        leaves.push_back(&n);
        std::fill_n(spacings.begin() + std::ptrdiff_t(firstOf(n)), n.points.size(), float(n.content.spacing));
    });
    std::vector<Surfel> surfels(root.points.size());
    SidePatches patches;
    estimateSurfels(offsets(root.points, halo, root.box, input.grid),
                    {.neighbours = input.shape.neighbours,
                     .spacings = spacings,
                     .patches = input.findSides ? &patches : nullptr,
                     .bends = input.shape.curvatures(),
                     .layers = true},
                    surfels);
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
        BuildNode& leaf = *leaves[i];
        intoLeaf(leaf, std::span<const Surfel>(surfels).subspan(firstOf(leaf), leaf.points.size()), input);
    });
    return patches;
}

}  // namespace scancast
