#include "renderer/cloud/build/finish.hpp"

#include <tbb/parallel_for.h>
#include <xxhash.h>

#include <algorithm>
#include <limits>

#include "renderer/cloud/build/nodes/inner_surfels.hpp"
#include "renderer/cloud/curvature.hpp"
#include "renderer/cloud/file/blocks/block_codec.hpp"
#include "renderer/cloud/normal_cone.hpp"
#include "renderer/cloud/surfel_bytes.hpp"

namespace scancast {

namespace {

/// Inner nodes worked on at once, before what they give is written in order.
constexpr std::size_t window = 64;

/// A node never claims to be coarser than its parent: what is drawn below a node stays within the bounds that
/// its own spacing grew. A node that knows no spacing (all its points at one place) takes its parent's.
float settleSpacing(double own, const Node* parent, float Node::*spacing, const Grid& grid) {
    const float largest = parent ? parent->*spacing : std::numeric_limits<float>::max();
    if (own > 0) return std::clamp(float(own), std::numeric_limits<float>::min(), largest);
    if (parent) return largest;
    double step = 0;
    for (int a = 0; a < 3; ++a)
        step = std::max(step, grid.step[a] * double(std::uint64_t(1) << grid.ownShift[a]));
    return std::max(float(step), std::numeric_limits<float>::min());
}

Node toNode(const BuildNode& from, const Node* parent, const OctreeInput& input) {
    Node node{};
    const NodeContent& c = from.content;
    node.boxMin = c.corner;
    node.step = c.step;
    node.boxMax = c.bounds.high;
    node.center = c.bounds.center;
    node.radius = c.bounds.radius;
    node.spacing = settleSpacing(c.spacing, parent, &Node::spacing, input.grid);
    node.meanSpacing =
        std::min(node.spacing, settleSpacing(c.meanSpacing, parent, &Node::meanSpacing, input.grid));
    node.radiusUnit = radiusUnit(c.spacing);
    node.cone = c.cone;
    node.childCount = std::uint8_t(from.children.size());
    node.level = std::uint8_t(from.level);
    node.confidence = from.confidence;
    node.sampleCount = from.stored.node.sampleCount;
    node.points = from.pointCount;
    return node;
}

/// The tree's nodes, breadth first, and what they were built as.
struct Numbered {
    std::vector<BuildNode*> order;
    std::vector<StoredNode> nodes;
};

Numbered number(BuildNode& root, const OctreeInput& input) {
    Numbered n{.order = {&root},
               .nodes = {{.node = toNode(root, nullptr, input), .samples = root.stored.samples}}};
    std::uint64_t samples = n.nodes[0].node.sampleCount;
    for (std::uint32_t i = 0; i < n.order.size(); ++i) {
        if (!n.order[i]->isLeaf()) n.nodes[i].node.firstChild = std::uint32_t(n.nodes.size());
        for (const auto& child : n.order[i]->children) {
            Node node = toNode(*child, &n.nodes[i].node, input);
            node.parent = i;
            node.firstSample = samples;
            samples += node.sampleCount;
            n.nodes.push_back({node, child->stored.samples});
            n.order.push_back(child.get());
        }
    }
    return n;
}

/// Of all nodes in turn; inner ones have no columns.
std::vector<BlockPlace> planePlaces(std::span<BuildNode* const> order, const OctreeInput& input) {
    const std::size_t planes = planesOf(input);
    std::vector<BlockPlace> places(order.size() * planes);
    for (std::size_t i = 0; i < order.size(); ++i) {
        std::copy(order[i]->columns.begin(), order[i]->columns.end(),
                  places.begin() + std::ptrdiff_t(i * planes));
        std::copy(order[i]->positions.begin(), order[i]->positions.end(),
                  places.begin() + std::ptrdiff_t(i * planes + input.columns.size()));
        auto last = places.begin() + std::ptrdiff_t((i + 1) * planes);
        if (input.nearInfrared) *--last = order[i]->beside.nearInfrared;
        if (input.shape.curvatures()) *--last = order[i]->beside.curvature;
    }
    return places;
}

/// Mean curvatures of a node's samples, as `radiusUnit` says what codes count from.
void addMeans(std::span<const BesideWord> curvatures, float unit, ValueSketch& sketch) {
    const auto& steps = curvatureSteps();
    for (const BesideWord code : curvatures)
        sketch.add(0.5 * (double(steps[code & 255]) + double(steps[code >> 8 & 255])) / unit);
}

/// One of the values in the words, as a plane's block.
template <class Value, class Take>
std::vector<std::byte> encodePart(std::span<const BesideWord> beside, Take take) {
    std::vector<Value> values(beside.size());
    std::ranges::transform(beside, values.begin(), take);
    if (std::ranges::all_of(values, [](Value value) { return value == 0; })) return {};
    return encodeRows(std::as_bytes(std::span(values)), sizeof(Value));
}

class Finisher {
  public:
    Finisher(const BuildNode& root, const OctreeInput& input, BlockSink* file, ValueSketch& means)
        : root_(root), input_(input), file_(file), means_(means) {}

