#include "renderer/cloud/build/frame/frame_octree.hpp"

#include <tbb/parallel_for.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "renderer/cloud/surfel_codec.hpp"

namespace scancast {

namespace {

constexpr std::uint32_t leafMost = 16384;
/// An inner node's samples; of a surface, four cells make one of the next level.
constexpr std::uint32_t innerMost = 8192;
/// r by the pitch of a square grid: the average distance of the ten nearest of its points.
constexpr float radiusInPitches = 1.35F;
/// Of the pitches of a node's points: what closes nearly all of it.
constexpr double closingQuantile = 0.85;
constexpr double closingFactor = 1.3;
constexpr double latticeSteps = 65535;

/// A node before it has samples: a run of the order.
struct DraftNode {
    std::uint32_t begin = 0, end = 0;
    std::uint32_t parent = noNode, firstChild = noNode;
    std::uint8_t childCount = 0, level = 0;

    std::uint32_t points() const { return end - begin; }
};

/// What is drawn of a node.
struct FilledNode {
    glm::dvec3 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()}, step{1};
    double spacing = 0, meanSpacing = 0;
    std::vector<Sample> samples;
    std::uint64_t hash = 0;
};

/// A sample before it lies on its node's lattice.
struct LooseSample {
    glm::dvec3 position{0};  ///< cloud-relative
    Sample sample{};
    glm::vec3 normal{0};
    float radius = 0;
};

/// Of equal keys, which no cell tells apart, as many to each child.
std::vector<std::uint32_t> evenCuts(const DraftNode& node) {
    std::vector<std::uint32_t> cuts;
    const std::uint32_t parts = std::min(8U, (node.points() + leafMost - 1) / leafMost);
    for (std::uint32_t p = 1; p < parts; ++p)
        cuts.push_back(node.begin + std::uint32_t(std::uint64_t(node.points()) * p / parts));
    return cuts;
}

/// Where a node's run falls into those of its children.
std::vector<std::uint32_t> cutsOf(const DraftNode& node, const std::vector<std::uint64_t>& keys) {
    const int level = commonLevel(keys[node.begin], keys[node.end - 1]);
    if (level == 0) return evenCuts(node);
    const int shift = 3 * (level - 1);
    std::vector<std::uint32_t> cuts;
    for (std::uint32_t at = node.begin;;) {
        const std::uint64_t octant = keys[at] >> shift;
        const auto next = std::partition_point(keys.begin() + at, keys.begin() + node.end,
                                               [&](std::uint64_t key) { return key >> shift == octant; });
        at = std::uint32_t(next - keys.begin());
        if (at == node.end) return cuts;
        cuts.push_back(at);
    }
}

/// Breadth first: children stand side by side.
std::vector<DraftNode> draftTree(const FrameOrder& order) {
    std::vector<DraftNode> nodes{{.begin = 0, .end = std::uint32_t(order.size())}};
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i].points() <= leafMost) continue;
        auto cuts = cutsOf(nodes[i], order.keys);
        cuts.push_back(nodes[i].end);
        nodes[i].firstChild = std::uint32_t(nodes.size());
        nodes[i].childCount = std::uint8_t(cuts.size());
        std::uint32_t begin = nodes[i].begin;
        for (const std::uint32_t end : cuts) {
            nodes.push_back({.begin = begin, .end = end, .parent = i, .level = std::uint8_t(nodes[i].level + 1)});
            begin = end;
        }
    }
    return nodes;
}

class NodeFiller {
  public:
    explicit NodeFiller(const FrameOctreeInput& input) : in_(input) {}

    FilledNode fill(const DraftNode& draft) const {
        FilledNode node;
        std::vector<LooseSample> loose = draft.childCount == 0 ? points(draft, node) : averages(draft, node);
        place(loose, node);
        node.hash = XXH3_64bits(node.samples.data(), node.samples.size() * sizeof(Sample));
        return node;
    }

  private:
    /// Calls f(cell, begin, end) with every cell of the surface that has points of the run.
    template <class F>
    void forCells(std::uint32_t begin, std::uint32_t end, const F& f) const {
        for (std::size_t c = in_.surface.cellAt(begin); begin < end; ++c) {
            const std::uint32_t stop = std::min(in_.surface.cellBegin[c + 1], end);
            f(in_.surface.cells[c], begin, stop);
            begin = stop;
        }
    }

