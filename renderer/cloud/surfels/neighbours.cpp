#include "renderer/cloud/surfels/neighbours.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "renderer/cloud/surfels/spatial_sort.hpp"

namespace scancast {

using surfel::BoxBlock;

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

BoxBlock emptyBlock() {
    BoxBlock b;
    for (int a = 0; a < 3; ++a)
        for (int i = 0; i < surfel::blockBoxes; ++i) {
            b.low[a][i] = infinity;
            b.high[a][i] = -infinity;
        }
    return b;
}

std::size_t blocksFor(std::size_t boxes) {
    return (boxes + surfel::blockBoxes - 1) / surfel::blockBoxes;
}

template <class F>
void inParallel(std::size_t count, std::size_t grain, const F& f) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i != range.end(); ++i) f(i);
                      });
}

}  // namespace

NeighbourIndex::NeighbourIndex(std::span<const glm::vec3> points) {
    if (points.empty()) return;
    SpatialOrder sorted = spatialOrder(points);
    order_ = std::move(sorted.order);
    firstOf_ = std::move(sorted.firstOf);
    leafBegin_ = std::move(sorted.leafBegin);
    groupBegin_ = std::move(sorted.groupBegin);
    fill(points);
    makeBoxes();
}

void NeighbourIndex::fill(std::span<const glm::vec3> points) {
    const std::size_t n = firstOf_.size() - 1;
    x_.resize(n);
    y_.resize(n);
    z_.resize(n);
    inParallel(n, 4096, [&](std::size_t i) {
        const glm::vec3 p = points[order_[firstOf_[i]]] + glm::vec3(0);  // -0 becomes 0
        x_[i] = p.x;
        y_[i] = p.y;
        z_[i] = p.z;
    });
    view_.x = x_.data();
    view_.y = y_.data();
    view_.z = z_.data();
    view_.points = std::uint32_t(n);
    view_.leafBegin = leafBegin_.data();
}

void NeighbourIndex::makeBoxes() {
    std::size_t boxes = leafBegin_.size() - 1, total = 0;
    for (std::size_t b = boxes;; b = blocksFor(b)) {
        view_.levelBegin[view_.levels++] = std::uint32_t(total);
        total += blocksFor(b);
        if (blocksFor(b) == 1) break;
    }
    blocks_.assign(total, emptyBlock());
    view_.blocks = blocks_.data();
    inParallel(boxes, 1024, [&](std::size_t leaf) {
        BoxBlock& block = blocks_[leaf / surfel::blockBoxes];
        const std::size_t at = leaf % surfel::blockBoxes;
        for (std::uint32_t p = leafBegin_[leaf]; p < leafBegin_[leaf + 1]; ++p) {
            const glm::vec3 here = position(p);
            for (int a = 0; a < 3; ++a) {
                block.low[a][at] = std::min(block.low[a][at], here[a]);
                block.high[a][at] = std::max(block.high[a][at], here[a]);
            }
        }
    });
    for (int level = 1; level < view_.levels; ++level) {
        boxes = blocksFor(boxes);
        inParallel(boxes, 1024, [&](std::size_t box) {
            const BoxBlock& below = blocks_[view_.levelBegin[level - 1] + box];
            BoxBlock& block = blocks_[view_.levelBegin[level] + box / surfel::blockBoxes];
            for (int a = 0; a < 3; ++a) {
                block.low[a][box % surfel::blockBoxes] =
                    *std::min_element(below.low[a], below.low[a] + surfel::blockBoxes);
                block.high[a][box % surfel::blockBoxes] =
                    *std::max_element(below.high[a], below.high[a] + surfel::blockBoxes);
            }
        });
    }
}

}  // namespace scancast
