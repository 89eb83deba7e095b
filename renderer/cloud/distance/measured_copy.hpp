// A cloud file written once more, each node as it is, with the distances of its points beside them. Pipeline: cloud file, earlier points →
// **copy** → cloud file. Owned and used by one thread; nodes are measured by several.
//
// Nodes are written children first, those of one subtree after the other; so at any time a few million points are in memory, and what
// comes where does not depend on how many.
#pragma once

#include <memory>
#include <stop_token>
#include <vector>

#include "renderer/cloud/build/progress_meter.hpp"
#include "renderer/cloud/distance/distance_column.hpp"
#include "renderer/cloud/distance/earlier_points.hpp"
#include "renderer/cloud/distance/inner_values.hpp"
#include "renderer/cloud/file/cloud_file_writer.hpp"

namespace scancast {

struct MeasuredCopyOptions {
    Column column;
    double most = 0;                ///< as leafDistances()
    std::uint64_t chunkPoints = 0;  ///< points in memory at once, but for single leaves with more
};

class MeasuredCopy {
  public:
    /// All outlive this. The cloud has no column and no companion of those names.
    MeasuredCopy(const CloudFile& cloud, const EarlierPoints& earlier, MeasuredCopyOptions options,
                 CloudFileWriter& writer);
    ~MeasuredCopy();

    /// Everything, once; the facts that the new file has. Reports the stage "measuring". Errors: the files'; Cancelled.
    Expected<CloudFacts> write(const ProgressSink& progress, const std::stop_token& stop);
    /// As far as it was written.
    const DistanceSummary& summary() const { return summary_; }
    KeptColumn column() const;

  private:
    struct Packed;
    class Digest;

    Expected<ValuedSamples> writeSubtree(std::uint32_t node);
    Expected<ValuedSamples> measure(std::uint32_t node, std::span<Packed> packed);
    Expected<ValuedSamples> measureLeaf(std::uint32_t node, Packed& packed);
    Expected<ValuedSamples> valueInner(std::uint32_t node, std::span<const ValuedSamples> below,
                                       Packed& packed);
    Expected<std::vector<Sample>> copyNode(std::uint32_t node, Packed& packed) const;
    Expected<void> append(std::span<Packed> packed);
    CloudFacts factsOfCopy() const;

    const CloudFile& cloud_;
    const EarlierPoints& earlier_;
    const MeasuredCopyOptions options_;
    CloudFileWriter& writer_;
    const ExactPlaces places_;
    const std::size_t planes_;            ///< of the new file
    std::vector<std::uint32_t> subtree_;  ///< nodes in and below each node
    std::vector<StoredNode> nodes_;
    std::vector<BlockPlace> planePlaces_;
    DistanceSummary summary_;
    std::unique_ptr<Digest> digest_;
    std::unique_ptr<ProgressMeter> meter_;
    std::stop_token stop_;
};

}  // namespace scancast
