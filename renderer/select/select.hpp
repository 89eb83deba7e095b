// Selection: cloud + viewpoint → cut, the nodes to draw. A pure function of the nodes' geometry, with
// counters; it touches no sample. Pipeline: octree → **select** → residency (which fills in the samples) →
// device. Source: Kaushik, Nagwanshi and Sharma, "Achieving a Smooth Interpolation between the Points Using
// Modified Rendering Algorithm", undated, §IV-c; docs/spec/hierarchy.md §6.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec4.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "protocol/view/view.hpp"
#include "renderer/cloud/octree.hpp"
#include "renderer/select/viewpoint.hpp"

namespace scancast {

struct SelectOptions {
    double detail = 1;  ///< τ in px: refine while the projected spacing exceeds it; 0 = to the leaves
    std::optional<std::uint64_t>
        budget;  ///< samples at most; the coarsest possible cut is drawn even if above it
    /// Bounds are grown by this many px and by `growSpacings` × the node's spacing before frustum culling: half of
    /// the largest splat that the method draws, so that culled = not culled, pixel for pixel.
    double growPx = 1;
    double growSpacings = 0;
    bool cull = true;
    /// Leaves out nodes whose normals all face away from the eye: for methods that do not draw such samples, and
    /// clouds whose normals are oriented.
    bool cullBackFaces = false;
    bool sureNodesOnly = false;  ///< those alone whose confidence is at least sureSide
    /// Levels fade into each other while the spacing is between τ and (1 + fade) · τ (fade.hpp); 0 = they switch.
    double fade = 0;
    /// Of the picture, only this much is looked at: left, top, right, bottom, px. Grown by growPx, too.
    std::optional<std::array<double, 4>> part{};
    /// Cloud-relative planes, unit normals: samples with dot(xyz, p) + w < 0 are not drawn anyway.
    std::vector<glm::dvec4> inFrontOf{};
    /// Cloud-relative, too: samples outside of the box, or of what shapes leave, are not drawn anyway.
    std::optional<ClipBox> clip{};
    ClipRegions shapes{};
    bool bruteForce = false;  ///< every leaf sample; no selection, no culling
};

struct CutRun {
    const Node* node = nullptr;
    std::uint32_t nodeIndex = noNode;
    std::span<const Sample> samples;         ///< empty until provide() (renderer/residency) fills it in
    std::span<const SampleLimits> limits{};  ///< of the samples, likewise; empty: not known
    std::span<const BesideWord> beside{};    ///< likewise; empty: not known
    double projected = 0;                    ///< spacing as it appears in the picture, px, at most
    double share = 1;      ///< of the samples, drawn: those whose turn it is (fade.hpp); > 0
    bool covered = false;  ///< an ancestor is drawn, too
    std::uint32_t firstOrdinal =
        0;  ///< ordinal in the cut of samples[0]; they grow from run to run, with gaps in native clouds
};

/// Every leaf in sight is covered by one whole run: its own, or an ancestor's. Without fading there are no others; with
/// it, a part of those above may still be drawn, and a part of those below already.
///
/// Runs ordered by node index, so ordinals depend on the view alone, not on threads or time. Points into the octree,
/// and into blocks that it keeps in memory as long as it lives.
struct Cut {
    std::vector<CutRun> runs;
    std::uint64_t source = 0;  ///< of its octree (Octree::source()); 0: not of one, nothing may be kept of it
    bool beside = false;       ///< provide() is to give what stands beside its samples, too
    std::uint64_t samples = 0;  ///< of the nodes, whatever share of them is drawn
    std::uint64_t points = 0;   ///< scan points that the drawn nodes stand for, each counted once
    std::uint32_t nodesVisited = 0, nodesCulled = 0, nodesRefined = 0;
    std::uint32_t nodesFacingAway = 0;  ///< of those culled
    std::uint32_t nodesClipped = 0;     ///< likewise: in view, but cut away by clip box or shapes
    double spacingReached = 0;          ///< largest projected spacing drawn, px
    bool budgetReached = false;
    std::uint32_t nodesMissing =
        0;  ///< drawn by an ancestor, or not at all, because they are not in memory (yet)
    std::uint64_t samplesMissing = 0;  ///< in those
    bool away =
        false;  ///< they cannot be had at present: what they come from is out of reach (SampleStore::isAway())
    std::vector<std::uint32_t> damaged;  ///< nodes likewise, whose blocks cannot be read: not missing
    std::vector<std::shared_ptr<const void>> keep;  ///< what `samples` point into
};

/// Of all runs, from their nodes: firstOrdinal, and the cut's samples, points and spacingReached.
void number(Cut& cut);
/// The ordinals alone, anew: once its runs have their samples, of which a native cloud's nodes may have more than they say. Those that are
/// left out between two runs are nobody's.
void dealOrdinals(Cut& cut);

Cut select(const Octree& octree, const Viewpoint& viewpoint, const SelectOptions& options);

}  // namespace scancast
