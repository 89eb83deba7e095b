#include "renderer/cloud/import/las/las_source.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "files/bytes.hpp"
#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast {

namespace {

// One batch of the common formats fits (65,536 × 34 bytes); of the longest possible record, 64 do.
constexpr std::size_t bufferBytes = std::size_t(4) << 20;
// Variable length records are looked at this far: real files have kilobytes, waveform tables perhaps
// megabytes.
constexpr std::uint64_t longestVlrs = std::uint64_t(4) << 20;
constexpr std::uint32_t mostEvlrs = 1000;
constexpr std::uint64_t evlrHeaderBytes = 60;
// Places across the file where a first look at the colours is taken; any 16-bit file is found out by it.
constexpr std::uint64_t firstLooks = 16;
constexpr std::uint64_t firstLookRecords = 256;
// Places across the file that a glance takes points from. Smaller scans are read as fast.
constexpr std::uint64_t glances = 8192, glanceRecords = 6, fewestToGlanceAt = 1'000'000;

}  // namespace

LasSource::LasSource(std::unique_ptr<ByteSource> bytes, std::string name, LasHeader header)
    : bytes_(std::move(bytes)), name_(std::move(name)), las_(header), scan_(scanHeader(header)) {
    alwaysFinite_ = true;
    for (int i = 0; i < 3; ++i)
        alwaysFinite_ = alwaysFinite_ && std::isfinite(std::abs(las_.offset[i]) + 0x1p31 * las_.scale[i]);
}

Expected<std::unique_ptr<LasSource>> LasSource::create(std::unique_ptr<ByteSource> bytes, std::string name,
                                                       bool keepAttributes, bool fullColors) {
    std::array<std::byte, lasHeaderBytes> start{};
    const auto got = readFully(*bytes, start);
    if (!got) return passOn(got);
    auto header = parseLasHeader(std::span(start).first(*got), name);
    if (!header) return passOn(header);

    std::unique_ptr<LasSource> source(new LasSource(std::move(bytes), std::move(name), *header));
    source->keepAttributes_ = keepAttributes;
    source->fullColors_ = fullColors;
    if (auto ok = source->checkExtent(); !ok) return passOn(ok);
    // A header of LAS 1.0-1.3 is shorter than what was read: the rest belongs to the variable length records.
    if (source->bytes_->size()) {
        if (auto ok = source->bytes_->seek(header->headerBytes); !ok) return passOn(ok);
        if (auto ok = source->readToPoints(header->headerBytes); !ok) return passOn(ok);
        if (auto ok = source->readEvlrs(); !ok) return passOn(ok);
        if (auto ok = source->judgeColors(); !ok) return passOn(ok);
        if (auto ok = source->bytes_->seek(header->pointOffset); !ok) return passOn(ok);
    } else {
        source->buffer_.assign(start.begin(), start.begin() + static_cast<std::ptrdiff_t>(*got));
        if (auto ok = source->readToPoints(*got); !ok) return passOn(ok);
    }
    source->understandRecords();
    return source;
}

/// Reads what lies between header and points. A file was positioned at the end of its header; of a pipe, `at`
/// bytes were read and stand in the buffer, and they may reach into the points.
Expected<void> LasSource::readToPoints(std::uint64_t at) {
    std::vector<std::byte> early;
    std::vector<std::byte> records;
    if (!buffer_.empty()) {
        const auto split = std::min<std::uint64_t>(buffer_.size(), las_.pointOffset);
        const auto begin = std::min<std::uint64_t>(las_.headerBytes, split);
        records.assign(buffer_.begin() + static_cast<std::ptrdiff_t>(begin),
                       buffer_.begin() + static_cast<std::ptrdiff_t>(split));
        early.assign(buffer_.begin() + static_cast<std::ptrdiff_t>(split), buffer_.end());
    }
    std::vector<std::byte> piece(65536);
    while (at < las_.pointOffset) {
        if (bytes_->size() && records.size() >= longestVlrs) break;  // a file seeks over the rest
        const auto want = std::min<std::uint64_t>(piece.size(), las_.pointOffset - at);
        const auto got = readFully(*bytes_, std::span(piece).first(want));
        if (!got) return passOn(got);
        if (*got < want) return tl::unexpected(truncated(at + *got, 0));
        // Bytes of a header longer than we know are no records.
        const auto skip = std::min<std::uint64_t>(want, las_.headerBytes > at ? las_.headerBytes - at : 0);
        if (records.size() < longestVlrs)  // a pipe has to be read on, but not kept
            records.insert(records.end(), piece.begin() + static_cast<std::ptrdiff_t>(skip),
                           piece.begin() + static_cast<std::ptrdiff_t>(want));
        at += want;
    }
    readVlrs(records, las_.vlrs, vlrs_);
    buffer_ = std::move(early);
    return {};
}

