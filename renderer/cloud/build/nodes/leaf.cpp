#include "renderer/cloud/build/nodes/leaf.hpp"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "renderer/cloud/build/nodes/spacing.hpp"

namespace scancast {

namespace {

bool wholeLess(const BuildPoint& a, const BuildPoint& b) {
    const auto key = [](const BuildPoint& p) {
        return std::tuple(p.position(), p.color, p.intensity, p.classification, p.normal);
    };
    return key(a) < key(b);
}

/// Morton keys of 48 bits for positions in a box: 15 bits an axis and, above them, the rank of the block of
/// 2^15 cells a side that the position lies in. A box no wider than a block touches two of them an axis, at
/// most.
class KeyMaker {
  public:
    explicit KeyMaker(const GridBox& box) {
        for (int a = 0; a < 3; ++a)
            while ((box.max[a] >> cellLevel_) - (box.min[a] >> cellLevel_) >= 1u << bits) ++cellLevel_;
        for (int a = 0; a < 3; ++a) firstBlock_[a] = box.min[a] >> cellLevel_ >> bits;
        std::array<unsigned, 8> order{0, 1, 2, 3, 4, 5, 6, 7};
        std::sort(order.begin(), order.end(),
                  [&](unsigned a, unsigned b) { return mortonLess(block(a), block(b)); });
        for (unsigned i = 0; i < 8; ++i) rank_[order[i]] = i;
    }

    /// Positions in one cell of 2^cellLevel steps have the same key.
    int cellLevel() const { return cellLevel_; }

    std::uint64_t key(const GridPosition& p) const {
        constexpr std::uint64_t within = (1u << bits) - 1;
        const GridPosition c{p[0] >> cellLevel_, p[1] >> cellLevel_, p[2] >> cellLevel_};
        unsigned which = 0;
        for (int a = 0; a < 3; ++a) which |= unsigned((c[a] >> bits) - firstBlock_[a]) << a;
        return rank_[which] << (3 * bits) | mortonKey(c[0] & within, c[1] & within, c[2] & within);
    }

  private:
    static constexpr int bits = 15;

    GridPosition block(unsigned which) const {
        return {firstBlock_[0] + (which & 1), firstBlock_[1] + (which >> 1 & 1),
                firstBlock_[2] + (which >> 2)};
    }

    int cellLevel_ = 0;
    GridPosition firstBlock_{};
    std::array<std::uint64_t, 8> rank_{};
};

/// Sorts numbers whose lowest 16 bits are in order already, and tell those apart that are equal above: a digit after the
/// other, from the lowest on.
void sortByKey(std::vector<std::uint64_t>& keys) {
    constexpr int digitBits = 8, lowest = 16;
    constexpr std::size_t digits = 6, values = std::size_t(1) << digitBits, few = 1024;
    if (keys.size() < few) return std::sort(keys.begin(), keys.end());
    const auto digitOf = [](std::uint64_t key, std::size_t d) {
        return std::size_t(key >> (lowest + digitBits * int(d))) & (values - 1);
    };
    std::array<std::array<std::uint32_t, values>, digits> counts{};
    for (const std::uint64_t key : keys)
        for (std::size_t d = 0; d < digits; ++d) ++counts[d][digitOf(key, d)];
    thread_local std::vector<std::uint64_t> other;
    other.resize(keys.size());
    for (std::size_t d = 0; d < digits; ++d) {
        auto& next = counts[d];
        if (next[digitOf(keys.front(), d)] == keys.size()) continue;  // all the same
        std::uint32_t before = 0;
        for (std::uint32_t& n : next) before += std::exchange(n, before);
        for (const std::uint64_t key : keys) other[next[digitOf(key, d)]++] = key;
        keys.swap(other);
    }
}

/// Returns the cell level down to which the points are in Morton order; within a cell of it, by their whole
/// content.
int sortPoints(std::span<BuildPoint> points, const GridBox& box) {
    if (box.isPoint()) {
        std::sort(points.begin(), points.end(), wholeLess);
        return 0;
    }
    const KeyMaker maker(box);
    thread_local std::vector<std::uint64_t> keys;
    thread_local std::vector<BuildPoint> copy;
    keys.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) keys[i] = maker.key(points[i].position()) << 16 | i;
    sortByKey(keys);
    copy.assign(points.begin(), points.end());
    std::size_t same = 0;
    for (std::size_t i = 0; i < keys.size(); ++i) {
        points[i] = copy[keys[i] & 65535];
        if (i + 1 < keys.size() && keys[i] >> 16 == keys[i + 1] >> 16) continue;
        if (i > same)
            std::sort(points.begin() + std::ptrdiff_t(same), points.begin() + std::ptrdiff_t(i + 1),
                      wholeLess);
        same = i + 1;
    }
    return maker.cellLevel();
}

Spacing spacingOf(std::span<const BuildPoint> points, const GridBox& box, const Grid& grid) {
    thread_local std::vector<glm::vec3> local;
    local.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        for (int a = 0; a < 3; ++a)
            local[i][a] = float(double(points[i].axis(a) - box.min[a]) * grid.step[a]);
    return estimateSpacing(local);
}

/// 0.05 of the spacing is what positions may be coarse by (docs/spec/hierarchy.md §5).
bool fineEnough(const LeafLattice& lattice, double spacing) {
    return lattice.exact || std::max({lattice.step.x, lattice.step.y, lattice.step.z}) <= 0.05 * spacing;
}

Sample toSample(const BuildPoint& p, const LeafLattice& lattice) {
    const auto q = lattice.quantise(p);
    return {.x = q[0],
            .y = q[1],
            .z = q[2],
            .intensity = p.intensity,
            .r = p.color[0],
            .g = p.color[1],
            .b = p.color[2],
            .classification = p.classification,
            .normal = p.normal,
            .logRadius = 0,
            .ellipse = 0};
}

}  // namespace

std::vector<Sample> leafSamples(std::span<const BuildPoint> points, const LeafLattice& lattice) {
    std::vector<Sample> samples(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) samples[i] = toSample(points[i], lattice);
    return samples;
}

bool isExact(const GridBox& box, const Grid& grid) {
    return leafLattice(box, grid, glm::dvec3(0)).exact;
}

std::optional<NodeContent> makeLeaf(std::span<BuildPoint> points, const GridBox& box, const Grid& grid,
                                    const glm::dvec3& origin) {
    const LeafLattice lattice = leafLattice(box, grid, origin);
    NodeContent leaf;
    leaf.corner = lattice.corner;
    leaf.step = lattice.step;
    leaf.cellLevel = sortPoints(points, box);
    const Spacing spacing = box.isPoint() ? Spacing{} : spacingOf(points, box, grid);
    leaf.spacing = spacing.closing;
    leaf.meanSpacing = spacing.mean;
    if (!box.isPoint() && !fineEnough(lattice, leaf.spacing)) return std::nullopt;
    leaf.samples = leafSamples(points, lattice);
    leaf.cells.addFirst();
    for (std::size_t i = 1; i < points.size(); ++i)
        leaf.cells.addStep(points[i - 1].position(), points[i].position());
    leaf.bounds = boundsOf(leaf.samples, leaf.corner, leaf.step, {});
    return leaf;
}

}  // namespace scancast
