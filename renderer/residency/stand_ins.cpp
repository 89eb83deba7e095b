#include "renderer/residency/stand_ins.hpp"

#include <algorithm>
#include <unordered_set>
#include <utility>

namespace scancast {

namespace {

class StandIns {
  public:
    StandIns(const Octree& octree, Cut wanted, const AtHand& atHand)
        : octree_(octree), cut_(std::move(wanted)), atHand_(atHand) {}

    Cut replace(const std::function<void(Cut&, const CutRun&)>& missing) {
        bool complete = true;
        for (const CutRun& run : cut_.runs) {
            if (atHand_(run.nodeIndex)) continue;
            complete = false;
            missing(cut_, run);
            standInFor(run);
        }
        if (complete) return std::move(cut_);
        drawStandIns();
        findCovered();
        number(cut_);
        return std::move(cut_);
    }

  private:
    std::uint32_t parent(std::uint32_t node) const { return octree_.node(node).parent; }

    void standInFor(const CutRun& run) {
        if (run.share < 1) return;  // a whole run shows what it is to show
        std::uint32_t up = parent(run.nodeIndex);
        while (up != noNode && !atHand_(up)) up = parent(up);
        if (up == noNode) return;
        const double projected = run.projected * (octree_.node(up).meanSpacing / run.node->meanSpacing);
        double& known = standIns_.try_emplace(up, projected).first->second;
        known = std::max(known, projected);
    }

    void drawStandIns() {
        std::vector<CutRun> drawn;
        for (CutRun& run : cut_.runs) {
            std::uint32_t top = noNode;
            for (std::uint32_t up = run.nodeIndex; up != noNode; up = parent(up))
                if (standIns_.contains(up)) top = up;
            if (top == noNode) {
                if (atHand_(run.nodeIndex)) drawn.push_back(run);
                continue;
            }
            if (run.nodeIndex != top) run.samples = {}, run.limits = {}, run.beside = {};
            run.projected = standIns_.at(top);
            run.nodeIndex = top;
            run.node = &octree_.node(top);
            run.share = 1;
            drawn.push_back(run);
        }
        std::ranges::sort(drawn, {}, &CutRun::nodeIndex);
        const auto same = std::ranges::unique(drawn, {}, &CutRun::nodeIndex);
        drawn.erase(same.begin(), same.end());
        cut_.runs = std::move(drawn);
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

    const Octree& octree_;
    Cut cut_;
    const AtHand& atHand_;
    std::unordered_map<std::uint32_t, double> standIns_;  // and how large their spacing is on screen
};

}  // namespace

Cut withStandIns(const Octree& octree, Cut wanted, const AtHand& atHand,
                 const std::function<void(Cut&, const CutRun&)>& missing) {
    return StandIns(octree, std::move(wanted), atHand).replace(missing);
}

void BlockRequests::add(std::span<const CutRun> runs, double offset) {
    for (const CutRun& run : runs) {
        // Coarser ones are more urgent, because their spacings are larger on screen, too.
        for (std::uint32_t node = run.nodeIndex; node != noNode && !atHand_(node);
             node = octree_.node(node).parent) {
            const double urgency = offset +
                                   run.projected * (octree_.node(node).meanSpacing / run.node->meanSpacing) +
                                   double(run.node->level - octree_.node(node).level) * 1e-6;
            double& request = urgencies_.try_emplace(node, urgency).first->second;
            request = std::max(request, urgency);
        }
    }
}

std::vector<BlockRequest> BlockRequests::sorted() const {
    std::vector<BlockRequest> requests;
    requests.reserve(urgencies_.size());
    for (const auto& [node, urgency] : urgencies_) requests.push_back({node, urgency});
    std::ranges::sort(requests, [](const BlockRequest& a, const BlockRequest& b) {
        return a.urgency != b.urgency ? a.urgency > b.urgency : a.node < b.node;
    });
    return requests;
}

}  // namespace scancast
