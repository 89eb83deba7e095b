#include "renderer/cloud/surfels/surfels.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/combinable.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "renderer/cloud/surfels/evidence.hpp"
#include "renderer/cloud/surfels/kernels/levels.hpp"
#include "renderer/cloud/surfels/layers.hpp"
#include "renderer/cloud/surfels/neighbours.hpp"
#include "renderer/cloud/surfels/patches.hpp"
#include "renderer/cloud/surfels/shape_operator.hpp"
#include "renderer/cloud/surfels/strays.hpp"

namespace scancast {

namespace {

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
          spacings_(options.spacings),
          patches_(options.patches),
          layers_(options.layers),
          bends_(options.bends),
          k_(std::clamp(options.neighbours, 1, surfel::maxNeighbours)),
          index_(points),
          evidence_(index_),
          kernels_(kernels) {}

    void run() {
        if (index_.size() < 2) {
            std::fill(out_.begin(), out_.end(), Surfel{});
            if (patches_) patches_->of.assign(out_.size(), noPatch);
            return;
        }
        forGroups([&](std::size_t begin, std::size_t end) { solve(begin, end); });
        forGroups([&](std::size_t begin, std::size_t end) {
            for (std::uint32_t p = index_.groups()[begin]; p < index_.groups()[end]; ++p) judge(p);
        });
        if (layers_) seeThroughLayers(index_, evidence_, out_);
        if (bends_)
            forGroups([&](std::size_t begin, std::size_t end) {
                estimateBends(index_.groups()[begin], index_.groups()[end], index_, evidence_, out_);
            });
        markStrays();
        if (patches_) *patches_ = findPatches(index_, evidence_, out_);
    }

  private:
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
        evidence_.add(s);
        Surfel surfel;
        surfel.normal = glm::vec3(s.normal[0], s.normal[1], s.normal[2]);
        surfel.majorAxis = glm::vec3(s.axis[0], s.axis[1], s.axis[2]);
        surfel.major = std::sqrt(s.reach2);
        surfel.minor = surfel.major * std::max(float(std::sqrt(s.ratio)), leastSurfelRatio);
        surfel.radius = s.radius;
        surfel.nearby = s.nearby;
        for (const std::uint32_t i : index_.pointsAt(s.point))
            if (i < out_.size()) out_[i] = surfel;
    }

    /// What only can be said when all neighbourhoods are known.
    void judge(std::uint32_t p) {
        float spacing = std::numeric_limits<float>::infinity();
        bool wanted = false;
        for (const std::uint32_t i : index_.pointsAt(p)) {
            if (i >= out_.size()) continue;
            wanted = true;
            spacing = std::min(spacing, spacings_.empty() ? 0 : spacings_[i]);
        }
        if (!wanted) return;
        const float usual = evidence_.usualRadius(p);
        const Density density = evidence_.density(p, spacing);
        const float rough = density == Density::Foliage ? evidence_.rough(p) : 0;
        for (const std::uint32_t i : index_.pointsAt(p))
            if (i < out_.size()) {
                out_[i].usual = usual;
                out_[i].density = density;
                out_[i].rough = rough;
            }
    }

    void markStrays() {
        tbb::combinable<std::vector<std::uint32_t>> found;
        forGroups([&](std::size_t begin, std::size_t end) {
            findStrays(index_.groups()[begin], index_.groups()[end], index_, evidence_, kernels_, workspace(),
                       found.local());
        });
        found.combine_each([&](const std::vector<std::uint32_t>& strays) {
            for (const std::uint32_t p : strays)
                for (const std::uint32_t i : index_.pointsAt(p))
                    if (i < out_.size()) {
                        out_[i].density = Density::Stray;
                        out_[i].outlier = true;
                    }
        });
    }

    std::span<Surfel> out_;
    std::span<const float> spacings_;
    SidePatches* patches_;
    bool layers_, bends_;
    int k_;
    NeighbourIndex index_;
    Evidence evidence_;
    const surfel::SurfelKernels& kernels_;
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
