#include "renderer/cloud/distance/earlier_points.hpp"

#include <algorithm>

#include "renderer/cloud/export/cloud_points.hpp"

namespace scancast {

namespace {

/// Sums of three doubles, each rounded.
constexpr double roundingMargin = 1e-14;

bool isFarther(const LeavesByDistance::Found& a, const LeavesByDistance::Found& b) {
    return a.squared != b.squared ? a.squared > b.squared : a.leaf > b.leaf;
}

}  // namespace

EarlierPoints::EarlierPoints(std::shared_ptr<const CloudFile> file, const glm::dvec3& shift,
                             std::uint64_t limit)
    : file_(std::move(file)), places_(file_->facts(), file_.get()), shift_(shift), limit_(limit) {
    const auto nodes = file_->nodes();
    boxes_.resize(nodes.size());
    // Children stand behind their parents. What inner nodes say of themselves is finer than what leaves round to.
    for (std::size_t i = nodes.size(); i-- > 0;) {
        const Node& node = nodes[i].node;
        for (std::uint32_t c = 0; c < node.childCount; ++c) boxes_[i].add(boxes_[node.firstChild + c]);
        if (!node.isLeaf()) continue;
        const auto reach = reachOf(*file_, node);
        const glm::dvec3 margin =
            roundingMargin * (glm::abs(reach[0]) + glm::abs(reach[1]) + glm::abs(shift_));
        boxes_[i] = {reach[0] + shift_ - margin, reach[1] + shift_ + margin};
    }
}

std::shared_ptr<EarlierPoints::Slot> EarlierPoints::slotOf(std::uint32_t leaf) const {
    const std::lock_guard lock(mutex_);
    const auto found = kept_.find(leaf);
    if (found != kept_.end()) {
        recent_.splice(recent_.begin(), recent_, found->second.used);
        return found->second.slot;
    }
    auto slot = std::make_shared<Slot>();
    recent_.push_front(leaf);
    kept_.emplace(leaf, Kept{.slot = slot, .used = recent_.begin()});
    return slot;
}

void EarlierPoints::account(std::uint32_t leaf, const std::shared_ptr<Slot>& slot,
                            std::uint64_t bytes) const {
    const std::lock_guard lock(mutex_);
    const auto found = kept_.find(leaf);
    // Pushed out while it was made: nobody keeps it but who uses it.
    if (found == kept_.end() || found->second.slot != slot) return;
    found->second.bytes = bytes;
    bytes_ += bytes;
    while (bytes_ > limit_ && recent_.size() > 1) {
        const auto last = kept_.find(recent_.back());
        bytes_ -= last->second.bytes;
        kept_.erase(last);
        recent_.pop_back();
    }
}

Expected<std::shared_ptr<const PointTree>> EarlierPoints::tree(std::uint32_t leaf) const {
    const auto slot = slotOf(leaf);
    const std::lock_guard lock(slot->building);
    if (slot->tree) return slot->tree;
    auto made = load(leaf);
    if (!made) return passOn(made);
    slot->tree = *made;
    account(leaf, slot, (*made)->bytes());
    return made;
}

Expected<std::shared_ptr<const PointTree>> EarlierPoints::load(std::uint32_t leaf) const {
    const auto samples = file_->samples(leaf);
    if (!samples) return passOn(samples);
    std::vector<glm::dvec3> places(samples->size());
    if (auto ok = places_.of(leaf, file_->nodes()[leaf].node, *samples, places); !ok) return passOn(ok);
    for (glm::dvec3& place : places) place += shift_;
    return std::make_shared<const PointTree>(places);
}

LeavesByDistance::LeavesByDistance(const EarlierPoints& points, const DistanceBox& from)
    : points_(points), from_(from) {
    push(0);
}

void LeavesByDistance::push(std::uint32_t node) {
    heap_.push_back({node, points_.box(node).squaredTo(from_)});
    std::ranges::push_heap(heap_, isFarther);
}

std::optional<LeavesByDistance::Found> LeavesByDistance::next(double below) {
    while (!heap_.empty() && heap_.front().squared < below) {
        const Found nearest = heap_.front();
        std::ranges::pop_heap(heap_, isFarther);
        heap_.pop_back();
        const Node& node = points_.file().nodes()[nearest.leaf].node;
        if (node.isLeaf()) return nearest;
        for (std::uint32_t c = 0; c < node.childCount; ++c) push(node.firstChild + c);
    }
    return std::nullopt;
}

}  // namespace scancast
