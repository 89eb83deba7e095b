// Reads an uncompressed LAS file front to back through one bounded buffer: never slurped, never mapped.
// Pipeline: bytes → header → records → **points** → octree. Owned and used by one thread.
//
// Works on anything that yields bytes. A file (it has a size) is checked as a whole when it is opened: a
// truncated one fails then. Standard input fails where it ends.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/cloud/import/byte_source.hpp"
#include "renderer/cloud/import/las/las_columns.hpp"
#include "renderer/cloud/import/las/las_decode.hpp"
#include "renderer/cloud/import/las/las_header.hpp"
#include "renderer/cloud/import/las/las_vlrs.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

class LasSource final : public PointSource {
  public:
    /// `bytes` stands at the start of the file; `name` is what messages call it. `keepAttributes`: fill
    /// ScanHeader::columns and PointBatch::rows. `fullColors`: with colours of 16 bits among them.
    static Expected<std::unique_ptr<LasSource>> create(std::unique_ptr<ByteSource> bytes, std::string name,
                                                       bool keepAttributes = false, bool fullColors = false);

    const ScanHeader& header() const override { return scan_; }
    Expected<PointBatch> glance() override;
    Expected<bool> read(PointBatch& batch) override;
    std::uint64_t droppedPoints() const override { return dropped_; }
    std::array<std::uint64_t, 2> bytesRead() const override;

  private:
    LasSource(std::unique_ptr<ByteSource> bytes, std::string name, LasHeader header);

    Expected<void> readToPoints(std::uint64_t at);
    Expected<void> checkExtent();
    Expected<void> readEvlrs();
    void understandRecords();
    Expected<void> judgeColors();
    Expected<void> judgeBatchColors(std::span<const std::byte> records);
    std::uint64_t pointsEnd() const { return las_.pointOffset + las_.points * las_.recordBytes; }
    Error truncated(std::uint64_t at, std::uint64_t complete) const;

    std::unique_ptr<ByteSource> bytes_;
    std::string name_;
    LasHeader las_;
    ScanHeader scan_;
    LasVlrs vlrs_;
    bool keepAttributes_ = false, fullColors_ = false;
    std::vector<LasColumn> columns_;  ///< that are kept
    LasColorDepth depth_ = LasColorDepth::Unknown;
    bool depthIsCertain_ = false;  ///< the whole file was looked at
    bool alwaysFinite_ = false;    ///< no record can overflow to infinity
    std::vector<std::byte> buffer_;
    std::uint64_t done_ = 0;  ///< records read
    std::uint64_t dropped_ = 0;
};

}  // namespace scancast
