#include "renderer/cloud/surfels/patches.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <tuple>

#include "renderer/cloud/surfels/signed_sets.hpp"

namespace scancast {

namespace {

/// A patch of fewer points says nothing: a leaf's side, a scrap of noise.
constexpr std::uint32_t leastPatch = 32;
constexpr std::size_t mostPatches = 65535;
/// Links of this quality and better join by themselves; of all others between two sets, the votes are counted.
constexpr float soundLink = 0.9f;
constexpr float leastLink = 0.3f;
/// Rounds of counting, each between what the one before has joined, and how one-sided votes have to be in each.
constexpr std::array<float, 3> agreements{0.8f, 0.65f, 0.5f};
/// Normals that are nearer to each other than 45° are of one sheet, or of two sheets that are parallel.
constexpr float nearlyParallel = 0.7f;
/// A link across a crease has less to say than one along a plane.
constexpr float creaseFactor = 0.7f;

/// Where nothing else tells, patches at least mostly agree on one side: an oblique direction, which few
/// surfaces of a built world are parallel to.
constexpr glm::vec3 anySide(0.36f, 0.48f, 0.8f);

struct WeakLink {
    std::uint32_t from, to;
    float same;  ///< quality; negative: on opposite sides
};

/// What all links between two sets say.
struct SetBorder {
    std::uint32_t low, high;  ///< roots
    float same = 0, opposite = 0;
    float net() const { return std::abs(same - opposite); }
    float agreement() const { return net() / (same + opposite); }
};

class PatchFinder {
  public:
    PatchFinder(const NeighbourIndex& index, const Evidence& evidence, std::span<Surfel> surfels)
        : index_(index), evidence_(evidence), surfels_(surfels), own_(index.size()), sets_(index.size()) {
        for (std::uint32_t p = 0; p < index.size(); ++p)
            for (const std::uint32_t i : index.pointsAt(p))
                if (i < surfels.size()) own_[p] = joins(surfels[i]);
    }

    SidePatches find() {
        links_.resize(index_.size());
        contradictions_.resize(index_.size());
        joinSound();
        for (const float agreement : agreements) joinByVotes(agreement);
        countContradictions();
        return number();
    }

  private:
    static bool joins(const Surfel& s) {
        return s.normal != glm::vec3(0) && (s.density == Density::Surface || s.density == Density::Edge);
    }

    bool isWitness(std::uint32_t p, std::uint32_t of) const {
        const auto who = evidence_.witnesses(of);
        return std::find(who.begin(), who.end(), p) != who.end();
    }

    void joinSound() {
        for (std::uint32_t p = 0; p < index_.size(); ++p) {
            if (!own_[p]) continue;
            const glm::vec3 at = index_.position(p), normal = evidence_.normal(p);
            for (const std::uint32_t w : evidence_.witnesses(p)) {
                if (!own_[w] || (w < p && isWitness(p, w))) continue;
                const SideLink link = linkBetween(at, normal, index_.position(w), evidence_.normal(w));
                if (link.quality >= soundLink)
                    join(p, w, link.opposite);
                else if (link.quality >= leastLink)
                    weak_.push_back({p, w, link.opposite ? -link.quality : link.quality});
            }
        }
    }

