#include "renderer/cloud/import/las/las_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast {

Error noFinitePoint(const std::string& name, std::uint64_t points) {
    return {ErrorCode::Empty,
            (name.empty() ? std::string() : name + ": ") + "none of its " + grouped(points) +
                " points has finite coordinates",
            {}};
}

LasReader::LasReader(const LasHeader& las, std::string name, bool keepAttributes)
    : name_(std::move(name)),
      las_(las),
      scan_(scanHeader(las)),
      keepAttributes_(keepAttributes),
      alwaysFinite_(std::isfinite(las.grid().reach())) {}

Expected<LasReader> LasReader::create(std::span<const std::byte> start, std::string name,
                                      bool keepAttributes) {
    const auto header = parseLasHeader(start, name);
    if (!header) return passOn(header);
    return LasReader(*header, std::move(name), keepAttributes);
}

void LasReader::setPoints(std::uint64_t points) {
    las_.points = points;
    scan_.points = points;
}

void LasReader::understand() {
    scan_.crsWkt = std::move(vlrs_.crs.wkt);
    scan_.crsEpsg = vlrs_.crs.epsg ? vlrs_.crs.epsg : epsgOfWkt(scan_.crsWkt);
    if (!keepAttributes_) return;
    columns_ = lasColumns(las_, vlrs_.extraBytes, fullColors_);
    scan_.columns.clear();
    for (const auto& column : columns_) scan_.columns.push_back(column.column);
}

std::vector<std::string> LasReader::notes() const {
    if (!lasRecordLayout(las_.pointFormat).waveform) return {};
    return {fmt::format("its points are all read, their waveforms (point format {}) are passed over",
                        las_.pointFormat)};
}

void LasReader::see(std::span<const std::byte> records) {
    if (wantsToSeeMore()) depth_ = std::max(depth_, colorDepth(records, las_));
}

void LasReader::hasBeenTold(std::uint16_t highest) {
    depth_ = highest > 255 ? LasColorDepth::SixteenBits : LasColorDepth::EightBits;  // black is black in both
    wasTold_ = true;
}

/// What cannot be looked at first: its first colours decide, and a contradiction later is an error.
Expected<void> LasReader::judgeColors(std::span<const std::byte> records) {
    if (depthIsCertain_ || !wantsToSeeMore()) return {};
    const auto found = colorDepth(records, las_);
    if (depth_ == LasColorDepth::EightBits && found == LasColorDepth::SixteenBits)
        return fail(wasTold_ ? ErrorCode::Importer : ErrorCode::Unsupported,
                    wasTold_ ? "its point stream says that no colour is above 255, and one is"
                             : lasSubject(name_) + ": the colours of the first " + grouped(done_) +
                                   " points have 8 bits, later ones 16; which of them is meant can only be "
                                   "told from a file: save the scan to a file and open that");
    depth_ = std::max(depth_, found);
    return {};
}

Expected<void> LasReader::decode(std::span<const std::byte> records, PointBatch& batch) {
    if (auto ok = judgeColors(records); !ok) return ok;
    decodeLasRecords(records, las_, depth_, batch);
    if (keepAttributes_) decodeLasColumns(records, las_.recordBytes, columns_, batch.rows);
    done_ += batch.size();
    if (!alwaysFinite_) dropped_ += dropNonFinite(batch);
    return {};
}

void LasReader::glance(std::span<const std::byte> records, PointBatch& batch) const {
    decodeLasRecords(records, las_, depth_, batch);
    if (!alwaysFinite_) dropNonFinite(batch);
}

Expected<void> LasReader::checkEnd() const {
    if (dropped_ == 0 || dropped_ < done_) return {};
    return tl::unexpected(noFinitePoint(name_, done_));
}

}  // namespace scancast
