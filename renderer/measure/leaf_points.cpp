#include "renderer/measure/leaf_points.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/common.hpp>
#include <vector>

#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/file/exact_places.hpp"
#include "renderer/cloud/surfel_bytes.hpp"
#include "renderer/pick/pick.hpp"

namespace scancast {
namespace {

constexpr std::size_t remoteBlocks = 16;

bool isWithin(const glm::dvec3& p, const MeasuredBox& box) {
    for (int a = 0; a < 3; ++a)
        if (!(p[a] >= box.low[a] && p[a] <= box.high[a])) return false;
    return true;
}

std::vector<std::uint32_t> leavesNear(const Cloud& cloud, const MeasuredBox& box) {
    std::vector<std::uint32_t> leaves, open;
    if (!cloud.octree.nodes().empty()) open.push_back(0);
    while (!open.empty()) {
        const std::uint32_t index = open.back();
        open.pop_back();
        const Node& node = cloud.octree.node(index);
        // Positions on the scan's grid may lie a step beside what the samples say.
        const glm::dvec3 margin = node.step + 1e-9 * (glm::abs(node.boxMax) + glm::abs(cloud.origin));
        const glm::dvec3 low = cloud.origin + node.boxMin - margin,
                         high = cloud.origin + node.boxMax + margin;
        bool apart = false;
        for (int a = 0; a < 3; ++a) apart = apart || low[a] > box.high[a] || high[a] < box.low[a];
        if (apart) continue;
        if (node.isLeaf()) leaves.push_back(index);
        for (std::uint32_t c = node.childCount; c-- > 0;) open.push_back(node.firstChild + c);
    }
    return leaves;
}

std::shared_ptr<const CloudFile> fileUnder(const Cloud& cloud) {
    return cloud.octree.nodes().empty() ? nullptr : cloud.octree.store().cloudFile();
}

class LeafReader {
  public:
    LeafReader(const Cloud& cloud, const SampleFilter& filter, const MeasuredBox& box, const UsePoints& use)
        : cloud_(cloud),
          filter_(filter),
          box_(box),
          use_(use),
          file_(fileUnder(cloud)),
          exact_(cloud, file_.get()) {}

    const CloudFile* file() const { return file_.get(); }

    Expected<void> take(std::uint32_t leaf, std::span<const Sample> samples) {
        if (auto ok = find(leaf, samples, places_); !ok) return ok;
        use(places_);
        return {};
    }
    void use(std::span<const glm::dvec3> places) const {
        if (!places.empty()) use_(places);
    }

    /// The places of those that count. From any thread.
    Expected<void> find(std::uint32_t leaf, std::span<const Sample> samples,
                        std::vector<glm::dvec3>& places) const {
        const Node& node = cloud_.octree.node(leaf);
        places.resize(samples.size());
        if (auto ok = exact_.of(leaf, node, samples, places); !ok) return ok;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const Sample& sample = samples[i];
            if (!isWithin(places[i], box_)) continue;
            if (!filter_.outliers && cloud_.surfels && sample.logRadius == outlierRadius) continue;
            if (!isDrawn(filter_, position(node, sample), sample)) continue;
            places[kept++] = places[i];
        }
        places.resize(kept);
        return {};
    }

  private:
    const Cloud& cloud_;
    const SampleFilter& filter_;
    const MeasuredBox& box_;
    const UsePoints& use_;
    const std::shared_ptr<const CloudFile> file_;  ///< null: in memory
    const ExactPlaces exact_;
    std::vector<glm::dvec3> places_;
};

tl::unexpected<Error> abandoned() {
    return fail(ErrorCode::Cancelled, "The measurement was abandoned.");
}

/// Of a file on this machine: blocks are read and decoded side by side, and used one after the other.
Expected<void> takeSideBySide(LeafReader& reader, std::span<const std::uint32_t> leaves,
                              const std::stop_token& stop, std::size_t atOnce) {
    std::vector<std::vector<glm::dvec3>> places(atOnce);
    std::vector<Expected<void>> found(atOnce);
    for (std::size_t first = 0; first < leaves.size(); first += atOnce) {
        if (stop.stop_requested()) return abandoned();
        const auto some = leaves.subspan(first, std::min(atOnce, leaves.size() - first));
        tbb::parallel_for(std::size_t(0), some.size(), [&](std::size_t i) {
            const auto samples = reader.file()->samples(some[i]);
            found[i] = samples ? reader.find(some[i], *samples, places[i]) : passOn(samples);
        });
        for (std::size_t i = 0; i < some.size(); ++i) {
            if (!found[i]) return found[i];
            reader.use(places[i]);
        }
    }
    return {};
}

}  // namespace

Expected<void> forLeafPoints(const Cloud& cloud, const SampleFilter& filter, const MeasuredBox& box,
                             const std::stop_token& stop, const UsePoints& use, int atOnce) {
    LeafReader reader(cloud, filter, box, use);
    const std::vector<std::uint32_t> leaves = leavesNear(cloud, box);
    if (const CloudFile* file = reader.file(); file != nullptr && !file->isRemote()) {
        if (atOnce > 1) return takeSideBySide(reader, leaves, stop, std::size_t(atOnce));
        for (const std::uint32_t leaf : leaves) {
            if (stop.stop_requested()) return abandoned();
            const auto samples = file->samples(leaf);
            if (!samples) return passOn(samples);
            if (auto ok = reader.take(leaf, *samples); !ok) return ok;
        }
        return {};
    }
    for (std::size_t first = 0; first < leaves.size(); first += remoteBlocks) {
        const auto some = std::span(leaves).subspan(first, std::min(remoteBlocks, leaves.size() - first));
        if (stop.stop_requested()) return abandoned();
        auto runs = cloud.octree.store().loadAll(some, stop);
        runs.resize(some.size());
        for (std::size_t i = 0; i < some.size(); ++i) {
            // Where others draw a node, loadAll() has nothing of it (node_share.hpp).
            if (runs[i] && runs[i]->samples.empty()) runs[i] = cloud.octree.store().load(some[i], stop);
            if (!runs[i]) return passOn(std::move(runs[i]));
            if (auto ok = reader.take(some[i], runs[i]->samples); !ok) return ok;
        }
    }
    return {};
}

std::uint64_t pointsNear(const Cloud& cloud, const MeasuredBox& box) {
    std::uint64_t points = 0;
    for (const std::uint32_t leaf : leavesNear(cloud, box)) points += cloud.octree.node(leaf).sampleCount;
    return points;
}

}  // namespace scancast
