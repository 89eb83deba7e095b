#include "renderer/cloud/build/sides/decide_sides.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

#include "renderer/cloud/build/sides/free_space.hpp"
#include "renderer/cloud/build/sides/patch_graph.hpp"

namespace scancast {

namespace {

/// Facets that rays are sent from: so many in all, and so many of each patch.
constexpr std::size_t mostAsked = 4096, askedOfPatch = 10;
/// A direction within 78° of the normal leaves on its side.
constexpr float leavesAt = 0.2f;
/// In the open the largest tree looks up; it has the sky above where nothing is below it.
constexpr double groundShare = 0.15, upSum = 0.4, plainlyUp = 0.7, skyShare = 0.4;
/// A closed tree that goes around so much else, of its own area, is a room.
constexpr double contentShare = 0.04, insideAt = 0.6;
constexpr std::size_t mostInside = 256;
/// A tree of patches whose normals add up to less than this is closed.
constexpr double closedSum = 0.35;
/// Of its own side a patch says something with so many facets asked, and plainly with so much for one side.
constexpr std::uint32_t leastAsked = 3;
constexpr double plainly = 0.25, leastOwn = 0.1;
/// One facet says it strongly with so much for one side; so many of a patch may say the opposite.
constexpr double strongly = 0.4, mostAgainst = 0.12;

/// 0 below `low`, 1 from `high` on.
double ramp(double value, double low, double high) {
    return std::clamp((value - low) / (high - low), 0.0, 1.0);
}

/// A facet from which rays were sent: on each side of its patch the ways to what they met.
struct Asked {
    std::size_t facet = 0;
    std::array<std::optional<float>, 14> ways;
};

/// What the facets of one tree of patches say together, on the tree's side.
struct TreeVotes {
    double area = 0, up = 0;
    glm::dvec3 normals{0}, middle{0};
    double outward = 0, anyward = 0;  ///< from the middle: net, and all
    OwnSide own;
};

class SideDecision {
  public:
    SideDecision(std::span<const Facet> facets, std::span<const PatchCount> patches,
                 std::span<const Border> borders, bool upIsZ)
        : facets_(facets), patches_(patches), upIsZ_(upIsZ), borders_(bordersOf(facets, borders)) {}

    Sides decide() {
        look();
        forest_ = joinPatches(borders_, patches_, {});
        measure();
        Sides sides;
        sides.surroundings = surroundings_ = surroundings();
        ownSides();
        forest_ = joinPatches(borders_, patches_, own_);
        measure();
        std::vector<double> votes;
        for (const TreeVotes& t : trees_) votes.push_back(vote(t));
        for (std::uint32_t p = 0; p < patches_.size(); ++p) {
            const double vote = votes[forest_.tree[p]];
            sides.turn.push_back(forest_.turned[p] != (vote < 0));
            sides.confidence.push_back(std::uint8_t(254 * sureness(p, vote)));
        }
        return sides;
    }

  private:
    glm::vec3 normal(const Facet& f) const { return forest_.turned[f.patch] ? -f.normal : f.normal; }

    void look() {
        std::vector<std::size_t> known;
        std::vector<std::uint32_t> of(patches_.size());
        for (std::size_t i = 0; i < facets_.size(); ++i)
            if (facets_[i].patch != loosePoints) {
                known.push_back(i);
                ++of[facets_[i].patch];
            }
        if (known.empty()) return;
        const FreeSpace space(facets_);
        const std::size_t stride = std::max<std::size_t>(1, known.size() / mostAsked);
        std::vector<std::uint32_t> seen(patches_.size());
        for (std::size_t i = 0; i < known.size(); ++i) {
            const std::uint32_t patch = facets_[known[i]].patch;
            const std::uint32_t every = std::max<std::uint32_t>(1, of[patch] / askedOfPatch);
            if (seen[patch]++ % std::min<std::size_t>(stride, every) == 0) asked_.push_back({known[i], {}});
        }
        tbb::parallel_for(std::size_t(0), asked_.size(), [&](std::size_t i) {
            const auto& directions = FreeSpace::directions();
            for (std::size_t d = 0; d < directions.size(); ++d)
                asked_[i].ways[d] = space.wayToNext(facets_[asked_[i].facet].position, directions[d]);
        });
    }

