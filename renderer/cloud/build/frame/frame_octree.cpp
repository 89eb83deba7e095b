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

    void grow(const glm::dvec3& position) {
        low = glm::min(low, position);
        high = glm::max(high, position);
    }
    /// Over all that grow() was told.
    void chooseLattice(double cell) {
        // Without an extent any step will do: all samples are at 0.
        for (int a = 0; a < 3; ++a) step[a] = (high[a] > low[a] ? high[a] - low[a] : cell) / latticeSteps;
        perStep_ = 1.0 / step;
    }
    void place(const glm::dvec3& position, Sample& sample) const {
        const glm::dvec3 at = glm::min((position - low) * perStep_ + 0.5, glm::dvec3(latticeSteps));
        sample.x = std::uint16_t(at.x);
        sample.y = std::uint16_t(at.y);
        sample.z = std::uint16_t(at.z);
    }

  private:
    glm::dvec3 perStep_{1};
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
            nodes.push_back(
                {.begin = begin, .end = end, .parent = i, .level = std::uint8_t(nodes[i].level + 1)});
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
        if (draft.childCount == 0)
            fillLeaf(draft, node);
        else
            fillInner(draft, node);
        node.hash = XXH3_64bits(node.samples.data(), node.samples.size() * sizeof(Sample));
        return node;
    }

  private:
    /// A part of a cell's surface.
    static double areaOf(const CellSurface& cell, std::uint32_t points) {
        return double(cell.spacing) * double(cell.spacing) * points;
    }

    /// Calls f(cell, begin, end) with every cell of the surface that has points of the run.
    template <class F>
    void forCells(std::uint32_t begin, std::uint32_t end, const F& f) const {
        for (std::size_t c = in_.surface.cellAt(begin); begin < end; ++c) {
            const std::uint32_t stop = std::min(in_.surface.cellBegin[c + 1], end);
            f(in_.surface.cells[c], begin, stop);
            begin = stop;
        }
    }

    /// Its points as they are.
    void fillLeaf(const DraftNode& draft, FilledNode& node) const {
        double area = 0;
        std::vector<std::pair<float, std::uint32_t>> pitches;
        forCells(draft.begin, draft.end,
                 [&](const CellSurface& cell, std::uint32_t begin, std::uint32_t end) {
                     area += areaOf(cell, end - begin);
                     pitches.emplace_back(cell.spacing, end - begin);
                 });
        node.meanSpacing = std::sqrt(area / double(draft.points()));
        node.spacing = std::max(closingFactor * closingPitch(pitches, draft.points()), node.meanSpacing);
        for (std::uint32_t at = draft.begin; at < draft.end; ++at) node.grow(in_.order.points[at].position);
        node.chooseLattice(in_.order.step);
        node.samples.reserve(draft.points());
        forCells(draft.begin, draft.end,
                 [&](const CellSurface& cell, std::uint32_t begin, std::uint32_t end) {
                     Sample like{};
                     if (in_.surfels)
                         encodeSurfel({.normal = cell.normal, .radius = radiusInPitches * cell.spacing},
                                      float(node.spacing), like);
                     for (std::uint32_t at = begin; at < end; ++at)
                         addPoint(in_.order.points[at], like, node);
                 });
    }

    /// The pitch that so large a share of the points do not exceed.
    static double closingPitch(std::vector<std::pair<float, std::uint32_t>>& pitches, std::uint32_t points) {
        std::sort(pitches.begin(), pitches.end());
        double below = 0;
        for (const auto& [pitch, count] : pitches) {
            below += count;
            if (below >= closingQuantile * points) return double(pitch);
        }
        return 0;
    }

    static void addPoint(const FramePoint& point, const Sample& like, FilledNode& node) {
        Sample& sample = node.samples.emplace_back(like);
        node.place(point.position, sample);
        sample.r = point.color[0];
        sample.g = point.color[1];
        sample.b = point.color[2];
        sample.intensity = point.intensity;
        sample.classification = point.classification;
        if (point.normal != noNormal) sample.normal = point.normal;
    }

    /// What is left of the points of one cell.
    struct Mean {
        glm::dvec3 position{0};
        std::array<std::uint64_t, 3> color{};
        std::uint64_t intensity = 0;
        glm::vec3 normal{0};
        std::uint8_t classification = 0;  ///< the first point's
        float pitch = 0;                  ///< the largest
        std::uint32_t points = 0;
    };

    /// Averages over the finest cells that are not too many, in the box of all that is below.
    void fillInner(const DraftNode& draft, FilledNode& node) const {
        for (std::uint32_t at = draft.begin; at < draft.end; ++at) node.grow(in_.order.points[at].position);
        const auto counts = in_.order.cellCounts(draft.begin, draft.end);
        int level = 0;
        while (level < FrameOrder::bits && counts[std::size_t(level)] > innerMost) ++level;
        const double size = in_.order.step * std::ldexp(1.0, level);
        std::vector<Mean> means;
        means.reserve(counts[std::size_t(level)]);
        double area = 0;
        const auto& keys = in_.order.keys;
        for (std::uint32_t begin = draft.begin, end = begin; begin < draft.end; begin = end) {
            while (end < draft.end && keys[end] >> (3 * level) == keys[begin] >> (3 * level)) ++end;
            means.push_back(meanOf(begin, end, area));
        }
        node.meanSpacing = std::sqrt(area / double(means.size()));
        node.spacing = std::max(closingFactor * node.meanSpacing, size);
        node.chooseLattice(in_.order.step);
        node.samples.reserve(means.size());
        for (const Mean& mean : means) addMean(mean, size, node);
    }

    Mean meanOf(std::uint32_t begin, std::uint32_t end, double& area) const {
        Mean mean{.classification = in_.order.points[begin].classification, .points = end - begin};
        // Where the sides are arbitrary, all are turned to that of the first.
        const auto addNormal = [&](const glm::vec3& normal, float weight) {
            const bool isTurned = !in_.oriented && glm::dot(mean.normal, normal) < 0;
            mean.normal += (isTurned ? -weight : weight) * normal;
        };
        forCells(begin, end, [&](const CellSurface& cell, std::uint32_t first, std::uint32_t stop) {
            area += areaOf(cell, stop - first);
            mean.pitch = std::max(mean.pitch, cell.spacing);
            std::uint32_t estimated = 0;
            for (std::uint32_t at = first; at < stop; ++at) {
                const FramePoint& point = in_.order.points[at];
                mean.position += point.position;
                for (std::size_t c = 0; c < 3; ++c) mean.color[c] += point.color[c];
                mean.intensity += point.intensity;
                if (point.normal != noNormal)
                    addNormal(decodeNormal(point.normal), 1);
                else
                    ++estimated;
            }
            if (in_.surfels && estimated > 0) addNormal(cell.normal, float(estimated));
        });
        mean.position /= double(mean.points);
        return mean;
    }

    void addMean(const Mean& mean, double size, FilledNode& node) const {
        Sample& sample = node.samples.emplace_back();
        node.place(mean.position, sample);
        const auto rounded = [&](std::uint64_t sum) { return (sum + mean.points / 2) / mean.points; };
        sample.r = std::uint8_t(rounded(mean.color[0]));
        sample.g = std::uint8_t(rounded(mean.color[1]));
        sample.b = std::uint8_t(rounded(mean.color[2]));
        sample.intensity = std::uint16_t(rounded(mean.intensity));
        sample.classification = mean.classification;
        const float length = glm::length(mean.normal);
        const glm::vec3 normal = length > 1e-3F ? mean.normal / length : glm::vec3(0);
        const float radius = radiusInPitches * std::max(mean.pitch, float(size));
        if (in_.surfels)
            encodeSurfel({.normal = normal, .radius = radius}, float(node.spacing), sample);
        else if (normal != glm::vec3(0))
            sample.normal = encodeNormal(normal);
    }

    const FrameOctreeInput& in_;
};

