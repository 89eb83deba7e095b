#include "renderer/residency/on_device.hpp"

#include <unordered_set>
#include <utility>
#include <vector>

#include "renderer/residency/node_runs.hpp"
#include "renderer/residency/stand_ins.hpp"

namespace scancast {

namespace {

/// Nothing is missing that drawing may not upload as it goes.
bool fits(const Octree& octree, std::span<Cut* const> cuts, const DeviceMemory& memory) {
    std::uint64_t all = 0, missing = 0;
    std::vector<bool> seen(octree.nodes().size());
    for (const Cut* cut : cuts) {
        for (const CutRun& run : cut->runs) {
            if (seen[run.nodeIndex]) continue;
            seen[run.nodeIndex] = true;
            const auto samples =
                run.samples.empty() ? run.node->sampleCount : std::uint32_t(run.samples.size());
            all += samples;
            if (!memory.has(octree.source(), run.nodeIndex, samples, cut->beside)) missing += samples;
        }
    }
    return missing == 0 || (missing <= memory.frameBudget() && all <= memory.capacity());
}

class DeviceProvision {
  public:
    DeviceProvision(const Octree& octree, std::span<Cut* const> cuts, DeviceMemory& memory)
        : octree_(octree), cuts_(cuts), beside_(cuts.front()->beside), memory_(memory), runs_(octree) {}

    Expected<void> provide(const std::stop_token& stop) {
        for (const Cut* cut : cuts_)
            for (const CutRun& run : cut->runs)
                runs_.give(run.nodeIndex, {run.samples, run.limits, {}, run.beside});
        // In this order: what must be there, what is there and wanted, what is to come.
        for (std::uint32_t root = 0; root < octree_.roots(); ++root) add(root);
        for (const Cut* cut : cuts_)
            for (const CutRun& run : cut->runs) addStandIn(run.nodeIndex);
        for (const Cut* cut : cuts_)
            for (const CutRun& run : cut->runs)
                if (isThere(run.nodeIndex)) add(run.nodeIndex);
        addRequests();
        if (auto ok = memory_.bring(octree_.source(), toBring_, stop); !ok) return ok;
        for (Cut* cut : cuts_) replaceMissing(*cut);
        return {};
    }

  private:
    /// What it really has counts, where that is known: a native cloud's nodes only estimate it.
    bool isThere(std::uint32_t node) {
        const std::size_t samples =
            runs_.has(node) ? runs_.run(node).samples.size() : octree_.node(node).sampleCount;
        return memory_.has(octree_.source(), node, std::uint32_t(samples), beside_);
    }

    void add(std::uint32_t node) {
        if (!runs_.has(node) || !added_.insert(node).second) return;
        CutRun run{.node = &octree_.node(node), .nodeIndex = node, .samples = runs_.run(node).samples};
        if (beside_) run.beside = runs_.run(node).beside;
        toBring_.push_back(run);
    }

    /// What would be drawn for a node that is not there.
    void addStandIn(std::uint32_t node) {
        if (isThere(node)) return;
        while (node != noNode && !(isThere(node) && runs_.has(node))) node = octree_.node(node).parent;
        if (node != noNode) add(node);
    }

    void addRequests() {
        const AtHand atHand = [&](std::uint32_t node) { return isThere(node) || added_.contains(node); };
        BlockRequests requests(octree_, atHand);
        for (const Cut* cut : cuts_) requests.add(cut->runs);
        std::uint64_t moved = 0;
        for (const BlockRequest& request : requests.sorted()) {
            if (!runs_.has(request.node)) continue;
            moved += octree_.node(request.node).sampleCount;
            // One of them goes at any rate, or a small budget would leave all of them where they are.
            if (moved > memory_.frameBudget() && moved > octree_.node(request.node).sampleCount) break;
            add(request.node);
        }
    }

    void replaceMissing(Cut& cut) {
        const AtHand atHand = [&](std::uint32_t node) { return isThere(node) && runs_.has(node); };
        cut = withStandIns(octree_, std::move(cut), atHand, [](Cut& counted, const CutRun& run) {
            ++counted.nodesMissing;
            counted.samplesMissing += run.node->sampleCount;
        });
        for (CutRun& run : cut.runs) {
            if (!run.samples.empty()) continue;
            const SampleRun& samples = runs_.run(run.nodeIndex);
            run.samples = samples.samples;
            run.limits = samples.limits;
            if (beside_) run.beside = samples.beside;
            if (samples.keep) cut.keep.push_back(samples.keep);
        }
        dealOrdinals(cut);
    }

    const Octree& octree_;
    const std::span<Cut* const> cuts_;
    const bool beside_;
    DeviceMemory& memory_;
    NodeRuns runs_;
    std::vector<CutRun> toBring_;
    std::unordered_set<std::uint32_t> added_;
};

}  // namespace

Expected<void> provideOnDevice(const Octree& octree, std::span<Cut* const> cuts, DeviceMemory& memory,
                               const std::stop_token& stop) {
    if (octree.nodes().empty() || fits(octree, cuts, memory)) return {};
    return DeviceProvision(octree, cuts, memory).provide(stop);
}

}  // namespace scancast
