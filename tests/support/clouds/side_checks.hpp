// How many samples' normals point to the right side: a cloud with its scan's own normals against the same cloud
// whose normals were dropped and found again. Both octrees are the same but for normals, so samples are compared
// one by one. Used by tests and by tests/bench/bench_orientation.cpp.
#pragma once

#include <glm/geometric.hpp>
#include <tuple>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/point_batch.hpp"
#include "renderer/cloud/surfel_bytes.hpp"

namespace scancast::test {

/// A scan as if it had no normals, and nobody knew where it was made from.
class WithoutNormals final : public PointSource {
  public:
    explicit WithoutNormals(PointSource& scan, bool upIsZ = false) : scan_(scan), header_(scan.header()) {
        header_.attributes.normal = false;
        header_.scannerOrigin.reset();
        if (upIsZ) header_.crsEpsg = 32632;
    }
    const ScanHeader& header() const override { return header_; }
    Expected<bool> read(PointBatch& batch) override {
        auto more = scan_.read(batch);
        batch.normal.clear();
        return more;
    }
    std::uint64_t droppedPoints() const override { return scan_.droppedPoints(); }
    std::vector<std::string> notes() const override { return scan_.notes(); }

  private:
    PointSource& scan_;
    ScanHeader header_;
};

struct SideScore {
    std::uint64_t samples = 0, right = 0;     ///< with normals in both
    std::uint64_t sure = 0, sureWrong = 0;    ///< in nodes that are drawn as oriented
    std::uint64_t clear = 0, clearRight = 0;  ///< whose normals are the same within 45°, but for the side
    double share() const { return samples ? double(right) / double(samples) : 0; }
    double sureShare() const { return samples ? double(sure) / double(samples) : 0; }
    double wrongOfSure() const { return sure ? double(sureWrong) / double(sure) : 0; }
};

/// `truth(position, found)` gives the normal that a sample should have, cloud-relative; (0,0,0): nobody knows.
template <class Truth>
SideScore scoreSides(const Cloud& cloud, bool leaves, Truth truth) {
    SideScore score;
    for (std::uint32_t i = 0; i < cloud.octree.nodes().size(); ++i) {
        const Node& node = cloud.octree.node(i);
        if (node.isLeaf() != leaves) continue;
        const auto run = cloud.octree.run(i);
        for (std::size_t s = 0; s < run->samples.size(); ++s) {
            const glm::vec3 found = decodeNormal(run->samples[s].normal);
            const glm::vec3 right = truth(node, i, s, run->samples[s]);
            if (found == glm::vec3(0) || right == glm::vec3(0)) continue;
            const float along = glm::dot(found, right);
            ++score.samples;
            score.right += along > 0;
            if (node.confidence >= sureSide && run->samples[s].ellipse != twoSidedCircle) {
                ++score.sure;
                score.sureWrong += along <= 0;
            }
            if (std::abs(along) < 0.7f * glm::length(right)) continue;
            ++score.clear;
            score.clearRight += along > 0;
        }
    }
    return score;
}

/// Leaves against those of a cloud of the same points with normals: the same octree. Of those for which
/// `counts(node, sample, right normal)`.
template <class Counts>
SideScore scoreSides(const Cloud& cloud, const Cloud& truth, Counts counts) {
    std::vector<SampleRun> runs;
    std::uint32_t node = noNode;
    return scoreSides(cloud, true, [&](const Node& at, std::uint32_t i, std::size_t s, const Sample& sample) {
        if (i != node) {
            runs.assign(1, *truth.octree.run(i));
            node = i;
        }
        const glm::vec3 right = decodeNormal(runs[0].samples[s].normal);
        return counts(at, sample, right) ? right : glm::vec3(0);
    });
}

inline SideScore scoreSides(const Cloud& cloud, const Cloud& truth) {
    return scoreSides(cloud, truth, [](const Node&, const Sample&, const glm::vec3&) { return true; });
}

}  // namespace scancast::test
