#include "renderer/cloud/build/sides/chunk_sides.hpp"

#include <tbb/parallel_for.h>

#include "renderer/cloud/build/nodes/subtree.hpp"
#include "renderer/cloud/build/sides/leaf_facets.hpp"
#include "renderer/cloud/surfel_codec.hpp"

namespace scancast {

namespace {

struct HeldSurfel {
    std::uint16_t patch = noPatch;
    std::uint8_t logRadius = 0, ellipse = 0;
    BesideWord beside = 0;
};

struct LeafPlace {
    BuildNode* leaf;
    std::size_t first;  ///< of its points among the root's
};

/// Points stand in the order of the leaves.
std::vector<LeafPlace> leavesOf(BuildNode& root) {
    std::vector<LeafPlace> leaves;
    std::size_t first = 0;
    forEachNode(root, [&](BuildNode& n) {
        if (!n.isLeaf()) return;
        leaves.push_back({&n, first});
        first += n.stored.node.sampleCount;
    });
    return leaves;
}

/// The same disc seen from behind: the ellipse's angle counts in another frame.
void turnOver(Sample& sample) {
    Surfel surfel = decodeSurfel(sample, 1);
    surfel.normal = -surfel.normal;
    const std::uint8_t radius = sample.logRadius;
    encodeSurfel(surfel, 1, sample);
    sample.logRadius = radius;
}

}  // namespace

Expected<ChunkSides> holdSides(BuildNode& root, const SidePatches& patches, const OctreeInput& input,
                               Workspace& workspace) {
    ChunkSides held;
    for (const SidePatches::Patch& p : patches.patches)
        held.patches.push_back({.points = p.points, .links = p.links, .contradictions = p.contradictions});
    for (const SidePatches::Border& b : patches.borders)
        held.borders.push_back(
            {.low = b.low - 1u, .high = b.high - 1u, .same = b.same, .opposite = b.opposite});
    const auto leaves = leavesOf(root);
    std::vector<HeldSurfel> surfels(root.points.size());
    std::vector<std::vector<Facet>> facets(leaves.size());
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
        const auto [leaf, first] = leaves[i];
        const auto& beside = leaf->content.beside;
        for (std::size_t s = 0; s < leaf->content.samples.size(); ++s) {
            const Sample& sample = leaf->content.samples[s];
            surfels[first + s] = {patches.of[first + s], sample.logRadius, sample.ellipse,
                                  beside.empty() ? 0 : beside[s]};
        }
        facets[i] = facetsOf(*leaf, std::span(patches.of).subspan(first, leaf->points.size()), input.grid,
                             input.origin);
        giveBack(leaf->content.samples);
        giveBack(leaf->content.densities);
        giveBack(leaf->content.beside);
    });
    for (const auto& some : facets) held.facets.insert(held.facets.end(), some.begin(), some.end());
    auto room = workspace.allocate(surfels.size() * sizeof(HeldSurfel));
    if (!room) return passOn(room);
    if (auto ok = room->write(0, std::as_bytes(std::span(surfels))); !ok) return passOn(ok);
    held.surfels = std::move(*room);
    return held;
}

Expected<void> takeSides(BuildNode& root, const ChunkSides& held, const Sides& sides,
                         std::uint32_t firstPatch, const OctreeInput& input) {
    std::vector<std::byte> space;
    const auto bytes = held.surfels.view(space);
    if (!bytes) return passOn(bytes);
    const std::span surfels(reinterpret_cast<const HeldSurfel*>(bytes->data()), root.points.size());
    const auto leaves = leavesOf(root);
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
        const auto [leaf, first] = leaves[i];
        leaf->points = root.points.subspan(first, leaf->stored.node.sampleCount);
        auto& samples = leaf->content.samples;
        samples = leafSamples(leaf->points, leafLattice(leaf->box, input.grid, input.origin));
        auto& beside = leaf->content.beside;
        if (input.hasBeside()) beside.resize(samples.size());
        for (std::size_t s = 0; s < samples.size(); ++s) {
            const HeldSurfel& from = surfels[first + s];
            if (!beside.empty()) beside[s] = from.beside;
            samples[s].logRadius = from.logRadius;
            samples[s].ellipse = from.ellipse;
            if (from.patch == noPatch || !sides.turn[firstPatch + from.patch - 1u]) continue;
            const glm::vec3 before = decodeNormal(samples[s].normal);
            turnOver(samples[s]);
            if (!beside.empty())
                beside[s] = withCurvature(from.beside, turnedOver(curvatureIn(from.beside), before,
                                                                  decodeNormal(samples[s].normal)));
            leaf->points[s].normal = samples[s].normal;
        }
        const auto sureness = [&](std::size_t s) {
            const std::uint16_t patch = surfels[first + s].patch;
            return patch == noPatch ? std::uint8_t(0) : sides.confidence[firstPatch + patch - 1u];
        };
        std::uint64_t confidence = 0;
        for (std::size_t s = 0; s < samples.size(); ++s) {
            if (sureness(s) < sureSide) continue;
            ++leaf->surePoints;
            confidence += sureness(s);
        }
        if (!mostlySure(leaf->surePoints, samples.size())) return;
        leaf->confidence = std::uint8_t(confidence / leaf->surePoints);
        for (std::size_t s = 0; s < samples.size(); ++s) {
            if (sureness(s) >= sureSide) continue;
            makeTwoSided(samples[s]);
            leaf->points[s].normal = noNormal;
        }
    });
    return {};
}

}  // namespace scancast
