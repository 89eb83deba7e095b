// The part of a scan that is wanted: a box, classes. Pipeline: points → **region** → writer. Plain values; the source is
// owned and used by one thread.
#pragma once

#include <bitset>
#include <memory>
#include <optional>

#include "protocol/view/view.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

struct ExportRegion {
    std::optional<ClipBox> clip{};              ///< file coordinates, its faces included
    std::optional<std::bitset<256>> classes{};  ///< points without a class have 0

    bool isEverything() const { return !clip && !classes; }
};

/// Takes out what is not in the region, of a batch with rows of so many bytes.
void keepWithin(const ExportRegion& region, std::size_t rowBytes, PointBatch& batch);

/// `source` itself for everything. Else nobody knows how many points there will be, and where.
std::unique_ptr<PointSource> within(const ExportRegion& region, std::unique_ptr<PointSource> source);

}  // namespace scancast
