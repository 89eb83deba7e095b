// Reads an uncompressed LAS file front to back through one bounded buffer: never slurped, never mapped. What its bytes
// mean, LasReader knows. Pipeline: bytes → header → records → **points** → octree. Owned and used by one thread.
//
// Works on anything that yields bytes. A file (it has a size) is checked as a whole when it is opened: a
// truncated one fails then. Standard input fails where it ends.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/cloud/import/byte_source.hpp"
#include "renderer/cloud/import/las/las_reader.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

class LasSource final : public PointSource {
  public:
    /// `bytes` stands at the start of the file; `name` is what messages call it. `keepAttributes`: fill
    /// ScanHeader::columns and PointBatch::rows; `fullColors`: with colours of 16 bits among them. `recover`: of points
    /// that the bytes end before, those that are whole are all, and a note tells of the rest.
    /// `looksInParts`: as in ImportOptions.
    static Expected<std::unique_ptr<LasSource>> create(std::unique_ptr<ByteSource> bytes, std::string name,
                                                       bool keepAttributes = false, bool recover = false,
                                                       bool fullColors = false, bool looksInParts = false);

    const ScanHeader& header() const override { return reader_.header(); }
    Expected<PointBatch> glance() override;
    /// Of files.
    bool hasParts() const override { return bytes_->size().has_value(); }
    void readPart(std::uint64_t first, std::uint64_t count) override { part_ = {first, count}; }
    bool wantsToBeSeen() const override { return isUnseen_; }
    Expected<std::uint16_t> lookAt(std::uint64_t first, std::uint64_t count) override;
    void hasSeen(std::uint16_t highest) override;
    Expected<bool> read(PointBatch& batch) override;
    std::uint64_t droppedPoints() const override { return reader_.droppedPoints(); }
    std::vector<std::string> notes() const override;
    std::array<std::uint64_t, 2> bytesRead() const override;

  private:
    LasSource(std::unique_ptr<ByteSource> bytes, LasReader reader)
        : bytes_(std::move(bytes)), reader_(std::move(reader)) {}

    Expected<void> readToPoints(std::uint64_t at);
    Expected<void> checkExtent();
    Expected<void> readEvlrs();
    Expected<void> lookAtColors(bool inParts);
    Expected<void> see(std::uint64_t first, std::uint64_t count);
    const LasHeader& las() const { return reader_.las(); }
    const std::string& name() const { return reader_.name(); }
    std::uint64_t placeOf(std::uint64_t record) const {
        return las().pointOffset + record * las().recordBytes;
    }
    std::uint64_t endOfPart() const;
    std::uint64_t pointsEnd() const { return placeOf(las().points); }
    Error truncated(std::uint64_t at, std::uint64_t complete) const;
    void loseAllBut(std::uint64_t complete);

    std::unique_ptr<ByteSource> bytes_;
    LasReader reader_;
    struct Part {
        std::uint64_t first = 0, count = 0;
    };
    std::optional<Part> part_;  ///< of the records that alone are read
    bool recover_ = false, isUnseen_ = false;
    std::uint64_t lost_ = 0;  ///< points that are promised and not there
    std::vector<std::byte> buffer_;
};

}  // namespace scancast