    void joinByVotes(float agreement) {
        std::vector<WeakLink> votes;  // between roots
        for (const WeakLink& link : weak_) {
            const SignedSets::Place from = sets_.find(link.from), to = sets_.find(link.to);
            if (from.root == to.root) continue;
            votes.push_back({std::min(from.root, to.root), std::max(from.root, to.root),
                             from.turned != to.turned ? -link.same : link.same});
        }
        std::stable_sort(votes.begin(), votes.end(), [](const WeakLink& a, const WeakLink& b) {
            return std::tie(a.from, a.to) < std::tie(b.from, b.to);
        });
        std::vector<SetBorder> borders;
        for (const WeakLink& v : votes) {
            if (borders.empty() || borders.back().low != v.from || borders.back().high != v.to)
                borders.push_back({.low = v.from, .high = v.to});
            (v.same < 0 ? borders.back().opposite : borders.back().same) += std::abs(v.same);
        }
        std::erase_if(borders, [&](const SetBorder& b) { return b.agreement() < agreement; });
        std::stable_sort(borders.begin(), borders.end(),
                         [](const SetBorder& a, const SetBorder& b) { return a.net() > b.net(); });
        for (const SetBorder& b : borders) {
            const SignedSets::Place low = sets_.find(b.low), high = sets_.find(b.high);
            if (low.root != high.root)
                sets_.join(low.root, high.root, (b.opposite > b.same) != (low.turned != high.turned));
        }
    }

    void countContradictions() {
        for (const WeakLink& link : weak_) {
            const SignedSets::Place from = sets_.find(link.from), to = sets_.find(link.to);
            if (from.root != to.root) continue;
            ++links_[link.from];
            contradictions_[link.from] += (link.same < 0) != (from.turned != to.turned);
        }
    }

    void join(std::uint32_t a, std::uint32_t b, bool opposite) {
        const SignedSets::Place from = sets_.find(a), to = sets_.find(b);
        const bool turn = opposite != (from.turned != to.turned);
        ++links_[a];
        if (from.root != to.root)
            sets_.join(from.root, to.root, turn);
        else
            contradictions_[a] += turn;
    }

    struct Tally {
        std::uint32_t points = 0, first = ~0u;
        double towards = 0;  ///< anySide
        SidePatches::Patch facts;
    };

    SidePatches number() {
        std::vector<Tally> tally(index_.size());
        for (std::uint32_t p = 0; p < index_.size(); ++p) {
            if (!own_[p]) continue;
            const SignedSets::Place place = sets_.find(p);
            Tally& t = tally[place.root];
            for (const std::uint32_t i : index_.pointsAt(p)) {
                if (i >= surfels_.size()) continue;
                ++t.facts.points;
                t.first = std::min(t.first, i);
            }
            const double side = glm::dot(evidence_.normal(p), anySide);
            t.towards += place.turned ? -side : side;
            t.facts.links += links_[p];
            t.facts.contradictions += contradictions_[p];
        }
        std::vector<std::uint32_t> roots;
        for (std::uint32_t p = 0; p < index_.size(); ++p)
            if (tally[p].facts.points >= leastPatch) roots.push_back(p);
        // The largest where there are too many, then in the order of the points.
        const auto larger = [&](std::uint32_t a, std::uint32_t b) {
            const Tally &x = tally[a], &y = tally[b];
            return x.facts.points != y.facts.points ? x.facts.points > y.facts.points : x.first < y.first;
        };
        if (roots.size() > mostPatches) {
            std::sort(roots.begin(), roots.end(), larger);
            roots.resize(mostPatches);
        }
        std::sort(roots.begin(), roots.end(),
                  [&](std::uint32_t a, std::uint32_t b) { return tally[a].first < tally[b].first; });
        SidePatches out;
        std::vector<std::uint16_t> numbers(index_.size(), noPatch);
        for (const std::uint32_t root : roots) {
            out.patches.push_back(tally[root].facts);
            numbers[root] = std::uint16_t(out.patches.size());
        }
        out.of.assign(surfels_.size(), noPatch);
        for (std::uint32_t p = 0; p < index_.size(); ++p) apply(p, tally, numbers, out);
        adoptOthers(out);
        return out;
    }

