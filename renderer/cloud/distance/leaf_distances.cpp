#include "renderer/cloud/distance/leaf_distances.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace scancast {

namespace {

/// Points that are looked at together: so few that they lie close to each other.
constexpr std::size_t groupPoints = 64;

class LeafSearch {
  public:
    LeafSearch(const EarlierPoints& earlier, std::span<const glm::dvec3> places, double most)
        : earlier_(earlier), places_(places), squared_(places.size(), most * most) {
        for (std::size_t first = 0; first < places.size(); first += groupPoints) {
            Group group{.first = first, .end = std::min(first + groupPoints, places.size())};
            for (std::size_t i = first; i < group.end; ++i) group.box.add(places[i]);
            group.farthest = most * most;
            box_.add(group.box);
            groups_.push_back(group);
        }
    }

    /// First the leaves that points lie in, which bounds most of them closely; then, from near to far, those that may have
    /// something nearer, of which there are few.
    Expected<void> run() {
        LeavesByDistance around(earlier_, box_);
        while (const auto found = around.next(std::numeric_limits<double>::min()))
            if (auto ok = look(found->leaf, Points::Inside); !ok) return ok;
        LeavesByDistance all(earlier_, box_);
        while (const auto found = all.next(farthest()))
            if (auto ok = look(found->leaf, Points::Outside); !ok) return ok;
        return {};
    }

    const std::vector<double>& squared() const { return squared_; }

  private:
    enum class Points : std::uint8_t { Inside, Outside };
    struct Group {
        std::size_t first, end;
        DistanceBox box{};
        double farthest = 0;  ///< largest of its squared distances, as far as they are known
    };

    double farthest() const {
        double most = 0;
        for (const Group& group : groups_) most = std::max(most, group.farthest);
        return most;
    }

    Expected<void> look(std::uint32_t leaf, Points which) {
        const DistanceBox& box = earlier_.box(leaf);
        std::shared_ptr<const PointTree> tree;  // only where a point needs it
        std::optional<std::uint32_t> last;
        for (Group& group : groups_) {
            const double apart = box.squaredTo(group.box);
            if (apart >= group.farthest || (which == Points::Inside && apart > 0)) continue;
            bool changed = false;
            for (std::size_t i = group.first; i < group.end; ++i) {
                const double from = box.squaredTo(places_[i]);
                if (from >= squared_[i] || (from == 0) != (which == Points::Inside)) continue;
                if (!tree) {
                    auto loaded = earlier_.tree(leaf);
                    if (!loaded) return passOn(loaded);
                    tree = std::move(*loaded);
                }
                changed |= lookFor(i, *tree, last);
            }
            if (changed)
                group.farthest = *std::max_element(squared_.begin() + std::ptrdiff_t(group.first),
                                                   squared_.begin() + std::ptrdiff_t(group.end));
        }
        return {};
    }

    /// What was nearest to the point before is near to this one, too.
    bool lookFor(std::size_t i, const PointTree& tree, std::optional<std::uint32_t>& last) {
        PointTree::Nearest nearest{.squared = squared_[i]};
        bool found = false;
        if (last) {
            const double squared = squaredLength(tree.point(*last) - places_[i]);
            if (squared < nearest.squared) {
                nearest.squared = squared;
                found = true;
            }
        }
        if (tree.findNearer(places_[i], nearest)) {
            last = nearest.place;
            found = true;
        }
        squared_[i] = nearest.squared;
        return found;
    }

    const EarlierPoints& earlier_;
    const std::span<const glm::dvec3> places_;
    std::vector<double> squared_;
    std::vector<Group> groups_;
    DistanceBox box_;
};

}  // namespace

Expected<void> leafDistances(const EarlierPoints& earlier, std::span<const glm::dvec3> places, double most,
                             std::span<float> distances) {
    LeafSearch search(earlier, places, most);
    if (auto ok = search.run(); !ok) return ok;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const double squared = search.squared()[i];
        distances[i] = float(squared < most * most ? std::sqrt(squared) : most);
    }
    return {};
}

}  // namespace scancast