/// Do the promised points fit into the file? Also keeps every later product of counts within 64 bits.
Expected<void> LasSource::checkExtent() {
    const auto size = bytes_->size();
    const auto room = std::numeric_limits<std::int64_t>::max() - las_.pointOffset;
    if (size && las_.pointOffset > *size)
        return fail(ErrorCode::Malformed, name_ + ", byte 96: the points are said to start at byte " +
                                              grouped(las_.pointOffset) + ", beyond the end of the file (" +
                                              grouped(*size) + " bytes)");
    if (size) {
        const auto there = (*size - las_.pointOffset) / las_.recordBytes;
        if (las_.points > there) return tl::unexpected(truncated(*size, there));
    } else if (las_.points > room / las_.recordBytes) {
        return fail(ErrorCode::Malformed,
                    name_ + ": " + grouped(las_.points) + " points are more than any file holds");
    }
    if (las_.evlrs > 0 && las_.evlrOffset >= las_.pointOffset && las_.evlrOffset < pointsEnd())
        return fail(ErrorCode::Malformed, name_ + ", byte 235: other records are said to start at byte " +
                                              grouped(las_.evlrOffset) +
                                              ", among the points (which end at byte " +
                                              grouped(pointsEnd()) + ")");
    return {};
}

/// LAS 1.4 may keep its records behind the points. Like all records: whatever is wrong with it harms no
/// point.
Expected<void> LasSource::readEvlrs() {
    const auto size = *bytes_->size();
    auto at = las_.evlrOffset;
    for (std::uint32_t i = 0; i < std::min(las_.evlrs, mostEvlrs) && at >= pointsEnd() && at < size; ++i) {
        std::array<std::byte, evlrHeaderBytes> head{};
        const auto got = bytes_->readAt(at, head);
        if (!got) return passOn(got);
        if (*got < head.size()) break;
        // reserved (2), user id (16), record id (2), length after this header (8), description (32)
        const auto length = loadLe<std::uint64_t>(head.data() + 20);
        at += head.size();
        if (length > size - at) break;
        const auto userId = std::span<const std::byte>(head).subspan(2, 16);
        const int recordId = loadLe<std::uint16_t>(head.data() + 18);
        if (isWantedVlr(userId, recordId) && length <= longestVlr) {
            std::vector<std::byte> content(length);
            const auto read = bytes_->readAt(at, content);
            if (!read) return passOn(read);
            if (*read == length) readVlr(userId, recordId, content, vlrs_);
        }
        at += length;
    }
    return {};
}

/// Once all records are read.
void LasSource::understandRecords() {
    scan_.crsWkt = std::move(vlrs_.crs.wkt);
    scan_.crsEpsg = vlrs_.crs.epsg ? vlrs_.crs.epsg : epsgOfWkt(scan_.crsWkt);
    if (!keepAttributes_) return;
    columns_ = lasColumns(las_, vlrs_.extraBytes, fullColors_);
    for (const auto& column : columns_) scan_.columns.push_back(column.column);
}

