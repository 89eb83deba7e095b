// Staged batches as they stand on the grid. Pipeline: staging → **portions** → counting grid, chunks.
#pragma once

#include "renderer/cloud/build/chunks/chunk_sorting.hpp"
#include "renderer/cloud/build/chunks/staging.hpp"

namespace scancast {

/// Of what is referred to, all of which outlives it.
class StagedPortions final : public PointPortions {
  public:
    StagedPortions(StagedScan& scan, const ScanHeader& header, const Grid& grid)
        : scan_(scan), header_(header), grid_(grid) {}

    std::size_t size() const override { return scan_.batches.size(); }
    Expected<void> read(std::size_t index, Portion& into) const override {
        thread_local std::vector<std::byte> space;
        const StagedBatch& batch = scan_.batches[index];
        const auto bytes = batch.bytes.view(space);
        if (!bytes) return passOn(bytes);
        into.points.resize(batch.points);
        placeOnGrid(batch, *bytes, scan_, header_, grid_, into.points);
        const auto rows = rowsOf(batch, *bytes);
        into.rows.assign(rows.begin(), rows.end());
        return {};
    }
    void release(std::size_t index) override { scan_.batches[index].bytes.clear(); }

  private:
    StagedScan& scan_;
    const ScanHeader& header_;
    const Grid& grid_;
};

}  // namespace scancast