    void measure() {
        trees_.assign(forest_.trees, {});
        for (const Facet& f : facets_) {
            if (f.patch == loosePoints) continue;
            TreeVotes& t = trees_[forest_.tree[f.patch]];
            const glm::vec3 n = normal(f);
            t.area += f.area;
            t.normals += double(f.area) * glm::dvec3(n);
            t.middle += double(f.area) * glm::dvec3(f.position);
            t.up += double(f.area) * n.z;
        }
        for (TreeVotes& t : trees_)
            if (t.area > 0) t.middle /= t.area;
        for (const Facet& f : facets_) {
            if (f.patch == loosePoints) continue;
            TreeVotes& t = trees_[forest_.tree[f.patch]];
            const double from = f.area * glm::dot(glm::dvec3(normal(f)), glm::dvec3(f.position) - t.middle);
            t.outward += from;
            t.anyward += std::abs(from);
        }
        for (std::uint32_t p = 0; p < own_.size(); ++p) {
            TreeVotes& t = trees_[forest_.tree[p]];
            t.own.net += forest_.turned[p] ? -own_[p].net : own_[p].net;
            t.own.all += own_[p].all;
        }
    }

    Surroundings surroundings() const {
        if (trees_.empty()) return Surroundings::Object;
        constexpr std::size_t upwards = 0, downwards = 1;  // directions()
        double all = 0, ground = 0, sky = 0;
        for (const Asked& a : asked_) {
            const Facet& f = facets_[a.facet];
            all += f.area;
            if (std::abs(f.normal.z) < 0.7f || (a.ways[downwards] && *a.ways[downwards] < 1)) continue;
            ground += f.area;
            if (!a.ways[upwards] || *a.ways[upwards] >= 1) sky += f.area;
        }
        const std::size_t main = mainTree();
        const TreeVotes& t = trees_[main];
        const double up = std::abs(t.up) / t.area;
        if (upIsZ_ && ground >= groundShare * all && up >= upSum &&
            (up >= plainlyUp || sky >= skyShare * ground))
            return Surroundings::Open;
        if (glm::length(t.normals) >= closedSum * t.area) return Surroundings::Object;
        return contentOf(main) >= contentShare * t.area ? Surroundings::Interior : Surroundings::Object;
    }

    std::size_t mainTree() const {
        const auto smaller = [](const TreeVotes& a, const TreeVotes& b) { return a.area < b.area; };
        return std::size_t(std::max_element(trees_.begin(), trees_.end(), smaller) - trees_.begin());
    }

    /// The area of what is inside a tree of patches without being part of it.
    double contentOf(std::size_t tree) const {
        std::vector<std::size_t> shell, others;
        for (std::size_t i = 0; i < facets_.size(); ++i) {
            const std::uint32_t patch = facets_[i].patch;
            (patch != loosePoints && forest_.tree[patch] == tree ? shell : others).push_back(i);
        }
        const std::size_t asked = std::min(others.size(), mostInside);
        std::vector<double> inside(asked);
        tbb::parallel_for(std::size_t(0), asked, [&](std::size_t i) {
            const Facet& f = facets_[others[i * others.size() / asked]];
            inside[i] = std::abs(windingNumber(f.position, shell)) >= insideAt ? f.area : 0.0;
        });
        double sum = 0;
        for (const double area : inside) sum += area;
        return asked > 0 ? sum * double(others.size()) / double(asked) : 0;
    }

    /// How often a tree of patches goes around a place: 1 or -1 inside what is closed, 0 outside.
    double windingNumber(const glm::vec3& place, std::span<const std::size_t> shell) const {
        const std::size_t count = std::min(shell.size(), mostAsked);
        double sum = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const Facet& f = facets_[shell[i * shell.size() / count]];
            const glm::vec3 way = f.position - place;
            const float length2 = glm::dot(way, way);
            if (length2 > 0)
                sum += double(f.area * glm::dot(normal(f), way)) /
                       (double(length2) * std::sqrt(double(length2)));
        }
        return count > 0 ? sum * double(shell.size()) / double(count) / (4 * std::numbers::pi) : 0;
    }