/// 8-bit colours in 16-bit fields: exact, because the whole file is looked at - until the first number above
/// 255, which in real 16-bit files is found at once. Only truly 8-bit files cost a second pass.
Expected<void> LasSource::judgeColors() {
    depthIsCertain_ = true;
    if (!scan_.attributes.color) return {};
    buffer_.resize(std::max<std::size_t>(bufferBytes, las_.recordBytes));
    const auto look = [&](std::uint64_t first, std::uint64_t count) -> Expected<void> {
        count = std::min({count, las_.points - first, std::uint64_t(buffer_.size() / las_.recordBytes)});
        const auto piece = std::span(buffer_).first(count * las_.recordBytes);
        const auto got = bytes_->readAt(las_.pointOffset + first * las_.recordBytes, piece);
        if (!got) return passOn(got);
        if (*got < piece.size())
            return tl::unexpected(truncated(las_.pointOffset + first * las_.recordBytes + *got, first));
        depth_ = std::max(depth_, colorDepth(piece, las_));
        return {};
    };
    const auto stride = std::max<std::uint64_t>(1, las_.points / firstLooks);
    for (std::uint64_t first = 0; first < las_.points && depth_ != LasColorDepth::SixteenBits;
         first += stride)
        if (auto ok = look(first, firstLookRecords); !ok) return ok;
    const auto atOnce = buffer_.size() / las_.recordBytes;
    for (std::uint64_t first = 0; first < las_.points && depth_ != LasColorDepth::SixteenBits;
         first += atOnce)
        if (auto ok = look(first, atOnce); !ok) return ok;
    buffer_.clear();
    return {};
}

/// A pipe cannot be looked at first: its first colours decide, and a contradiction later is an error.
Expected<void> LasSource::judgeBatchColors(std::span<const std::byte> records) {
    if (depthIsCertain_ || !scan_.attributes.color || depth_ == LasColorDepth::SixteenBits) return {};
    const auto found = colorDepth(records, las_);
    if (depth_ == LasColorDepth::EightBits && found == LasColorDepth::SixteenBits)
        return fail(
            ErrorCode::Unsupported,
            name_ + ": the colours of the first " + grouped(done_) +
                " points have 8 bits, later ones 16; which of them is meant can only be told from a file: "
                "save the scan to a file and open that");
    depth_ = std::max(depth_, found);
    return {};
}

Error LasSource::truncated(std::uint64_t at, std::uint64_t complete) const {
    return {ErrorCode::Truncated,
            name_ + " ends at byte " + grouped(at) + ": its header promises " + grouped(las_.points) +
                " points, there are " + grouped(complete),
            {}};
}

Expected<PointBatch> LasSource::glance() {
    PointBatch all, part;
    if (!bytes_->size() || las_.points < fewestToGlanceAt) return all;
    std::vector<std::byte> piece(glanceRecords * las_.recordBytes);
    for (std::uint64_t place = 0; place < glances; ++place) {
        const std::uint64_t first = las_.points / glances * place;
        const auto got = bytes_->readAt(las_.pointOffset + first * las_.recordBytes, piece);
        if (!got) return passOn(got);
        if (*got < piece.size()) return all;  // it has become shorter; read() says where
        decodeLasRecords(piece, las_, depth_, part);
        dropNonFinite(part);
        append(all, part);
    }
    return all;
}

Expected<bool> LasSource::read(PointBatch& batch) {
    while (done_ < las_.points) {
        const auto fits = std::max<std::uint64_t>(1, bufferBytes / las_.recordBytes);
        const auto count = std::min({las_.points - done_, std::uint64_t(batchPoints), fits});
        const auto wanted = count * las_.recordBytes;
        // A pipe has left the first bytes of the points in the buffer when its header was read.
        const auto early = done_ == 0 ? std::min<std::uint64_t>(buffer_.size(), wanted) : 0;
        buffer_.resize(wanted);
        const auto got = readFully(*bytes_, std::span(buffer_).subspan(early));
        if (!got) return passOn(got);
        const auto there = early + *got;
        if (there < wanted) {
            const auto at = las_.pointOffset + done_ * las_.recordBytes + there;
            return tl::unexpected(truncated(at, done_ + there / las_.recordBytes));
        }
        if (auto ok = judgeBatchColors(buffer_); !ok) return passOn(ok);
        decodeLasRecords(buffer_, las_, depth_, batch);
        if (keepAttributes_) decodeLasColumns(buffer_, las_.recordBytes, columns_, batch.rows);
        done_ += count;
        if (!alwaysFinite_) dropped_ += dropNonFinite(batch);
        if (batch.size() > 0) return true;
    }
    batch.clear();
    if (dropped_ == las_.points)
        return fail(ErrorCode::Empty,
                    name_ + ": none of its " + grouped(las_.points) + " points has finite coordinates");
    return false;
}

std::array<std::uint64_t, 2> LasSource::bytesRead() const {
    return {las_.pointOffset + done_ * las_.recordBytes, pointsEnd()};
}

}  // namespace scancast
