#include "renderer/residency/provide.hpp"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace scancast {

namespace {

// More than any picture needs at once; what is left out is asked for by the next frame.
constexpr std::size_t mostWishes = 4096;
// Everything that is missing now comes before anything that may be missing soon: spacings on screen are
// positive, and these are below.
constexpr double aheadUrgency = -1e9;

/// The samples of nodes, asked for once each.
class Runs {
  public:
    explicit Runs(const Octree& octree) : octree_(octree) {}

    bool has(std::uint32_t node) {
        const auto [at, isNew] = found_.try_emplace(node);
        if (isNew) at->second.run = octree_.store().find(node);
        return at->second.run.has_value();
    }
    const SampleRun& run(std::uint32_t node) const { return *found_.at(node).run; }
    bool damaged(std::uint32_t node) const {
        const auto at = found_.find(node);
        return at != found_.end() && at->second.damaged;
    }

    /// Loads those that are not here. Cancelled is the only error that stays one; others mark the node.
    Expected<void> load(const std::vector<std::uint32_t>& nodes, const std::stop_token& stop) {
        std::vector<std::uint32_t> absent;
        for (const std::uint32_t node : nodes)
            if (!has(node) && !damaged(node)) absent.push_back(node);
        auto loaded = octree_.store().loadAll(absent, stop);
        for (std::size_t i = 0; i < absent.size(); ++i) {
            Found& found = found_.at(absent[i]);
            if (loaded[i]) {
                found.run = std::move(*loaded[i]);
            } else if (loaded[i].error().code == ErrorCode::Cancelled) {
                return tl::unexpected(std::move(loaded[i].error()));
            } else {
                found.damaged = true;
            }
        }
        return {};
    }

  private:
    struct Found {
        std::optional<SampleRun> run;
        bool damaged = false;
    };
    const Octree& octree_;
    std::unordered_map<std::uint32_t, Found> found_;
};

class Provision {
  public:
    Provision(const Octree& octree, Cut wanted, const ProvideOptions& options)
        : octree_(octree), options_(options), cut_(std::move(wanted)), runs_(octree) {}

    Expected<Cut> provide(const std::stop_token& stop) {
        if (options_.wait) {
            if (auto loaded = loadWanted(stop); !loaded) return tl::unexpected(std::move(loaded.error()));
        }
        bool complete = true;
        for (const CutRun& run : cut_.runs) complete = runs_.has(run.nodeIndex) && complete;
        if (!options_.wait && options_.request) request();
        if (!complete) replaceMissing();
        fill();
        return std::move(cut_);
    }

  private:
    std::uint32_t parent(std::uint32_t node) const { return octree_.node(node).parent; }

    /// Damaged blocks fall back on their ancestors, which are loaded in turn.
    Expected<void> loadWanted(const std::stop_token& stop) {
        std::vector<std::uint32_t> nodes;
        for (const CutRun& run : cut_.runs) nodes.push_back(run.nodeIndex);
        while (!nodes.empty()) {
            if (auto loaded = runs_.load(nodes, stop); !loaded) return loaded;
            std::vector<std::uint32_t> above;
            for (const std::uint32_t node : nodes)
                if (!runs_.has(node) && parent(node) != noNode) above.push_back(parent(node));
            std::sort(above.begin(), above.end());
            above.erase(std::unique(above.begin(), above.end()), above.end());
            nodes = std::move(above);
        }
        return {};
    }

    /// A missing node and its missing ancestors, up to the first that is here: coarser ones are more urgent,
    /// because their spacings are larger on screen, too.
    void wishFor(const CutRun& run, double offset, std::unordered_map<std::uint32_t, double>& wishes) {
        for (std::uint32_t node = run.nodeIndex; node != noNode && !runs_.has(node); node = parent(node)) {
            const double urgency = offset +
                                   run.projected * (octree_.node(node).meanSpacing / run.node->meanSpacing) +
                                   double(run.node->level - octree_.node(node).level) * 1e-6;
            double& wish = wishes.try_emplace(node, urgency).first->second;
            wish = std::max(wish, urgency);
        }
    }