    LooseSample pointAt(std::uint32_t at, const CellSurface& surface) const {
        const PointBatch& points = in_.frame.points;
        const std::uint32_t p = in_.order.order[at];
        LooseSample loose{.position = points.position[p] - in_.origin};
        const auto color = points.color.empty() ? std::array<std::uint8_t, 3>{255, 255, 255} : points.color[p];
        loose.sample.r = color[0];
        loose.sample.g = color[1];
        loose.sample.b = color[2];
        if (!points.intensity.empty()) loose.sample.intensity = points.intensity[p];
        if (!points.classification.empty()) loose.sample.classification = points.classification[p];
        if (!points.normal.empty()) loose.normal = points.normal[p];
        if (in_.surfels && loose.normal == glm::vec3(0)) loose.normal = surface.normal;
        loose.radius = radiusInPitches * surface.spacing;
        return loose;
    }

    /// A leaf's.
    std::vector<LooseSample> points(const DraftNode& draft, FilledNode& node) const {
        std::vector<LooseSample> loose;
        std::vector<float> pitches;
        loose.reserve(draft.points());
        pitches.reserve(draft.points());
        double surface = 0;
        forCells(draft.begin, draft.end, [&](const CellSurface& cell, std::uint32_t begin, std::uint32_t end) {
            surface += double(cell.spacing) * double(cell.spacing) * (end - begin);
            pitches.insert(pitches.end(), end - begin, cell.spacing);
            for (std::uint32_t at = begin; at < end; ++at) loose.push_back(pointAt(at, cell));
        });
        const auto quantile = pitches.begin() + std::ptrdiff_t(closingQuantile * double(pitches.size() - 1));
        std::nth_element(pitches.begin(), quantile, pitches.end());
        node.meanSpacing = std::sqrt(surface / double(draft.points()));
        node.spacing = std::max(closingFactor * double(*quantile), node.meanSpacing);
        return loose;
    }

    /// An inner node's: of the finest cells that are not too many.
    std::vector<LooseSample> averages(const DraftNode& draft, FilledNode& node) const {
        const auto counts = in_.order.cellCounts(draft.begin, draft.end);
        int level = 0;
        while (level < FrameOrder::bits && counts[std::size_t(level)] > innerMost) ++level;
        std::vector<LooseSample> loose;
        loose.reserve(counts[std::size_t(level)]);
        const double size = in_.order.step * std::ldexp(1.0, level);
        double surface = 0;
        for (std::uint32_t begin = draft.begin; begin < draft.end;) {
            std::uint32_t end = begin + 1;
            while (end < draft.end && commonLevel(in_.order.keys[begin], in_.order.keys[end]) <= level) ++end;
            loose.push_back(average(begin, end, size, surface));
            begin = end;
        }
        node.meanSpacing = std::sqrt(surface / double(loose.size()));
        node.spacing = std::max({closingFactor * node.meanSpacing, size, node.meanSpacing});
        return loose;
    }

    /// Of the points of one cell; their share of the surface is added to `surface`.
    LooseSample average(std::uint32_t begin, std::uint32_t end, double size, double& surface) const {
        LooseSample mean;
        glm::dvec3 position(0);
        std::array<std::uint32_t, 3> color{};
        std::uint64_t intensity = 0;
        double pitch = 0;
        forCells(begin, end, [&](const CellSurface& cell, std::uint32_t first, std::uint32_t stop) {
            surface += double(cell.spacing) * double(cell.spacing) * (stop - first);
            pitch = std::max(pitch, double(cell.spacing));
            for (std::uint32_t at = first; at < stop; ++at) {
                const LooseSample one = pointAt(at, cell);
                if (at == begin) mean.sample = one.sample;
                position += one.position;
                color[0] += one.sample.r;
                color[1] += one.sample.g;
                color[2] += one.sample.b;
                intensity += one.sample.intensity;
                // Where the sides are arbitrary, all are turned to that of the first.
                const bool turned = !in_.oriented && glm::dot(mean.normal, one.normal) < 0;
                mean.normal += turned ? -one.normal : one.normal;
            }
        });
        const std::uint32_t n = end - begin;
        mean.position = position / double(n);
        mean.sample.r = std::uint8_t((color[0] + n / 2) / n);
        mean.sample.g = std::uint8_t((color[1] + n / 2) / n);
        mean.sample.b = std::uint8_t((color[2] + n / 2) / n);
        mean.sample.intensity = std::uint16_t((intensity + n / 2) / n);
        const float length = glm::length(mean.normal);
        mean.normal = length > 1e-3F ? mean.normal / length : glm::vec3(0);
        mean.radius = radiusInPitches * float(std::max(pitch, size));
        return mean;
    }

