#include "renderer/cloud/surfels/patches.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "renderer/cloud/surfels/signed_sets.hpp"

namespace scancast {

namespace {

/// A patch of fewer points says nothing: a leaf's side, a scrap of noise.
constexpr std::uint32_t leastPatch = 32;
constexpr std::size_t mostPatches = 65535;
/// Links of this quality and better join sets of up to so many points by themselves; between larger ones, and of all
/// other links, the votes are counted: where a sheet is thinner than its points are apart, single links lie.
constexpr float soundLink = 0.9f;
constexpr std::uint32_t mostOfBlob = 256;
constexpr float leastLink = 0.3f;
/// Rounds of counting, each between what the one before has joined, and how one-sided votes have to be: less so for
/// scraps. What is left apart is joined, or not, by what the whole cloud knows.
constexpr int rounds = 3;
constexpr float agreementOfScraps = 0.6f, agreementOfSets = 0.85f;
constexpr std::uint32_t mostOfScrap = 128;
constexpr float leastOfSets = 6;
/// Larger patches could hide a part that is plainly on the wrong side.
constexpr std::uint32_t mostOfPatch = 1024;
/// Normals that are nearer to each other than 45° are of one sheet, or of two sheets that are parallel.
constexpr float nearlyParallel = 0.7f;
/// A link across a crease has less to say than one along a plane.
constexpr float creaseFactor = 0.7f;

/// Where nothing else tells, patches at least mostly agree on one side: an oblique direction, which few
/// surfaces of a built world are parallel to.
constexpr glm::vec3 anySide(0.36f, 0.48f, 0.8f);

struct SideVote {
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

inline SideLink linkOf(const glm::vec3& from, const glm::vec3& fromNormal, const glm::vec3& to,
                       const glm::vec3& toNormal) {
    const glm::vec3 way = to - from;
    const float length2 = glm::dot(way, way), straight = glm::dot(fromNormal, toNormal);
    if (!(length2 > 0)) return {std::abs(straight), straight < 0};
    const float mirrored = straight - 2 * glm::dot(fromNormal, way) * glm::dot(toNormal, way) / length2;
    const float size = std::abs(mirrored);
    if (std::abs(straight) < nearlyParallel) return {creaseFactor * size, mirrored < 0};
    // One above the other: noise of one sheet, or two sheets.
    if ((straight < 0) != (mirrored < 0)) return {};
    return {std::min(std::abs(straight), size), mirrored < 0};
}

class PatchFinder {
  public:
    PatchFinder(const NeighbourIndex& index, const Evidence& evidence, std::span<Surfel> surfels)
        : index_(index), evidence_(evidence), surfels_(surfels), own_(index.size()), sets_(index.size()) {
        for (std::uint32_t p = 0; p < index.size(); ++p)
            for (const std::uint32_t i : index.pointsAt(p))
                if (i < surfels.size()) own_[p] = joins(surfels[i]);
    }

    SidePatches find() {
        counts_.resize(index_.size());
        sizes_.assign(index_.size(), 1);
        joinSound();
        for (int round = 0; round < rounds; ++round) joinByVotes();
        left_ = countVotes();
        return number();
    }

  private:
    static bool joins(const Surfel& s) {
        return s.normal != glm::vec3(0) && (s.density == Density::Surface || s.density == Density::Edge);
    }

    /// A link is asked for by the first of its two ends. Whom only the second counts among its neighbours is left out.
    /// What a link is made of, side by side.
    struct Place {
        glm::vec3 at, normal;
        bool own;
    };

    void joinSound() {
        std::vector<Place> places(index_.size());
        for (std::uint32_t p = 0; p < index_.size(); ++p)
            places[p] = {index_.position(p), evidence_.normal(p), own_[p] != 0};
        for (std::uint32_t p = 0; p < index_.size(); ++p) {
            const Place& from = places[p];
            if (!from.own) continue;
            for (const std::uint32_t w : evidence_.witnesses(p)) {
                if (w < p) continue;
                const Place& to = places[w];
                if (!to.own) continue;
                const SideLink link = linkOf(from.at, from.normal, to.at, to.normal);
                if (link.quality < leastLink) continue;
                if (link.quality < soundLink || !joinBlob(p, w, link.opposite))
                    votes_.push_back({p, w, link.opposite ? -link.quality : link.quality});
            }
        }
    }

    /// Borders between roots.
    std::vector<SetBorder> countVotes() {
        std::vector<SetBorder> borders;
        std::vector<std::uint32_t> table(std::bit_ceil(std::max<std::size_t>(64, votes_.size())), 0);
        const std::uint64_t mask = table.size() - 1;
        std::size_t kept = 0;
        for (const SideVote& v : votes_) {
            const SignedSets::Place from = sets_.find(v.from), to = sets_.find(v.to);
            if (from.root == to.root) {
                count(v.from, v.to, (v.same < 0) != (from.turned != to.turned));
                continue;
            }
            votes_[kept++] = v;
            const std::uint32_t low = std::min(from.root, to.root), high = std::max(from.root, to.root);
            std::uint64_t slot = ((std::uint64_t(low) << 32 | high) * 0x9e3779b97f4a7c15u >> 20) & mask;
            while (table[slot] != 0 &&
                   (borders[table[slot] - 1].low != low || borders[table[slot] - 1].high != high))
                slot = (slot + 1) & mask;
            if (table[slot] == 0) {
                borders.push_back({.low = low, .high = high});
                table[slot] = std::uint32_t(borders.size());
            }
            SetBorder& border = borders[table[slot] - 1];
            const bool same = (v.same > 0) == (from.turned == to.turned);
            (same ? border.same : border.opposite) += std::abs(v.same);
        }
        votes_.resize(kept);
        return borders;
    }

