#include "renderer/cloud/build/sides/decide_sides.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <numbers>

#include "renderer/cloud/build/sides/free_space.hpp"
#include "renderer/cloud/build/sides/patch_graph.hpp"

namespace scancast {

namespace {

constexpr std::size_t mostAsked = 4096;
/// A direction within 78° of the normal leaves on its side.
constexpr float leavesAt = 0.2f;
/// Shares of rays: who sees so little of the outside is buried; who sees so much, stands at it.
constexpr float buriedShare = 0.3f, openShare = 0.6f;
/// In the open the largest tree looks up; it has the sky above where nothing is below it.
constexpr double groundShare = 0.15, upSum = 0.4, skyShare = 0.4;
/// A closed tree that goes around so much else, of its own area, is a room.
constexpr double contentShare = 0.04, insideAt = 0.8;
constexpr std::size_t mostInside = 256;
/// A tree of patches whose normals add up to less than this is closed.
constexpr double closedSum = 0.35;

/// 0 below `low`, 1 from `high` on.
double ramp(double value, double low, double high) {
    return std::clamp((value - low) / (high - low), 0.0, 1.0);
}

/// A facet from which rays were sent.
struct Asked {
    std::size_t facet = 0;
    float front = 0, back = 0;  ///< shares of the rays on that side that leave the cloud
    bool up = false, down = false;
};

/// What the facets of one tree of patches say together, on the tree's side.
struct TreeVotes {
    double area = 0, up = 0, upright = 0;
    glm::dvec3 normals{0}, middle{0};
    double outward = 0, anyward = 0;            ///< from the middle: net, and all
    double asked = 0, openFront = 0, open = 0;  ///< area asked; that sees the outside in front and not behind, net; all
    double walls = 0;                           ///< area asked that sees it on one side alone
};

class SideDecision {
  public:
    SideDecision(std::span<const Facet> facets, std::span<const PatchCount> patches)
        : facets_(facets), patches_(patches), forest_(joinPatches(facets, patches)), trees_(forest_.trees) {}

    Sides decide() {
        look();
        measure();
        Sides sides;
        sides.surroundings = surroundings_ = surroundings();
        std::vector<double> votes;
        for (const TreeVotes& t : trees_) votes.push_back(vote(t));
        for (std::uint32_t p = 0; p < patches_.size(); ++p) {
            const double vote = votes[forest_.tree[p]];
            const PatchCount& count = patches_[p];
            const double against = count.links ? double(count.contradictions) / double(count.links) : 0;
            const double sure = ramp(std::abs(vote), 0.1, 0.5) * ramp(forest_.trust[p], 0.4, 0.7) *
                                (1 - ramp(against, 0.01, 0.06));
            sides.turn.push_back(forest_.turned[p] != (vote < 0));
            sides.confidence.push_back(std::uint8_t(254 * sure));
        }
        if (std::getenv("SIDES_DEBUG")) {
            static const char* names[] = {"object", "open", "interior"};
            std::fprintf(stderr, "%s: %zu facets %zu patches %u trees\n",
                         names[int(surroundings_)], facets_.size(), patches_.size(), forest_.trees);
            std::vector<std::uint32_t> order(trees_.size());
            for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
            std::sort(order.begin(), order.end(), [&](auto a, auto b) { return trees_[a].area > trees_[b].area; });
            double total = 0, loose = 0;
            for (const Facet& f : facets_) (f.patch == loosePoints ? loose : total) += f.area;
            std::fprintf(stderr, "area in patches %g loose %g\n", total, loose);
            for (std::size_t i = 0; i < std::min<std::size_t>(12, order.size()); ++i) {
                const TreeVotes& t = trees_[order[i]];
                std::uint32_t n = 0;
                for (auto x : forest_.tree) n += x == order[i];
                std::fprintf(stderr, "  tree %u: patches %u area %.3f%% vote %.3f sum %.3f up %.3f/%.3f out %.3f open %.3f asked %.2f walls %.3f mid %.2f %.2f %.2f\n", order[i], n,
                             100 * t.area / total, votes[order[i]], glm::length(t.normals) / t.area, t.up / t.area, t.upright / t.area,
                             t.outward / t.anyward, t.open > 0 ? t.openFront / t.open : 0, t.asked/t.area, t.asked > 0 ? t.walls / t.asked : 0, t.middle.x, t.middle.y, t.middle.z);
            }
        }
        return sides;
    }

  private:
    glm::vec3 normal(const Facet& f) const { return forest_.turned[f.patch] ? -f.normal : f.normal; }

