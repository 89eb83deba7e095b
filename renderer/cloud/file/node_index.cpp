#include "renderer/cloud/file/node_index.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "renderer/cloud/file/blocks/byte_planes.hpp"
#include "renderer/cloud/file/file_layout.hpp"

namespace scancast {

namespace {

constexpr int mostChildren = 8;

bool finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool positive(double value) {
    return value > 0 && std::isfinite(value);
}

/// What is wrong with the node's shape; nullptr = nothing.
const char* wrongShape(const Node& n) {
    if (!finite(n.boxMin) || !finite(n.boxMax) || !finite(n.center)) return "its box or sphere is not finite";
    for (int a = 0; a < 3; ++a) {
        if (!(n.boxMin[a] <= n.boxMax[a])) return "its box is inside out";
        if (!positive(n.step[a])) return "its quantisation step is not positive";
        if (!std::isfinite(n.boxMin[a] + 65535 * n.step[a])) return "its quantisation step is too large";
    }
    if (!(n.radius >= 0 && std::isfinite(n.radius))) return "its sphere has no proper radius";
    if (!positive(n.spacing) || !positive(n.meanSpacing) || !positive(n.radiusUnit))
        return "its spacing is not positive";
    if (n.meanSpacing > n.spacing) return "its mean spacing is larger than its spacing";
    for (int a = 0; a < 3; ++a)
        if (!std::isfinite(n.cone.axis[a])) return "its normal cone is not finite";
    if (!(n.cone.halfAngle >= 0 && std::isfinite(n.cone.halfAngle)))
        return "its normal cone has no proper angle";
    return nullptr;
}

/// Walks over the nodes in their order and keeps what the next one must continue.
class Checker {
  public:
    Checker(std::span<const StoredNode> nodes, const CloudFacts& facts, std::uint64_t indexOffset)
        : nodes_(nodes), points_(facts.points), indexOffset_(indexOffset) {}

    Expected<void> run() {
        for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
            const char* wrong = wrongShape(nodes_[i].node);
            if (!wrong) wrong = wrongPlaceInTree(i);
            if (!wrong) wrong = wrongSamples(nodes_[i]);
            if (wrong) return fail(ErrorCode::Malformed, fmt::format("node {} of the index: {}", i, wrong));
        }
        if (nextChild_ != nodes_.size())
            return fail(ErrorCode::Malformed, fmt::format("node {} of the index has no parent", nextChild_));
        return {};
    }

  private:
    const char* wrongPlaceInTree(std::uint32_t i) {
        const Node& n = nodes_[i].node;
        if (i == 0 && (n.parent != noNode || n.level != 0)) return "the root has a parent or a level";
        if (i == 0 && n.points != points_) return "the root has another number of points than the cloud";
        if (n.points == 0 || n.sampleCount == 0) return "it has no points or no samples";
        if (n.firstSample != nextSample_) return "its samples do not follow those of the node before";
        nextSample_ += n.sampleCount;
        if (n.isLeaf()) {
            if (n.firstChild != noNode) return "it has no children, but a first one";
            return n.sampleCount == n.points ? nullptr
                                             : "it is a leaf, but has not one sample for each point";
        }
        if (n.childCount > mostChildren) return "it has more than 8 children";
        if (n.firstChild != nextChild_ || n.firstChild <= i)
            return "its children do not follow those of the node before";
        if (n.childCount > nodes_.size() - nextChild_) return "its children are outside the index";
        nextChild_ += n.childCount;
        return wrongChildren(i);
    }

    const char* wrongChildren(std::uint32_t i) const {
        const Node& n = nodes_[i].node;
        std::uint64_t left = n.points;
        for (const StoredNode& stored : nodes_.subspan(n.firstChild, n.childCount)) {
            const Node& child = stored.node;
            if (child.parent != i) return "a child of it has another parent";
            if (child.level != n.level + 1) return "a child of it is not one level below";
            // A spacing that is no number is the child's own fault, found when it is its turn.
            if (child.spacing > n.spacing || child.meanSpacing > n.meanSpacing)
                return "a child of it has a larger spacing";
            if (child.points > left) return "its children have more points than it";
            left -= child.points;
        }
        return left == 0 ? nullptr : "its children have fewer points than it";
    }

    const char* wrongSamples(const StoredNode& n) const {
        return wrongBlock(n.samples, n.node.sampleCount * std::uint64_t(sizeof(Sample)), indexOffset_);
    }

    const std::span<const StoredNode> nodes_;
    const std::uint64_t points_, indexOffset_;
    std::uint64_t nextSample_ = 0;
    std::uint32_t nextChild_ = 1;
};

}  // namespace

const char* wrongBlock(const BlockPlace& place, std::uint64_t decodedBytes, std::uint64_t indexOffset) {
    if (decodedBytes == 0) return place == BlockPlace{} ? nullptr : "it has a block of nothing";
    if (place.bytes == 0) return "a block is missing";
    if (place.offset < cloudHeaderBytes || place.offset > indexOffset ||
        place.bytes > indexOffset - place.offset)
        return "a block lies outside the part of the file where blocks are";
    if (decodedBytes / largestExpansion > place.bytes) return "a block is too small for what it should hold";
    return nullptr;
}

Expected<void> checkNodes(std::span<const StoredNode> nodes, const CloudFacts& facts,
                          std::uint64_t indexOffset) {
    return Checker(nodes, facts, indexOffset).run();
}

}  // namespace scancast