    struct Inner {
        BuildNode* node = nullptr;
        std::vector<Sample> samples;
        std::vector<BesideWord> beside;
        std::vector<std::byte> block;
        BesideBlocks besideBlocks;
        Expected<void> result;
    };

    /// A window of nodes at once, in parallel.
    Expected<void> finish(std::span<BuildNode* const> inner, const ProgressSink& sink,
                          const std::stop_token& stop) {
        ProgressMeter progress(sink, "finishing", inner.size(), "nodes");
        for (std::size_t first = 0; first < inner.size(); first += window) {
            std::vector<Inner> work(std::min(window, inner.size() - first));
            for (std::size_t i = 0; i < work.size(); ++i) work[i].node = inner[first + i];
            tbb::parallel_for(std::size_t(0), work.size(),
                              [&](std::size_t i) { work[i].result = finish(work[i]); });
            for (Inner& one : work)
                if (auto ok = store(one); !ok) return ok;
            progress.add(work.size());
            if (stop.stop_requested()) return fail(ErrorCode::Cancelled, "Building the cloud was abandoned.");
        }
        progress.finish();
        return {};
    }

  private:
    Expected<AveragedFacts> factsOf(const BuildNode& node) const {
        if (!file_) return AveragedFacts{node.content.reaches, node.content.densities};
        const std::size_t count = node.stored.node.sampleCount;
        AveragedFacts facts{std::vector<float>(count), std::vector<Density>(count)};
        const std::uint64_t toReaches = count * sizeof(Sample),
                            toDensities = toReaches + count * sizeof(float);
        auto read = node.setAside.read(toReaches, std::as_writable_bytes(std::span(facts.reaches)));
        if (read) read = node.setAside.read(toDensities, std::as_writable_bytes(std::span(facts.densities)));
        if (!read) return passOn(read);
        return facts;
    }

    /// As averaged: near infrared alone, or nothing.
    Expected<std::vector<BesideWord>> besideOf(const BuildNode& node) const {
        if (!input_.nearInfrared || !file_) return node.content.beside;
        const std::size_t count = node.stored.node.sampleCount;
        const std::size_t before =
            sizeof(Sample) + (input_.shape.surfels ? sizeof(float) + sizeof(Density) : 0);
        std::vector<BesideWord> beside(count);
        if (auto ok = node.setAside.read(count * before, std::as_writable_bytes(std::span(beside))); !ok)
            return passOn(ok);
        return beside;
    }

