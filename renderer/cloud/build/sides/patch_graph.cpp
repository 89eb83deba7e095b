#include "renderer/cloud/build/sides/patch_graph.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <memory>
#include <numeric>
#include <tuple>

#include "renderer/cloud/surfels/kernels/levels.hpp"
#include "renderer/cloud/surfels/neighbours.hpp"
#include "renderer/cloud/surfels/patches.hpp"
#include "renderer/cloud/surfels/signed_sets.hpp"

namespace scancast {

namespace {

constexpr int neighboursAsked = 8;
/// Every so-manieth facet asks its neighbours.
constexpr std::size_t askingStride = 2;
constexpr float leastVote = 0.3f;
/// Facets farther apart than so many of their widths have nothing to say to each other.
constexpr float reachInWidths = 2.5f;
/// Votes for and against: a border has to be this one-sided, and as long as so many facets.
constexpr double leastAgreement = 0.5, leastVotes = 4.0;
/// Links between points, about, that facets stand for.
constexpr double pointsOfVote = 4;

struct PatchVote {
    std::uint32_t low, high;  ///< patches
    float same;               ///< negative: on opposite sides
};

/// Own sides that are at least so one-sided are believed against a border.
constexpr double plainlyOwn = 0.25;

void votesOf(std::uint32_t p, std::span<const Facet> facets, const NeighbourIndex& index,
             surfel::SearchScratch& scratch, std::vector<PatchVote>& out) {
    const int found = surfelKernels().nearest(index.view(), p, neighboursAsked, scratch);
    for (const std::uint32_t i : index.pointsAt(p)) {
        const Facet& from = facets[i];
        if (from.patch == loosePoints) continue;
        for (int n = 1; n <= found; ++n) {
            const float far2 = scratch.bestSquared[n];
            for (const std::uint32_t j : index.pointsAt(scratch.best[n])) {
                const Facet& to = facets[j];
                if (to.patch == loosePoints || to.patch == from.patch) continue;
                if (far2 > reachInWidths * reachInWidths * std::max(from.area, to.area)) continue;
                const SideLink link = linkBetween(from.position, from.normal, to.position, to.normal);
                if (link.quality < leastVote) continue;
                out.push_back({std::min(from.patch, to.patch), std::max(from.patch, to.patch),
                               link.opposite ? -link.quality : link.quality});
            }
        }
    }
}

bool contradict(const OwnSide& a, const OwnSide& b, bool turn) {
    const auto plain = [](const OwnSide& s) { return std::abs(s.net) > plainlyOwn * s.all; };
    return plain(a) && plain(b) && (a.net < 0) != ((b.net < 0) != turn);
}

struct Branch {
    std::uint32_t to;
    float trust;
};

/// From each tree's largest patch outwards.
void spreadTrust(std::span<const PatchCount> patches, const std::vector<std::vector<Branch>>& branches,
                 PatchForest& forest) {
    std::vector<std::uint32_t> largest(forest.trees, loosePoints);
    for (std::uint32_t p = 0; p < patches.size(); ++p) {
        std::uint32_t& l = largest[forest.tree[p]];
        if (l == loosePoints || patches[p].points > patches[l].points) l = p;
    }
    forest.trust.assign(patches.size(), -1);
    std::vector<std::uint32_t> waiting;
    for (const std::uint32_t start : largest) {
        forest.trust[start] = 1;
        waiting.assign(1, start);
        while (!waiting.empty()) {
            const std::uint32_t p = waiting.back();
            waiting.pop_back();
            for (const Branch& b : branches[p]) {
                if (forest.trust[b.to] >= 0) continue;
                forest.trust[b.to] = std::min(forest.trust[p], b.trust);
                waiting.push_back(b.to);
            }
        }
    }
}

}  // namespace

std::vector<Border> bordersOf(std::span<const Facet> facets, std::span<const Border> known) {
    std::vector<glm::vec3> places;
    for (const Facet& f : facets) places.push_back(f.position);
    const NeighbourIndex index(places);
    constexpr std::size_t task = 1024;
    std::vector<std::vector<PatchVote>> found((index.size() + task - 1) / task);
    if (index.size() > 1)
        tbb::parallel_for(std::size_t(0), found.size(), [&](std::size_t t) {
            const auto scratch = std::make_unique<surfel::SearchScratch>();
            const std::size_t end = std::min<std::size_t>(index.size(), (t + 1) * task);
            for (std::size_t p = t * task; p < end; p += askingStride)
                votesOf(std::uint32_t(p), facets, index, *scratch, found[t]);
        });
    std::vector<PatchVote> votes;
    for (const auto& part : found) votes.insert(votes.end(), part.begin(), part.end());
    std::stable_sort(votes.begin(), votes.end(), [](const PatchVote& a, const PatchVote& b) {
        return std::tuple(a.low, a.high, a.same) < std::tuple(b.low, b.high, b.same);
    });
    std::vector<Border> borders;
    for (const PatchVote& v : votes) {
        if (borders.empty() || borders.back().low != v.low || borders.back().high != v.high)
            borders.push_back({.low = v.low, .high = v.high});
        (v.same < 0 ? borders.back().opposite : borders.back().same) += pointsOfVote * std::abs(v.same);
    }
    std::vector<Border> all;
    std::merge(
        known.begin(), known.end(), borders.begin(), borders.end(), std::back_inserter(all),
        [](const Border& a, const Border& b) { return std::tie(a.low, a.high) < std::tie(b.low, b.high); });
    // What points say comes first, and is enough.
    const auto sameTwo = [](const Border& a, const Border& b) { return a.low == b.low && a.high == b.high; };
    all.erase(std::unique(all.begin(), all.end(), sameTwo), all.end());
    borders.swap(all);
    std::erase_if(borders, [](const Border& b) {
        return b.agreement() < leastAgreement || std::abs(b.same - b.opposite) < leastVotes;
    });
    std::stable_sort(borders.begin(), borders.end(),
                     [](const Border& a, const Border& b) { return a.strength() > b.strength(); });
    return borders;
}

PatchForest joinPatches(std::span<const Border> borders, std::span<const PatchCount> patches,
                        std::span<const OwnSide> own) {
    std::vector<OwnSide> sides(own.begin(), own.end());  // of roots: all of their sets
    sides.resize(patches.size());
    SignedSets sets(patches.size());
    std::vector<std::vector<Branch>> branches(patches.size());
    for (const Border& b : borders) {
        const SignedSets::Place low = sets.find(b.low), high = sets.find(b.high);
        if (low.root == high.root) continue;
        const bool turn = (b.opposite > b.same) != (low.turned != high.turned);
        OwnSide &first = sides[std::min(low.root, high.root)], &second = sides[std::max(low.root, high.root)];
        if (contradict(first, second, turn)) continue;
        sets.join(low.root, high.root, turn);
        first.net += turn ? -second.net : second.net;
        first.all += second.all;
        branches[b.low].push_back({b.high, float(b.agreement())});
        branches[b.high].push_back({b.low, float(b.agreement())});
    }
    PatchForest forest;
    std::vector<std::uint32_t> number(patches.size(), loosePoints);
    for (std::uint32_t p = 0; p < patches.size(); ++p) {
        const SignedSets::Place place = sets.find(p);
        if (number[place.root] == loosePoints) number[place.root] = forest.trees++;
        forest.tree.push_back(number[place.root]);
        forest.turned.push_back(place.turned);
    }
    spreadTrust(patches, branches, forest);
    return forest;
}

}  // namespace scancast