    void joinByVotes() {
        std::vector<SetBorder> borders = countVotes();
        std::erase_if(borders, [](const SetBorder& b) { return b.agreement() < agreementOfScraps; });
        std::stable_sort(borders.begin(), borders.end(),
                         [](const SetBorder& a, const SetBorder& b) { return a.net() > b.net(); });
        for (const SetBorder& b : borders) {
            const SignedSets::Place low = sets_.find(b.low), high = sets_.find(b.high);
            if (low.root == high.root) continue;
            // A scrap between two sets hangs on one of them: it is no bridge to the other.
            const bool scrap = std::min(sizes_[low.root], sizes_[high.root]) <= mostOfScrap;
            if (sizes_[low.root] + sizes_[high.root] > mostOfPatch) continue;
            if (!scrap && (b.agreement() < agreementOfSets || b.net() < leastOfSets)) continue;
            joinRoots(low.root, high.root, (b.opposite > b.same) != (low.turned != high.turned));
        }
    }

    /// False: they would be too many together.
    bool joinBlob(std::uint32_t a, std::uint32_t b, bool opposite) {
        const SignedSets::Place from = sets_.find(a), to = sets_.find(b);
        const bool turn = opposite != (from.turned != to.turned);
        if (from.root != to.root) {
            if (sizes_[from.root] + sizes_[to.root] > mostOfBlob) return false;
            joinRoots(from.root, to.root, turn);
        }
        count(a, b, from.root == to.root && turn);
        return true;
    }

    void joinRoots(std::uint32_t a, std::uint32_t b, bool opposite) {
        sets_.join(a, b, opposite);
        sizes_[std::min(a, b)] = sizes_[a] + sizes_[b];
    }

    void count(std::uint32_t a, std::uint32_t b, bool contradicts) {
        for (const std::uint32_t p : {a, b}) {
            ++counts_[p].links;
            counts_[p].against += contradicts;
        }
    }
    /// Many of its neighbours say the opposite: thinner than the points are apart, or where sheets cross.
    bool doubtful(std::uint32_t p) const { return 4 * counts_[p].against > counts_[p].links; }

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
            t.facts.links += counts_[p].links;
            t.facts.contradictions += counts_[p].against;
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
        tellBorders(tally, numbers, out);
        return out;
    }

    void tellBorders(const std::vector<Tally>& tally, const std::vector<std::uint16_t>& numbers,
                     SidePatches& out) {
        for (const SetBorder& b : left_) {
            SidePatches::Border border{numbers[b.low], numbers[b.high], b.same, b.opposite};
            if (border.low == noPatch || border.high == noPatch) continue;
            if ((tally[b.low].towards < 0) != (tally[b.high].towards < 0))
                std::swap(border.same, border.opposite);
            if (border.low > border.high) std::swap(border.low, border.high);
            out.borders.push_back(border);
        }
        std::sort(out.borders.begin(), out.borders.end(), [](const auto& a, const auto& b) {
            return a.low != b.low ? a.low < b.low : a.high < b.high;
        });
    }

    /// Whoever is in no patch - corners, scraps, noise - but among points of one takes its side where those agree.
    void adoptOthers(SidePatches& out) {
        std::vector<Adoption> adoptions;
        for (std::uint32_t p = 0; p < index_.size(); ++p) {
            const std::uint32_t i = ownPoint(p);
            if (i == noPoint || out.of[i] != noPatch || doubtful(p) || surfels_[i].normal == glm::vec3(0))
                continue;
            if (const auto adoption = adopt(p, i, out)) adoptions.push_back(*adoption);
        }
        for (const Adoption& a : adoptions)
            for (const std::uint32_t i : index_.pointsAt(a.position)) {
                if (i >= surfels_.size()) continue;
                out.of[i] = a.patch;
                ++out.patches[a.patch - 1u].points;
                if (a.turn) turnNormal(surfels_[i]);
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
            const SideLink link = linkBetween(index_.position(p), surfels_[point].normal, index_.position(w),
                                              surfels_[i].normal);
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
        const std::uint16_t patch = own_[p] && !doubtful(p) ? numbers[place.root] : noPatch;
        for (const std::uint32_t i : index_.pointsAt(p)) {
            if (i >= surfels_.size()) continue;
            glm::vec3& normal = surfels_[i].normal;
            const bool turn = patch == noPatch && !(own_[p] && numbers[place.root] != noPatch)
                                  ? glm::dot(normal, anySide) < 0
                                  : place.turned != (tally[place.root].towards < 0);
            if (turn) turnNormal(surfels_[i]);
            out.of[i] = patch;
        }
    }

    const NeighbourIndex& index_;
    const Evidence& evidence_;
    std::span<Surfel> surfels_;
    std::vector<std::uint8_t> own_;  ///< by position: a point of the chunk, with a surface
    SignedSets sets_;
    std::vector<std::uint32_t> sizes_;  ///< of roots: positions in the set
    std::vector<SideVote> votes_;
    std::vector<SetBorder> left_;  ///< that did not join
    struct Counts {
        std::uint16_t links = 0, against = 0;
    };
    std::vector<Counts> counts_;  ///< by position, of both that a link joins
};

}  // namespace

SideLink linkBetween(const glm::vec3& from, const glm::vec3& fromNormal, const glm::vec3& to,
                     const glm::vec3& toNormal) {
    return linkOf(from, fromNormal, to, toNormal);
}

SidePatches findPatches(const NeighbourIndex& index, const Evidence& evidence, std::span<Surfel> surfels) {
    return PatchFinder(index, evidence, surfels).find();
}

}  // namespace scancast