    Expected<void> finish(Inner& work) const {
        BuildNode& node = *work.node;
        auto samples = samplesOf(node, file_);
        if (!samples) return passOn(samples);
        work.samples = std::move(*samples);
        auto beside = besideOf(node);
        if (!beside) return passOn(beside);
        work.beside = std::move(*beside);
        if (input_.hasBeside()) work.beside.resize(work.samples.size());
        if (input_.shape.surfels) {
            const auto facts = factsOf(node);
            if (!facts) return passOn(facts);
            const auto find = [this](const BuildNode& n) { return samplesOf(n, file_); };
            if (auto ok = addInnerSurfels(node, *facts, root_, input_, find, work.samples, work.beside); !ok)
                return ok;
        }
        node.content.cone = coneOfSamples(work.samples);
        node.sampleHash = hashOf(work.samples, work.beside);
        if (file_) work.block = encodeSamples(work.samples);
        if (file_) work.besideBlocks = encodeBeside(work.beside, input_);
        return {};
    }

    Expected<void> store(Inner& work) {
        if (!work.result) return work.result;
        if (input_.shape.curvatures()) addMeans(work.beside, radiusUnit(work.node->content.spacing), means_);
        if (!file_) {
            work.node->content.beside = std::move(work.beside);
            work.node->content.samples = std::move(work.samples);
            return {};
        }
        auto place = file_->append(work.block);
        if (!place) return passOn(place);
        work.node->stored.samples = *place;
        auto beside = appendBlocks(*file_, work.besideBlocks);
        if (!beside) return passOn(beside);
        work.node->beside = *beside;
        return {};
    }

