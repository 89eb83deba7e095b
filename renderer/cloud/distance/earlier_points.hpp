// The points of the epoch that distances are measured to, leaf by leaf: where leaves are, nearest first, and their points as trees,
// made when somebody asks and kept within a limit. Pipeline: cloud file → **earlier points** → distances.
// *Thread safety*: any number of threads.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include "renderer/cloud/distance/box.hpp"
#include "renderer/cloud/distance/point_tree.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/file/exact_places.hpp"

namespace scancast {

class EarlierPoints {
  public:
    /// `shift` is added to each of the file's points, file coordinates. `limit`: bytes of trees that nobody holds; the one that was
    /// used last is kept in any case.
    EarlierPoints(std::shared_ptr<const CloudFile> file, const glm::dvec3& shift, std::uint64_t limit);

    /// Around all of a node's points, those of its leaves: with a margin for what samples round.
    const DistanceBox& box(std::uint32_t node) const { return boxes_[node]; }
    const CloudFile& file() const { return *file_; }

    /// A leaf's points. Errors: the file's.
    Expected<std::shared_ptr<const PointTree>> tree(std::uint32_t leaf) const;

  private:
    /// Of a leaf that was asked for. Who holds `building` makes the tree, without waiting for anything but the file.
    struct Slot {
        std::mutex building;
        std::shared_ptr<const PointTree> tree;
    };
    struct Kept {
        std::shared_ptr<Slot> slot;
        std::list<std::uint32_t>::iterator used;
        std::uint64_t bytes = 0;
    };

    std::shared_ptr<Slot> slotOf(std::uint32_t leaf) const;
    Expected<std::shared_ptr<const PointTree>> load(std::uint32_t leaf) const;
    void account(std::uint32_t leaf, const std::shared_ptr<Slot>& slot, std::uint64_t bytes) const;

    const std::shared_ptr<const CloudFile> file_;
    const ExactPlaces places_;
    const glm::dvec3 shift_;
    const std::uint64_t limit_;
    std::vector<DistanceBox> boxes_;

    mutable std::mutex mutex_;                 ///< of all below; held for moments
    mutable std::list<std::uint32_t> recent_;  ///< leaves, the last used first
    mutable std::unordered_map<std::uint32_t, Kept> kept_;
    mutable std::uint64_t bytes_ = 0;
};

/// The leaves by how far their boxes are from a box, nearest first, found as far as somebody asks. Used by one thread.
class LeavesByDistance {
  public:
    LeavesByDistance(const EarlierPoints& points, const DistanceBox& from);

    struct Found {
        std::uint32_t leaf;
        double squared;  ///< between the boxes
    };
    /// The next leaf whose squared distance is below that; nullopt: there is none.
    std::optional<Found> next(double below);

  private:
    void push(std::uint32_t node);

    const EarlierPoints& points_;
    const DistanceBox from_;
    std::vector<Found> heap_;  ///< nodes, the nearest on top
};

}  // namespace scancast
