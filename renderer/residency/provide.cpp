#include "renderer/residency/provide.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "renderer/residency/node_runs.hpp"
#include "renderer/residency/stand_ins.hpp"

namespace scancast {

namespace {

// More than any picture needs at once; what is left out is asked for by the next frame.
constexpr std::size_t mostRequests = 4096;
// Everything that is missing now comes before anything that may be missing soon: spacings on screen are
// positive, and these are below.
constexpr double aheadUrgency = -1e9;

std::vector<std::uint32_t> nodesOf(const Cut& cut) {
    std::vector<std::uint32_t> nodes;
    nodes.reserve(cut.runs.size());
    for (const CutRun& run : cut.runs) nodes.push_back(run.nodeIndex);
    return nodes;
}

void fill(Cut& cut, CutRun& run, const SampleRun& samples) {
    run.samples = samples.samples;
    run.limits = samples.limits;
    if (cut.beside) run.beside = samples.beside;
    if (samples.keep) cut.keep.push_back(samples.keep);
}

/// Where everything is in memory and stays there nothing has to be asked for, nor remembered. False: something is not.
bool fillWhole(SampleStore& store, Cut& cut) {
    cut.keep.clear();
    for (CutRun& run : cut.runs) {
        const auto samples = store.find(run.nodeIndex);
        if (!samples) return false;
        fill(cut, run, *samples);
    }
    dealOrdinals(cut);
    return true;
}

class Provision {
  public:
    Provision(const Octree& octree, Cut wanted, const ProvideOptions& options)
        : octree_(octree), options_(options), cut_(std::move(wanted)), runs_(octree) {}

    Expected<Cut> provide(const std::stop_token& stop) {
        const std::vector<std::uint32_t> wanted = nodesOf(cut_);
        if (options_.wait) {
            if (auto ok = loadWanted(wanted, stop); !ok) return passOn(ok);
        } else {
            runs_.ask(wanted);
        }
        const AtHand atHand = [&](std::uint32_t node) { return runs_.has(node); };
        if (!options_.wait && options_.request) request(atHand);
        cut_ = withStandIns(octree_, std::move(cut_), atHand,
                            [&](Cut& cut, const CutRun& run) { count(cut, run); });
        cut_.away = cut_.nodesMissing > 0 && octree_.store().isAway();
        fill();
        return std::move(cut_);
    }

  private:
    std::uint32_t parent(std::uint32_t node) const { return octree_.node(node).parent; }

    /// Damaged blocks fall back on their ancestors, which are loaded in turn.
    Expected<void> loadWanted(std::vector<std::uint32_t> nodes, const std::stop_token& stop) {
        while (!nodes.empty()) {
            if (auto ok = runs_.load(nodes, stop); !ok) return ok;
            std::vector<std::uint32_t> above;
            for (const std::uint32_t node : nodes)
                if (!runs_.has(node) && parent(node) != noNode) above.push_back(parent(node));
            std::sort(above.begin(), above.end());
            above.erase(std::unique(above.begin(), above.end()), above.end());
            nodes = std::move(above);
        }
        return {};
    }

    /// Called even when nothing is missing: earlier requests are then moot.
    void request(const AtHand& atHand) {
        if (octree_.store().whole()) return;
        BlockRequests requests(octree_, atHand);
        requests.add(cut_.runs);
        requests.add(options_.beside);
        requests.add(options_.ahead, aheadUrgency);
        std::vector<BlockRequest> sorted = requests.sorted();
        if (sorted.size() > mostRequests) sorted.resize(mostRequests);
        octree_.store().request(options_.requester, std::move(sorted));
    }

    /// Nothing will ever come in a damaged block's place; what stands in for it may still be to come.
    void count(Cut& cut, const CutRun& run) {
        std::uint32_t lacking = run.nodeIndex;
        if (runs_.damaged(lacking)) {
            cut.damaged.push_back(lacking);
            if (run.share < 1) return;  // another run covers it
            while (lacking != noNode && !runs_.has(lacking) && runs_.damaged(lacking))
                lacking = parent(lacking);
            if (lacking == noNode || runs_.has(lacking)) return;
        }
        ++cut.nodesMissing;
        cut.samplesMissing += octree_.node(lacking).sampleCount;
    }

    void fill() {
        cut_.keep.clear();
        cut_.keep.reserve(cut_.runs.size());
        for (CutRun& run : cut_.runs) scancast::fill(cut_, run, runs_.run(run.nodeIndex));
        dealOrdinals(cut_);
    }

    const Octree& octree_;
    const ProvideOptions& options_;
    Cut cut_;
    NodeRuns runs_;
};

}  // namespace

Expected<Cut> provide(const Octree& octree, Cut wanted, const ProvideOptions& options, std::stop_token stop) {
    if (octree.nodes().empty()) return wanted;
    if (octree.store().whole() && fillWhole(octree.store(), wanted)) return wanted;
    return Provision(octree, std::move(wanted), options).provide(stop);
}

}  // namespace scancast