    const BuildNode& root_;
    const OctreeInput& input_;
    BlockSink* const file_;
    ValueSketch& means_;  ///< of inner nodes: what is seen of the whole cloud
};

/// Children stand behind their parents: from the end to the start, every cone is joined with finished ones.
void joinCones(Numbered& tree) {
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {
        Node& node = tree.nodes[i].node;
        std::vector<NormalCone> cones{tree.order[i]->content.cone};
        if (node.confidence < sureSide) cones = {NormalCone{}};
        for (std::uint32_t c = 0; c < node.childCount; ++c)
            cones.push_back(tree.nodes[node.firstChild + c].node.cone);
        node.cone = join(cones);
    }
}

}  // namespace

std::uint64_t hashOf(std::span<const Sample> samples, std::span<const BesideWord> beside) {
    const std::uint64_t hash = XXH3_64bits(samples.data(), samples.size_bytes());
    if (beside.empty()) return hash;
    return XXH3_64bits_withSeed(beside.data(), beside.size_bytes(), hash);
}

BesideBlocks encodeBeside(std::span<const BesideWord> beside, const OctreeInput& input) {
    BesideBlocks blocks;
    if (input.shape.curvatures()) blocks.curvature = encodePart<CurvatureCode>(beside, curvatureIn);
    if (input.nearInfrared) blocks.nearInfrared = encodePart<std::uint8_t>(beside, nearInfraredIn);
    return blocks;
}

Expected<BesidePlaces> appendBlocks(BlockSink& file, const BesideBlocks& blocks) {
    BesidePlaces places;
    for (const auto& [block, place] : {std::pair(&blocks.curvature, &places.curvature),
                                       std::pair(&blocks.nearInfrared, &places.nearInfrared)}) {
        if (block->empty()) continue;
        auto written = file.append(*block);
        if (!written) return passOn(written);
        *place = *written;
    }
    return places;
}

NormalCone coneOfSamples(std::span<const Sample> samples) {
    std::vector<glm::vec3> normals;
    normals.reserve(samples.size());
    for (const Sample& s : samples) {
        if (s.normal == noNormal || s.ellipse == twoSidedCircle) return NormalCone{};
        normals.push_back(decodeNormal(s.normal));
    }
    return coneOf(normals);
}

Expected<BuiltOctree> finishTree(BuildNode& root, const OctreeInput& input, BlockSink* file,
                                 const ProgressSink& progress, const std::stop_token& stop) {
    ValueSketch curvatures;
    const std::vector<BuildNode*> inner = innerNodes(root);
    if (auto ok = finishInnerNodes(inner, root, input, file, curvatures, progress, stop); !ok)
        return passOn(ok);
    if (root.isLeaf())
        if (auto ok = addLeafCurvatures(root, input, file, curvatures); !ok) return passOn(ok);
    return numberTree(root, input, file != nullptr, curvatures);
}

Expected<std::vector<Sample>> samplesOf(const BuildNode& node, const BlockSink* file) {
    if (!file) return node.content.samples;
    std::vector<Sample> samples(node.stored.node.sampleCount);
    if (node.setAside.bytes() > 0) {
        if (auto ok = node.setAside.read(0, std::as_writable_bytes(std::span(samples))); !ok)
            return passOn(ok);
        return samples;
    }
    const auto block = file->readBack(node.stored.samples);
    if (!block) return passOn(block);
    if (auto ok = decodeSamples(*block, samples); !ok) return passOn(ok);
    return samples;
}

std::vector<BuildNode*> innerNodes(BuildNode& root) {
    std::vector<BuildNode*> inner;
    if (!root.isLeaf()) inner.push_back(&root);
    for (std::size_t i = 0; i < inner.size(); ++i)
        for (const auto& child : inner[i]->children)
            if (!child->isLeaf()) inner.push_back(child.get());
    return inner;
}

Expected<void> finishInnerNodes(std::span<BuildNode* const> nodes, const BuildNode& root,
                                const OctreeInput& input, BlockSink* file, ValueSketch& curvatures,
                                const ProgressSink& progress, const std::stop_token& stop) {
    return Finisher(root, input, file, curvatures).finish(nodes, progress, stop);
}

Expected<void> addLeafCurvatures(const BuildNode& leaf, const OctreeInput& input, const BlockSink* file,
                                 ValueSketch& curvatures) {
    if (!input.shape.curvatures()) return {};
    if (!file) {
        addMeans(leaf.content.beside, radiusUnit(leaf.content.spacing), curvatures);
        return {};
    }
    std::vector<CurvatureCode> codes(leaf.stored.node.sampleCount);
    if (leaf.beside.curvature.bytes > 0) {
        const auto block = file->readBack(leaf.beside.curvature);
        if (!block) return passOn(block);
        const auto values = decodeRows(*block, sizeof(CurvatureCode), codes.size());
        if (!values) return passOn(values);
        std::ranges::copy(*values, std::as_writable_bytes(std::span(codes)).begin());
    }
    addMeans(codes, radiusUnit(leaf.content.spacing), curvatures);
    return {};
}

BuiltOctree numberTree(BuildNode& root, const OctreeInput& input, bool inFile,
                       const ValueSketch& curvatures) {
    Numbered tree = number(root, input);
    joinCones(tree);
    BuiltOctree built;
    built.usualCurvature = {curvatures.quantile(0.05), curvatures.quantile(0.95)};
    for (const BuildNode* node : tree.order) built.sampleHashes.push_back(node->sampleHash);
    built.nodes = std::move(tree.nodes);
    if (inFile) {
        built.planes = planePlaces(tree.order, input);
        return built;
    }
    const Node& last = built.nodes.back().node;
    built.samples.resize(last.firstSample + last.sampleCount);
    if (input.hasBeside()) built.beside.resize(built.samples.size());
    tbb::parallel_for(std::size_t(0), tree.order.size(), [&](std::size_t i) {
        auto& own = tree.order[i]->content.samples;
        std::copy(own.begin(), own.end(),
                  built.samples.begin() + std::ptrdiff_t(built.nodes[i].node.firstSample));
        giveBack(own);
        auto& beside = tree.order[i]->content.beside;
        std::copy(beside.begin(), beside.end(),
                  built.beside.begin() + std::ptrdiff_t(built.nodes[i].node.firstSample));
        giveBack(beside);
    });
    return built;
}

}  // namespace scancast
