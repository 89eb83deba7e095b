// A toy cloud: a tree of a few hundred nodes, a store of which a test says what is in it, and cuts as
// selection makes them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "renderer/select/select.hpp"
#include "tests/support/clouds/fake_cloud_file.hpp"

namespace scancast::test {

/// A store of which a test says what is in it.
class ToyStore final : public SampleStore {
  public:
    explicit ToyStore(const FakeCloudFile& file) : file_(file) {}

    std::optional<SampleRun> find(std::uint32_t node) override {
        if (!resident.contains(node)) return std::nullopt;
        return run(node);
    }
    Expected<SampleRun> load(std::uint32_t node, std::stop_token stop) override {
        return std::move(loadAll(std::span(&node, 1), stop).front());
    }
    std::vector<Expected<SampleRun>> loadAll(std::span<const std::uint32_t> nodes,
                                             std::stop_token stop) override {
        std::vector<Expected<SampleRun>> runs;
        for (const std::uint32_t node : nodes) {
            if (stop.stop_requested())
                runs.emplace_back(fail(ErrorCode::Cancelled, "stopped"));
            else if (broken.contains(node))
                runs.emplace_back(fail(ErrorCode::Malformed, "broken"));
            else
                runs.emplace_back(run(node));
        }
        return runs;
    }
    void request(std::uint64_t who, std::vector<BlockRequest> list) override {
        requester = who, requests = std::move(list);
    }
    bool whole() const override { return false; }
    bool damaged(std::uint32_t node) const override { return broken.contains(node); }
    bool isAway() const override { return away; }
    std::uint64_t capacity() const override { return 1'000'000; }
    std::uint64_t bytesResident() const override { return 0; }

    std::set<std::uint32_t> resident, broken;
    std::vector<BlockRequest> requests;
    std::uint64_t requester = 0;
    bool away = false;

  private:
    SampleRun run(std::uint32_t node) {
        auto& samples = made_[node];
        if (samples.empty()) samples = *file_.samples(node);
        return {samples, {}, std::make_shared<int>(0)};
    }
    const FakeCloudFile& file_;
    std::map<std::uint32_t, std::vector<Sample>> made_;
};

class ToyCloud : public testing::Test {
  protected:
    void SetUp() override {
        store_ = std::make_shared<ToyStore>(file_);
        octree_ = octreeOf(file_, store_);
        ASSERT_GT(octree_.nodes().size(), 200u);
    }

    /// A cut as selection makes them: refined here and there, and without what is not seen.
    Cut randomCut(std::uint64_t seed) const {
        Cut cut;
        std::vector<std::uint32_t> queue{0};
        for (std::size_t at = 0; at < queue.size(); ++at) {
            const Node& n = octree_.node(queue[at]);
            if (!n.isLeaf() && uniform(queue[at], 7 * seed) < 0.8) {
                for (std::uint32_t c = 0; c < n.childCount; ++c)
                    if (uniform(n.firstChild + c, 7 * seed + 1) < 0.9) queue.push_back(n.firstChild + c);
                continue;
            }
            CutRun run;
            run.node = &n;
            run.nodeIndex = queue[at];
            run.projected = 1 + uniform(queue[at], 7 * seed + 2);
            cut.runs.push_back(run);
        }
        number(cut);
        return cut;
    }
    /// As selection makes them where levels fade, of nodes that are whole, come, leave or have left.
    Cut fadingCut(std::uint64_t seed) const {
        struct Visit {
            std::uint32_t index;
            double share;
        };
        Cut cut;
        std::vector<Visit> queue{{0, 1}};
        for (std::size_t at = 0; at < queue.size(); ++at) {
            const Visit visit = queue[at];
            const Node& n = octree_.node(visit.index);
            const double progress = n.isLeaf() ? 0 : 2.5 * uniform(visit.index, 7 * seed + 4) - 0.2;
            const double own = std::clamp(2 - progress, 0.0, 1.0), below = std::clamp(progress, 0.0, 1.0);
            if (own > 0) {
                CutRun& run = cut.runs.emplace_back();
                run.node = &n;
                run.nodeIndex = visit.index;
                run.projected = 1 + uniform(visit.index, 7 * seed + 2);
                run.share = visit.share * own;
            }
            for (std::uint32_t c = 0; c < n.childCount && below > 0; ++c)
                queue.push_back({n.firstChild + c, visit.share * below});
        }
        number(cut);
        return cut;
    }

    void makeResident(std::uint64_t seed, double share) {
        store_->resident.clear();
        for (std::uint32_t n = 0; n < octree_.nodes().size(); ++n)
            if (uniform(n, 7 * seed + 3) < share) store_->resident.insert(n);
    }

    FakeCloudFile file_{3, 6, 4};
    std::shared_ptr<ToyStore> store_;
    Octree octree_;
};

}  // namespace scancast::test