    /// On the lattice of the node's own box, in the bytes that devices draw.
    void place(std::vector<LooseSample>& loose, FilledNode& node) const {
        for (const LooseSample& s : loose) {
            node.low = glm::min(node.low, s.position);
            node.high = glm::max(node.high, s.position);
        }
        const glm::dvec3 size = node.high - node.low;
        for (int a = 0; a < 3; ++a) node.step[a] = std::max(size[a], 1e-6 * in_.order.step) / latticeSteps;
        node.samples.reserve(loose.size());
        for (const LooseSample& s : loose) {
            Sample& sample = node.samples.emplace_back(s.sample);
            const glm::dvec3 at = (s.position - node.low) / node.step + 0.5;
            sample.x = std::uint16_t(std::min(at.x, latticeSteps));
            sample.y = std::uint16_t(std::min(at.y, latticeSteps));
            sample.z = std::uint16_t(std::min(at.z, latticeSteps));
            if (in_.surfels)
                encodeSurfel({.normal = s.normal, .radius = s.radius}, float(node.spacing), sample);
            else if (s.normal != glm::vec3(0))
                sample.normal = encodeNormal(s.normal);
        }
    }

    const FrameOctreeInput& in_;
};

/// Bounds of a node's own samples, which what is below it grows.
Node nodeOf(const DraftNode& draft, const FilledNode& filled, bool oriented) {
    Node node{};
    node.boxMin = filled.low;
    node.step = filled.step;
    node.boxMax = filled.low + filled.step * latticeSteps;
    node.radiusUnit = float(filled.spacing);
    node.spacing = float(filled.spacing);
    node.meanSpacing = float(filled.meanSpacing);
    node.parent = draft.parent;
    node.firstChild = draft.firstChild;
    node.childCount = draft.childCount;
    node.level = draft.level;
    node.confidence = oriented ? certainSide : 0;
    node.sampleCount = std::uint32_t(filled.samples.size());
    node.points = draft.points();
    return node;
}

/// From the leaves up, what is below a node is inside of its bounds; from the root down, no node claims to be coarser
/// than its parent.
void settleNodes(std::vector<StoredNode>& nodes) {
    std::vector<glm::dvec3> low;
    for (const StoredNode& n : nodes) low.push_back(n.node.boxMin);
    for (std::size_t i = nodes.size(); i-- > 0;) {
        Node& node = nodes[i].node;
        for (std::uint32_t c = 0; c < node.childCount; ++c) {
            low[i] = glm::min(low[i], low[node.firstChild + c]);
            node.boxMax = glm::max(node.boxMax, nodes[node.firstChild + c].node.boxMax);
        }
        node.center = (low[i] + node.boxMax) * 0.5;
        node.radius = glm::length(node.boxMax - node.center);
    }
    for (StoredNode& stored : nodes) {
        Node& node = stored.node;
        if (node.parent == noNode) continue;
        const Node& parent = nodes[node.parent].node;
        node.spacing = std::min(node.spacing, parent.spacing);
        node.meanSpacing = std::min({node.meanSpacing, parent.meanSpacing, node.spacing});
    }
}

}  // namespace

BuiltOctree buildFrameOctree(const FrameOctreeInput& input) {
    const std::vector<DraftNode> drafts = draftTree(input.order);
    std::vector<FilledNode> filled(drafts.size());
    const NodeFiller filler(input);
    tbb::parallel_for(std::size_t(0), drafts.size(), [&](std::size_t i) { filled[i] = filler.fill(drafts[i]); });

    BuiltOctree octree;
    std::uint64_t samples = 0;
    for (std::size_t i = 0; i < drafts.size(); ++i) {
        Node& node = octree.nodes.emplace_back(StoredNode{nodeOf(drafts[i], filled[i], input.oriented), {}}).node;
        node.firstSample = samples;
        samples += node.sampleCount;
        octree.sampleHashes.push_back(filled[i].hash);
    }
    settleNodes(octree.nodes);
    octree.samples.resize(samples);
    tbb::parallel_for(std::size_t(0), drafts.size(), [&](std::size_t i) {
        std::copy(filled[i].samples.begin(), filled[i].samples.end(),
                  octree.samples.begin() + std::ptrdiff_t(octree.nodes[i].node.firstSample));
    });
    return octree;
}

}  // namespace scancast