    /// The side with the free space: rays fly farther there. What leaves the cloud has flown farthest, but in a
    /// room, where it has been in a wall; in the open what leaves downwards does not count at all.
    void ownSides() {
        own_.assign(patches_.size(), {});
        std::vector<std::uint32_t> asked(patches_.size());
        strong_.assign(patches_.size(), {});
        const auto& directions = FreeSpace::directions();
        for (const Asked& a : asked_) {
            const Facet& f = facets_[a.facet];
            double front = 0, back = 0;
            for (std::size_t d = 0; d < directions.size(); ++d) {
                const float along = glm::dot(directions[d], f.normal);
                if (std::abs(along) < leavesAt) continue;
                if (surroundings_ == Surroundings::Open && directions[d].z < -0.1f && !a.ways[d]) continue;
                const double outside = surroundings_ == Surroundings::Interior ? 0 : 1;
                (along > 0 ? front : back) += a.ways[d] ? double(*a.ways[d]) : outside;
            }
            ++asked[f.patch];
            if (front + back > 0 && std::abs(front - back) > strongly * (front + back))
                ++strong_[f.patch][front < back];
            own_[f.patch].net += f.area * (front - back);
            own_[f.patch].all += f.area * (front + back);
        }
        for (std::uint32_t p = 0; p < patches_.size(); ++p) {
            if (asked[p] < leastAsked) own_[p] = {};
            // What was asked stands for the whole patch.
            const double share = patches_[p].points ? double(patches_[p].points) / std::max(1u, asked[p]) : 0;
            own_[p].net *= share;
            own_[p].all *= share;
        }
    }

    /// -1 … 1: how far the tree's side is the one that was scanned, or the other one.
    double vote(const TreeVotes& t) const {
        const double own = t.own.all > 0 ? t.own.net / t.own.all : 0;
        const bool closed = t.area > 0 && glm::length(t.normals) < closedSum * t.area;
        if (surroundings_ == Surroundings::Object && !closed)
            return 0;  // seen from where? A sheet has two sides
        if (!closed || surroundings_ == Surroundings::Interior || !(t.anyward > 0)) return own;
        const double outward = t.outward / t.anyward;
        return std::abs(outward) > std::abs(own) ? outward : own;
    }

    double sureness(std::uint32_t patch, double vote) const {
        const PatchCount& count = patches_[patch];
        const double against = count.links ? double(count.contradictions) / double(count.links) : 0;
        const OwnSide& own = own_[patch];
        const double net = (forest_.turned[patch] != (vote < 0)) ? -own.net : own.net;
        // Under the sky and in a room every patch has free space before it; in the folds of a thing it may have little.
        if (surroundings_ == Surroundings::Object ? net < -plainly * own.all : net <= leastOwn * own.all)
            return 0;
        // Facets that say the opposite: something in the patch is on the wrong side.
        const bool turned = forest_.turned[patch] != (vote < 0);
        const auto& strong = strong_[patch];
        if (surroundings_ != Surroundings::Object &&
            double(strong[!turned]) > mostAgainst * (strong[0] + strong[1]))
            return 0;
        return ramp(std::abs(vote), 0.05, 0.25) * ramp(forest_.trust[patch], 0.4, 0.7) *
               (1 - ramp(against, 0.01, 0.06));
    }

    std::span<const Facet> facets_;
    std::span<const PatchCount> patches_;
    const bool upIsZ_;
    const std::vector<Border> borders_;
    PatchForest forest_;
    std::vector<Asked> asked_;
    std::vector<OwnSide> own_;  ///< by patch
    std::vector<std::array<std::uint32_t, 2>>
        strong_;  ///< by patch: facets that say so strongly: its side, the other
    std::vector<TreeVotes> trees_;
    Surroundings surroundings_ = Surroundings::Object;
};

}  // namespace

Sides decideSides(std::span<const Facet> facets, std::span<const PatchCount> patches,
                  std::span<const Border> borders, bool upIsZ) {
    return SideDecision(facets, patches, borders, upIsZ).decide();
}

}  // namespace scancast
