#include "tests/ground_truth/box_tree.hpp"

#include <numeric>

namespace scancast {
namespace {

constexpr std::uint32_t leafItems = 4;
constexpr int bins = 12;
constexpr int deepest = 60;  ///< beyond it everything goes into one leaf, so that walks need a bounded stack

}  // namespace

BoxTree BoxTree::build(std::span<const Box> boxes) {
    BoxTree tree;
    if (boxes.empty()) return tree;
    tree.items_.resize(boxes.size());
    std::iota(tree.items_.begin(), tree.items_.end(), 0U);
    tree.nodes_.reserve(boxes.size());
    tree.split(boxes, 0, std::uint32_t(boxes.size()), 0);
    return tree;
}

void BoxTree::split(std::span<const Box> boxes, std::uint32_t from, std::uint32_t to, int depth) {
    const std::size_t self = nodes_.size();
    nodes_.emplace_back();
    Box whole, centers;
    const auto centerOf = [&](std::uint32_t item) { return (boxes[item].low + boxes[item].high) * 0.5; };
    for (std::uint32_t i = from; i < to; ++i) {
        whole.include(boxes[items_[i]]);
        centers.include({centerOf(items_[i]), centerOf(items_[i])});
    }
    nodes_[self].box = whole;
    const glm::dvec3 spread = centers.high - centers.low;
    const int axis = spread.x >= spread.y && spread.x >= spread.z ? 0 : spread.y >= spread.z ? 1 : 2;
    const auto leaf = [&] {
        nodes_[self].first = from;
        nodes_[self].count = to - from;
    };
    if (to - from <= leafItems || depth == deepest || !(spread[axis] > 0)) return leaf();

    const auto binOf = [&](std::uint32_t item) {
        return std::min(bins - 1, int((centerOf(item)[axis] - centers.low[axis]) / spread[axis] * bins));
    };
    std::array<Box, bins> inBin;
    std::array<std::uint32_t, bins> count{};
    for (std::uint32_t i = from; i < to; ++i) {
        const auto bin = std::size_t(binOf(items_[i]));
        inBin[bin].include(boxes[items_[i]]);
        ++count[bin];
    }
    // Cost of cutting behind each bin: area × number, on both sides.
    std::array<double, bins> cost{};
    for (int side = 0; side < 2; ++side) {
        Box sum;
        std::uint32_t items = 0;
        for (std::size_t k = 0; k + 1 < std::size_t(bins); ++k) {
            const std::size_t bin = side == 0 ? k : bins - 1 - k;
            sum.include(inBin[bin]);
            items += count[bin];
            cost[side == 0 ? bin : bin - 1] += items > 0 ? sum.halfArea() * items : 0;
        }
    }
    const auto best = int(std::min_element(cost.begin(), cost.end() - 1) - cost.begin());
    const auto middle = std::stable_partition(items_.begin() + from, items_.begin() + to,
                                              [&](std::uint32_t item) { return binOf(item) <= best; });
    const auto cut = std::uint32_t(middle - items_.begin());
    if (cut == from || cut == to) return leaf();
    split(boxes, from, cut, depth + 1);
    nodes_[self].first = std::uint32_t(nodes_.size());
    split(boxes, cut, to, depth + 1);
}

}  // namespace scancast