    void look() {
        std::vector<std::size_t> known;
        for (std::size_t i = 0; i < facets_.size(); ++i)
            if (facets_[i].patch != loosePoints) known.push_back(i);
        if (known.empty()) return;
        const FreeSpace space(facets_);
        const std::size_t count = std::min(known.size(), mostAsked);
        asked_.resize(count);
        tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) {
            asked_[i] = ask(known[i * known.size() / count], space);
        });
    }

    Asked ask(std::size_t facet, const FreeSpace& space) const {
        Asked a{.facet = facet};
        const Facet& f = facets_[facet];
        const glm::vec3 n = normal(f);
        int front = 0, back = 0;
        for (const glm::vec3& d : FreeSpace::directions()) {
            const float along = glm::dot(d, n);
            const bool vertical = std::abs(d.z) > 0.9f;
            if (std::abs(along) < leavesAt && !vertical) continue;
            const bool free = space.escapes(f.position, d);
            if (vertical) (d.z > 0 ? a.up : a.down) = free;
            if (along >= leavesAt) ++front, a.front += float(free);
            if (along <= -leavesAt) ++back, a.back += float(free);
        }
        if (front > 0) a.front /= float(front);
        if (back > 0) a.back /= float(back);
        return a;
    }

    void measure() {
        for (const Facet& f : facets_) {
            if (f.patch == loosePoints) continue;
            TreeVotes& t = trees_[forest_.tree[f.patch]];
            const glm::vec3 n = normal(f);
            t.area += f.area;
            t.normals += double(f.area) * glm::dvec3(n);
            t.middle += double(f.area) * glm::dvec3(f.position);
            t.up += double(f.area) * n.z;
            t.upright += double(f.area) * std::abs(n.z);
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
        for (const Asked& a : asked_) {
            const Facet& f = facets_[a.facet];
            TreeVotes& t = trees_[forest_.tree[f.patch]];
            t.asked += f.area;
            t.openFront += f.area * (a.front - a.back);
            t.open += f.area * std::max(a.front, a.back);
            if (std::max(a.front, a.back) >= openShare && std::min(a.front, a.back) < buriedShare)
                t.walls += f.area;
        }
    }

    Surroundings surroundings() const {
        double all = 0, ground = 0, sky = 0;
        for (const Asked& a : asked_) {
            const Facet& f = facets_[a.facet];
            all += f.area;
            if (std::abs(f.normal.z) < 0.7f || !a.down) continue;
            ground += f.area;
            if (a.up) sky += f.area;
        }
        if (trees_.empty()) return Surroundings::Object;
        const std::size_t main = mainTree();
        const TreeVotes& t = trees_[main];
        const double up = t.area > 0 ? std::abs(t.up) / t.area : 0;
        if (std::getenv("SIDES_DEBUG")) std::fprintf(stderr, "all %g ground %g sky %g up %g content %g\n", all, ground, sky, up, contentOf(main));
        if (ground >= groundShare * all && up >= upSum && sky >= skyShare * ground) return Surroundings::Open;
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
                sum += double(f.area * glm::dot(normal(f), way)) / (double(length2) * std::sqrt(double(length2)));
        }
        return count > 0 ? sum * double(shell.size()) / double(count) / (4 * std::numbers::pi) : 0;
    }

    /// -1 … 1: how far the tree's side is the one that was scanned, or the other one.
    double vote(const TreeVotes& t) const {
        if (!(t.area > 0)) return 0;
        const bool closed = glm::length(t.normals) < closedSum * t.area;
        const double outward = t.anyward > 0 ? t.outward / t.anyward : 0;
        if (surroundings_ == Surroundings::Open) {
            const double up = t.up / std::max(t.upright, 0.25 * t.area);
            return std::abs(up) >= 0.25 || !closed ? up : outward;
        }
        const double open = t.open > 0 ? t.openFront / t.open : 0;
        if (surroundings_ == Surroundings::Interior) {
            if (t.asked > 0 && t.walls >= 0.2 * t.asked) return -open;
            return closed ? outward : 0;
        }
        if (!closed) return open;
        return (open < 0) == (outward < 0) ? (std::abs(open) > std::abs(outward) ? open : outward)
                                           : open + outward;
    }

    std::span<const Facet> facets_;
    std::span<const PatchCount> patches_;
    const PatchForest forest_;
    std::vector<Asked> asked_;
    std::vector<TreeVotes> trees_;
    Surroundings surroundings_ = Surroundings::Object;
};

}  // namespace

Sides decideSides(std::span<const Facet> facets, std::span<const PatchCount> patches) {
    return SideDecision(facets, patches).decide();
}

}  // namespace scancast
