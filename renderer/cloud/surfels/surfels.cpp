#include "renderer/cloud/surfels/surfels.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "renderer/cloud/surfels/kernels/levels.hpp"
#include "renderer/cloud/surfels/neighbours.hpp"

namespace scancast {

namespace {

constexpr float outlierFactor = 4;
constexpr std::size_t groupsPerTask = 512;

/// One for each thread, for as long as it lives: kernels never wait, so nobody else uses it meanwhile.
surfel::SearchScratch& workspace() {
    thread_local const auto mine = std::make_unique<surfel::SearchScratch>();
    return *mine;
}

class Estimate {
  public:
    Estimate(std::span<const glm::vec3> points, const SurfelOptions& options, std::span<Surfel> out,
             const surfel::SurfelKernels& kernels)
        : out_(out),
          k_(std::clamp(options.neighbours, 1, surfel::maxNeighbours)),
          index_(points),
          kernels_(kernels) {}

    void run() {
        if (index_.size() < 2) return std::fill(out_.begin(), out_.end(), Surfel{});
        facts_.resize(index_.size());
        forGroups([&](std::size_t begin, std::size_t end) { solve(begin, end); });
        leafLeast_.resize(index_.leaves().size() - 1);
        tbb::parallel_for(std::size_t(0), leafLeast_.size(), [&](std::size_t leaf) {
            float least = std::numeric_limits<float>::infinity();
            for (std::uint32_t p = index_.leaves()[leaf]; p < index_.leaves()[leaf + 1]; ++p)
                least = std::min(least, facts_[p].radius);
            leafLeast_[leaf] = least;
        });
        forGroups([&](std::size_t begin, std::size_t end) { markOutliers(begin, end); });
    }

  private:
    /// What the outlier rule wants to know of every position.
    struct Facts {
        float radius, reach2;
        std::uint8_t neighbours;
    };

    template <class F>
    void forGroups(const F& f) {
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, index_.groups().size() - 1, groupsPerTask),
            [&](const tbb::blocked_range<std::size_t>& range) { f(range.begin(), range.end()); });
    }

    void solve(std::size_t begin, std::size_t end) {
        kernels_.solve(
            index_.view(), index_.groups().data() + begin, std::uint32_t(end - begin), k_, workspace(),
            [](void* self, const surfel::Solved& s) { static_cast<Estimate*>(self)->store(s); }, this);
    }

    void store(const surfel::Solved& s) {
        facts_[s.point] = {s.radius, s.reach2, std::uint8_t(s.neighbours)};
        Surfel surfel;
        surfel.normal = glm::vec3(s.normal[0], s.normal[1], s.normal[2]);
        surfel.majorAxis = glm::vec3(s.axis[0], s.axis[1], s.axis[2]);
        surfel.major = std::sqrt(s.reach2);
        surfel.minor = surfel.major * std::max(float(std::sqrt(s.ratio)), leastSurfelRatio);
        surfel.radius = s.radius;
        for (const std::uint32_t i : index_.pointsAt(s.point))
            if (i < out_.size()) out_[i] = surfel;
    }

    bool isWanted(std::uint32_t p) const {
        for (const std::uint32_t i : index_.pointsAt(p))
            if (i < out_.size()) return true;
        return false;
    }

    /// Nobody is an outlier where no radius nearby is that much smaller; only where one is, neighbours are
    /// looked up once more.
    void markOutliers(std::size_t begin, std::size_t end) {
        for (std::size_t g = begin; g < end; ++g) {
            const std::uint32_t first = index_.groups()[g], last = index_.groups()[g + 1];
            glm::vec3 low = index_.position(first), high = low;
            float reach2 = 0, radius = 0;
            for (std::uint32_t p = first; p < last; ++p) {
                const glm::vec3 here = index_.position(p);
                for (int a = 0; a < 3; ++a) {
                    low[a] = std::min(low[a], here[a]);
                    high[a] = std::max(high[a], here[a]);
                }
                reach2 = std::max(reach2, facts_[p].reach2);
                radius = std::max(radius, facts_[p].radius);
            }
            const float least = kernels_.least(index_.view(), leafLeast_.data(), &low.x, &high.x, reach2);
            if (!(radius > outlierFactor * least)) continue;
            for (std::uint32_t p = first; p < last; ++p)
                if (facts_[p].radius > outlierFactor * least && isWanted(p) && isOutlier(p, workspace()))
                    for (const std::uint32_t i : index_.pointsAt(p))
                        if (i < out_.size()) out_[i].outlier = true;
        }
    }

    /// More than half of the neighbours (of an even number: half) have a radius that much smaller: then so
    /// has the (lower) median.
    bool isOutlier(std::uint32_t p, surfel::SearchScratch& w) const {
        const int m = kernels_.nearest(index_.view(), p, facts_[p].neighbours, w);
        int smaller = 0;
        for (int j = 1; j <= m; ++j) smaller += facts_[p].radius > outlierFactor * facts_[w.best[j]].radius;
        return smaller > (m - 1) / 2;
    }

    std::span<Surfel> out_;
    int k_;
    NeighbourIndex index_;
    const surfel::SurfelKernels& kernels_;
    std::vector<Facts> facts_;
    std::vector<float> leafLeast_;
};

}  // namespace

void estimateSurfels(std::span<const glm::vec3> points, const SurfelOptions& options, std::span<Surfel> out,
                     const surfel::SurfelKernels& kernels) {
    Estimate(points, options, out, kernels).run();
}

void estimateSurfels(std::span<const glm::vec3> points, const SurfelOptions& options, std::span<Surfel> out) {
    estimateSurfels(points, options, out, surfelKernels());
}

}  // namespace scancast
