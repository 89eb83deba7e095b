// What the bytes of LAS mean: head, records and point records → batches. The one place that knows; where the bytes come
// from is somebody else's: a file or a pipe (LasSource), an importer that took LAZ apart (PointStreamReader).
// Pipeline: bytes → **header → records** → points. Owned and used by one thread.
//
// Use: create(), the variable length records as far as there are any, understand(), then records in their order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "renderer/cloud/import/las/las_columns.hpp"
#include "renderer/cloud/import/las/las_decode.hpp"
#include "renderer/cloud/import/las/las_header.hpp"
#include "renderer/cloud/import/las/las_vlrs.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// What is wrong with a scan of so many points, all of which were left out.
Error noFinitePoint(const std::string& name, std::uint64_t points);

class LasReader {
  public:
    /// `start`, `name`, errors: as of parseLasHeader(). `keepAttributes`: fill ScanHeader::columns and PointBatch::rows.
    static Expected<LasReader> create(std::span<const std::byte> start, std::string name,
                                      bool keepAttributes = false);

    /// Before understand(): colours of 16 bits are columns, too (exact_columns.hpp).
    void keepFullColors() { fullColors_ = true; }

    const LasHeader& las() const { return las_; }
    /// What messages call the file; may be empty.
    const std::string& name() const { return name_; }
    std::uint64_t points() const { return las_.points; }
    /// There are other than promised: of a file whose end is missing, so many whole records.
    void setPoints(std::uint64_t points);

    /// What lies between header and points; may end early.
    void takeVlrs(std::span<const std::byte> bytes) { readVlrs(bytes, las_.vlrs, vlrs_); }
    /// One extended record's content.
    void takeEvlr(const EvlrHead& head, std::span<const std::byte> content) {
        readVlr(head.userId, head.recordId, content, vlrs_);
    }
    /// Extended records one behind the other; as far as they reach.
    void takeEvlrs(std::span<const std::byte> bytes) { readEvlrs(bytes, vlrs_); }
    /// Once all of those are there.
    void understand();
    const ScanHeader& header() const { return scan_; }
    /// All that its records hold besides the sample, whatever is kept: colours of 16 bits, too. Once understood.
    std::vector<LasColumn> allColumns() const { return lasColumns(las_, vlrs_.extraBytes, true); }
    /// As in PointSource; once understood.
    std::vector<std::string> notes() const;

    /// Colours have 8 or 16 bits, and only all of them can tell: does looking at more records tell more?
    bool wantsToSeeMore() const { return scan_.attributes.color && depth_ != LasColorDepth::SixteenBits; }
    /// Any records, before they are decoded.
    void see(std::span<const std::byte> records);
    /// Of what has been seen: not the number itself, but one that hasBeenTold() understands.
    std::uint16_t highestColor() const {
        return depth_ == LasColorDepth::SixteenBits ? 65535 : depth_ == LasColorDepth::EightBits ? 255 : 0;
    }
    /// All of them have been seen.
    void hasSeenAll() { depthIsCertain_ = true; }
    /// Somebody else has seen all of them: the highest number of any colour, or one above 255.
    void hasBeenTold(std::uint16_t highest);

    /// The next records, whole ones, at most PointSource::batchPoints. The batch may stay empty: none had finite
    /// coordinates. Errors: Unsupported for colours of 16 bits behind some of 8 (if not all were seen).
    Expected<void> decode(std::span<const std::byte> records, PointBatch& batch);
    /// Some records out of their order, to look at; without rows, and they count for nothing.
    void glance(std::span<const std::byte> records, PointBatch& batch) const;
    std::uint64_t recordsRead() const { return done_; }
    std::uint64_t droppedPoints() const { return dropped_; }
    /// To be asked at the end. Errors: Empty, because all points were dropped.
    Expected<void> checkEnd() const;

  private:
    LasReader(const LasHeader& las, std::string name, bool keepAttributes);
    Expected<void> judgeColors(std::span<const std::byte> records);

    std::string name_;
    LasHeader las_;
    ScanHeader scan_;
    LasVlrs vlrs_;
    bool keepAttributes_ = false, fullColors_ = false;
    std::vector<LasColumn> columns_;  ///< that are kept
    LasColorDepth depth_ = LasColorDepth::Unknown;
    bool depthIsCertain_ = false;
    bool wasTold_ = false;      ///< by somebody who may be wrong
    bool alwaysFinite_ = true;  ///< no record can overflow to infinity
    std::uint64_t done_ = 0;
    std::uint64_t dropped_ = 0;
};

}  // namespace scancast