    /// Whoever is in no patch - corners, scraps, noise - but among points of one takes its side where those agree.
    void adoptOthers(SidePatches& out) {
        std::vector<Adoption> adoptions;
        for (std::uint32_t p = 0; p < index_.size(); ++p) {
            const std::uint32_t i = ownPoint(p);
            if (i == noPoint || out.of[i] != noPatch || surfels_[i].normal == glm::vec3(0)) continue;
            if (const auto adoption = adopt(p, i, out)) adoptions.push_back(*adoption);
        }
        for (const Adoption& a : adoptions)
            for (const std::uint32_t i : index_.pointsAt(a.position)) {
                if (i >= surfels_.size()) continue;
                out.of[i] = a.patch;
                ++out.patches[a.patch - 1u].points;
                if (a.turn) surfels_[i].normal = -surfels_[i].normal;
            }
    }

    struct Adoption {
        std::uint32_t position;
        std::uint16_t patch;
        bool turn;
    };

    std::optional<Adoption> adopt(std::uint32_t p, std::uint32_t point, const SidePatches& out) const {
        float same = 0, opposite = 0;
        int known = 0;
        std::uint16_t patch = noPatch;
        for (const std::uint32_t w : evidence_.witnesses(p)) {
            const std::uint32_t i = ownPoint(w);
            if (i == noPoint || out.of[i] == noPatch) continue;
            ++known;
            const SideLink link =
                linkBetween(index_.position(p), surfels_[point].normal, index_.position(w), surfels_[i].normal);
            if (patch == noPatch) patch = out.of[i];
            (link.opposite ? opposite : same) += link.quality;
        }
        const float net = std::abs(same - opposite);
        if (2 * known <= int(evidence_.witnesses(p).size()) || !(net > 0.5f * (same + opposite))) return {};
        return Adoption{p, patch, opposite > same};
    }

    static constexpr std::uint32_t noPoint = ~0u;
    std::uint32_t ownPoint(std::uint32_t p) const {
        for (const std::uint32_t i : index_.pointsAt(p))
            if (i < surfels_.size()) return i;
        return noPoint;
    }

    void apply(std::uint32_t p, const std::vector<Tally>& tally, const std::vector<std::uint16_t>& numbers,
               SidePatches& out) {
        const SignedSets::Place place = sets_.find(p);
        const std::uint16_t patch = own_[p] ? numbers[place.root] : noPatch;
        for (const std::uint32_t i : index_.pointsAt(p)) {
            if (i >= surfels_.size()) continue;
            glm::vec3& normal = surfels_[i].normal;
            const bool turn = patch == noPatch ? glm::dot(normal, anySide) < 0
                                               : place.turned != (tally[place.root].towards < 0);
            if (turn) normal = -normal;
            out.of[i] = patch;
        }
    }

    const NeighbourIndex& index_;
    const Evidence& evidence_;
    std::span<Surfel> surfels_;
    std::vector<std::uint8_t> own_;  ///< by position: a point of the chunk, with a surface
    SignedSets sets_;
    std::vector<WeakLink> weak_;
    std::vector<std::uint8_t> links_, contradictions_;  ///< by the position that asked
};

}  // namespace

SideLink linkBetween(const glm::vec3& from, const glm::vec3& fromNormal, const glm::vec3& to,
                     const glm::vec3& toNormal) {
    const glm::vec3 way = to - from;
    const float length2 = glm::dot(way, way), straight = glm::dot(fromNormal, toNormal);
    if (!(length2 > 0)) return {std::abs(straight), straight < 0};
    const float mirrored =
        straight - 2 * glm::dot(fromNormal, way) * glm::dot(toNormal, way) / length2;
    const float size = std::abs(mirrored);
    if (std::abs(straight) < nearlyParallel) return {creaseFactor * size, mirrored < 0};
    // One above the other: noise of one sheet, or two sheets.
    if ((straight < 0) != (mirrored < 0)) return {};
    return {std::min(std::abs(straight), size), mirrored < 0};
}

SidePatches findPatches(const NeighbourIndex& index, const Evidence& evidence, std::span<Surfel> surfels) {
    return PatchFinder(index, evidence, surfels).find();
}

}  // namespace scancast
