// The hierarchy of a cloud in memory: nodes with bounds and spacing, each with a run of samples.
// Pipeline: import → **octree** → select. Immutable once built; read from any thread.
// Source: Kaushik, Nagwanshi and Sharma, "Achieving a Smooth Interpolation between the Points Using Modified
// Rendering Algorithm", undated, §IV-a (split at the average, averaged inner samples); docs/spec/hierarchy.md
// §1.
//
// A node's samples *replace* its parent's: drawing a node instead of its ancestor shows the same surface,
// finer. Leaves hold the scan's own points; inner nodes hold averages over cells. Cell sizes form one ladder
// for the whole cloud, halved from cell level to cell level and anchored globally; where points are evenly dense, a cell level
// is a level. A node's cell level is chosen so that it holds thousands of samples where dense and sparse regions
// share the tree, too.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "renderer/cloud/sample.hpp"
#include "renderer/cloud/sample_store.hpp"

namespace scancast {

inline constexpr std::uint32_t noNode = 0xffffffffu;

/// Cone around all normals below a node, for back-face culling; halfAngle ≥ π = unknown, never culled.
struct NormalCone {
    glm::vec3 axis{0, 0, 1};
    float halfAngle = 3.2f;
};

/// Node::confidence where nobody had to guess.
inline constexpr std::uint8_t certainSide = 255;
/// From this confidence on a node is drawn as oriented: less leaves holes where somebody guessed wrong.
inline constexpr std::uint8_t sureSide = 230;

struct Node {
    glm::dvec3 boxMin;  ///< cloud-relative; the corner that sample positions count from
    glm::dvec3 step;    ///< cloud units per quantisation step, per axis; > 0
    glm::dvec3 boxMax;  ///< tight around the node's own samples *and* everything below it
    glm::dvec3 center;  ///< bounding sphere of everything below it and its own samples
    double radius;
    /// Pitch, cloud units, of a square grid whose gaps are as large as those between this node's samples
    /// (spacing.hpp): discs of this radius close the surface. > 0; an inner node's is at least its cell size
    /// unless its parent's is smaller, and no node's is above its parent's.
    float spacing;
    /// √(surface per sample): the typical distance between neighbours, what τ is compared with; > 0, ≤
    /// spacing.
    float meanSpacing;
    /// What logRadius counts from (surfel_codec.hpp): this node's own spacing, before its parent's bounded it; > 0.
    float radiusUnit = 1;
    NormalCone cone;
    std::uint32_t parent = noNode;
    std::uint32_t firstChild =
        noNode;                   ///< children stand side by side: firstChild … firstChild + childCount - 1
    std::uint8_t childCount = 0;  ///< 0 = leaf
    std::uint8_t level = 0;       ///< root = 0
    /// How sure it is that the samples' normals point to the side that was scanned, but for those that are two-sided
    /// (surfel_bytes.hpp): 0 not known … certainSide.
    std::uint8_t confidence = 0;
    std::uint32_t sampleCount = 0;
    std::uint64_t firstSample = 0;  ///< index of the run in the octree's sample store
    std::uint64_t points = 0;       ///< scan points below this node

    bool isLeaf() const { return childCount == 0; }
};

/// A number that nothing in this process had before; > 0. From any thread.
std::uint64_t newSource();

/// Nodes in breadth-first order, and the store that their samples are in: the root first, or, of several clouds
/// together, all roots (renderer/together). Same input → same nodes and samples, on any number of threads.
class Octree {
  public:
    Octree() = default;
    /// Everything in memory, in the order of firstSample.
    /// `beside`: of all samples, or empty.
    Octree(std::vector<Node> nodes, std::vector<Sample> samples, std::vector<BesideWord> beside = {});
    /// Samples come from a store that knows these nodes by their index. `source`: of another octree, whose nodes
    /// have the same samples as these, only lying elsewhere; 0 = a new one.
    Octree(std::vector<Node> nodes, std::shared_ptr<SampleStore> store, std::uint64_t source = 0);

    std::span<const Node> nodes() const { return nodes_; }
    const Node& node(std::uint32_t index) const { return nodes_[index]; }
    /// So many of the first nodes are roots: nobody's children, and all others are below them. 0: there are no nodes.
    std::uint32_t roots() const { return roots_; }
    /// The node's samples, loaded if need be and kept while the result lives. For tools and tests, which want
    /// whole clouds; drawing goes through provide() (renderer/residency). Errors: the store's.
    Expected<SampleRun> run(std::uint32_t index) const { return store_->load(index); }
    SampleStore& store() const { return *store_; }
    const std::shared_ptr<SampleStore>& sharedStore() const { return store_; }
    /// Tells this octree (and its copies, which are alike) from all others that there were and will be: who
    /// keeps samples knows them by source and node. 0: it has no nodes.
    std::uint64_t source() const { return source_; }
    std::uint64_t sampleCount() const { return sampleCount_; }
    /// Of the nodes and of what is in memory of the samples.
    std::uint64_t bytesResident() const;

  private:
    std::vector<Node> nodes_;
    std::shared_ptr<SampleStore> store_;
    std::uint64_t sampleCount_ = 0;
    std::uint64_t source_ = 0;
    std::uint32_t roots_ = 0;
};

/// Sample position, cloud-relative.
inline glm::dvec3 position(const Node& n, const Sample& s) {
    return n.boxMin + n.step * glm::dvec3(s.x, s.y, s.z);
}

}  // namespace scancast