/// Bounds of a node's own samples, which what is below it grows.
Node nodeOf(const DraftNode& draft, const FilledNode& filled, bool oriented) {
    Node node{};
    node.boxMin = filled.low;
    node.step = filled.step;
    for (int a = 0; a < 3; ++a)
        node.boxMax[a] = filled.low[a] + (filled.high[a] > filled.low[a] ? filled.step[a] * latticeSteps : 0);
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

/// From the leaves up, boxes hold what is below them; from the root down, no node claims to be coarser than its parent.
void settleNodes(std::vector<StoredNode>& nodes) {
    for (std::size_t i = nodes.size(); i-- > 0;) {
        Node& node = nodes[i].node;
        // Lattices of their own round differently: the children's boxes are the truth.
        for (std::uint32_t c = 0; c < node.childCount; ++c) {
            const glm::dvec3& high = nodes[node.firstChild + c].node.boxMax;
            node.boxMax = c == 0 ? high : glm::max(node.boxMax, high);
        }
        node.center = (node.boxMin + node.boxMax) * 0.5;
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
    tbb::parallel_for(std::size_t(0), drafts.size(),
                      [&](std::size_t i) { filled[i] = filler.fill(drafts[i]); });

    BuiltOctree octree;
    std::uint64_t samples = 0;
    for (std::size_t i = 0; i < drafts.size(); ++i) {
        Node& node =
            octree.nodes.emplace_back(StoredNode{nodeOf(drafts[i], filled[i], input.oriented), {}}).node;
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
