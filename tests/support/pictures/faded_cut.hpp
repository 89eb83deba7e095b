// A cut whose runs are drawn in part, and the same samples as whole runs: what a device makes of the first
// must be what it makes of the second.
#pragma once

#include "renderer/select/fade.hpp"
#include "renderer/select/select.hpp"

namespace scancast::test {

/// The shares of the runs, 0.05 … 1, are the cut's to vary.
inline Cut withShares(Cut cut) {
    for (std::size_t i = 0; i < cut.runs.size(); ++i) cut.runs[i].share = 0.05 + 0.95 * double(i % 8) / 7;
    return cut;
}

/// Only the samples that are drawn. Nodes and samples are this one's own.
class DrawnOnly {
  public:
    explicit DrawnOnly(const Cut& faded) {
        nodes_.reserve(faded.runs.size());
        samples_.reserve(faded.runs.size());
        for (const CutRun& run : faded.runs) {
            auto& samples = samples_.emplace_back();
            for (std::uint32_t i = 0; i < run.samples.size(); ++i)
                if (isDrawn(i, lastTurn(run.share))) samples.push_back(run.samples[i]);
            Node& node = nodes_.emplace_back(*run.node);
            node.sampleCount = std::uint32_t(samples.size());
            CutRun& whole = cut_.runs.emplace_back(run);
            whole.node = &node;
            whole.samples = samples;
            whole.share = 1;
            whole.firstOrdinal = std::uint32_t(cut_.samples);
            cut_.samples += samples.size();
        }
    }
    DrawnOnly(const DrawnOnly&) = delete;
    const Cut& cut() const { return cut_; }

  private:
    std::vector<Node> nodes_;
    std::vector<std::vector<Sample>> samples_;
    Cut cut_;
};

}  // namespace scancast::test