    /// Called even when nothing is missing: earlier wishes are then moot.
    void request() {
        if (octree_.store().whole()) return;
        std::unordered_map<std::uint32_t, double> urgencies;
        for (const CutRun& run : cut_.runs) wishFor(run, 0, urgencies);
        for (const CutRun& run : options_.beside) wishFor(run, 0, urgencies);
        for (const CutRun& run : options_.ahead) wishFor(run, aheadUrgency, urgencies);
        std::vector<Wish> wishes;
        wishes.reserve(urgencies.size());
        for (const auto& [node, urgency] : urgencies) wishes.push_back({node, urgency});
        std::sort(wishes.begin(), wishes.end(), [](const Wish& a, const Wish& b) {
            return a.urgency != b.urgency ? a.urgency > b.urgency : a.node < b.node;
        });
        if (wishes.size() > mostWishes) wishes.resize(mostWishes);
        octree_.store().request(options_.requester, std::move(wishes));
    }

    void replaceMissing() {
        std::unordered_map<std::uint32_t, double> standIns;  // and how large their spacing is on screen
        for (const CutRun& run : cut_.runs) {
            if (runs_.has(run.nodeIndex)) continue;
            count(run);
            if (run.share < 1) continue;  // a whole run shows what it is to show
            std::uint32_t up = parent(run.nodeIndex);
            while (up != noNode && !runs_.has(up)) up = parent(up);
            if (up == noNode) continue;
            const double projected = run.projected * (octree_.node(up).meanSpacing / run.node->meanSpacing);
            double& known = standIns.try_emplace(up, projected).first->second;
            known = std::max(known, projected);
        }
        std::vector<CutRun> drawn;
        for (CutRun& run : cut_.runs) {
            std::uint32_t top = noNode;
            for (std::uint32_t up = run.nodeIndex; up != noNode; up = parent(up))
                if (standIns.contains(up)) top = up;
            if (top == noNode) {
                if (runs_.has(run.nodeIndex)) drawn.push_back(run);
                continue;
            }
            run.projected = standIns.at(top);
            run.nodeIndex = top;
            run.node = &octree_.node(top);
            run.share = 1;
            drawn.push_back(run);
        }
        std::sort(drawn.begin(), drawn.end(),
                  [](const CutRun& a, const CutRun& b) { return a.nodeIndex < b.nodeIndex; });
        drawn.erase(std::unique(drawn.begin(), drawn.end(),
                                [](const CutRun& a, const CutRun& b) { return a.nodeIndex == b.nodeIndex; }),
                    drawn.end());
        cut_.runs = std::move(drawn);
        findCovered();
        number(cut_);
    }

    void findCovered() {
        std::unordered_set<std::uint32_t> drawn;
        for (const CutRun& run : cut_.runs) drawn.insert(run.nodeIndex);
        for (CutRun& run : cut_.runs) {
            run.covered = false;
            for (std::uint32_t up = parent(run.nodeIndex); up != noNode; up = parent(up))
                run.covered = run.covered || drawn.contains(up);
        }
    }

    void count(const CutRun& run) {
        if (runs_.damaged(run.nodeIndex) || octree_.store().damaged(run.nodeIndex)) {
            ++cut_.nodesDamaged;
        } else {
            ++cut_.nodesMissing;
            cut_.samplesMissing += run.node->sampleCount;
        }
    }

    void fill() {
        cut_.keep.clear();
        for (CutRun& run : cut_.runs) {
            const SampleRun& samples = runs_.run(run.nodeIndex);
            run.samples = samples.samples;
            run.limits = samples.limits;
            if (samples.keep) cut_.keep.push_back(samples.keep);
        }
    }

    const Octree& octree_;
    const ProvideOptions& options_;
    Cut cut_;
    Runs runs_;
};

}  // namespace

Expected<Cut> provide(const Octree& octree, Cut wanted, const ProvideOptions& options, std::stop_token stop) {
    if (octree.nodes().empty()) return wanted;
    return Provision(octree, std::move(wanted), options).provide(stop);
}

}  // namespace scancast
