#include "renderer/cloud/import/las/las_source.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

#include "renderer/cloud/import/lost_points.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast {

namespace {

// One batch of the common formats fits (65,536 × 34 bytes); of the longest possible record, 64 do.
constexpr std::size_t bufferBytes = std::size_t(4) << 20;
// Variable length records are looked at this far: real files have kilobytes, waveform tables perhaps
// megabytes.
constexpr std::uint64_t longestVlrs = std::uint64_t(4) << 20;
// Places across the file where a first look at the colours is taken; any 16-bit file is found out by it.
constexpr std::uint64_t firstLooks = 16;
constexpr std::uint64_t firstLookRecords = 256;
// Places across the file that a glance takes points from. Smaller scans are read as fast.
constexpr std::uint64_t glances = 8192, glanceRecords = 6, fewestToGlanceAt = 1'000'000;

}  // namespace

Expected<std::unique_ptr<LasSource>> LasSource::create(std::unique_ptr<ByteSource> bytes, std::string name,
                                                       bool keepAttributes, bool recover, bool fullColors,
                                                       bool looksInParts) {
    std::array<std::byte, lasHeaderBytes> start{};
    const auto got = readFully(*bytes, start);
    if (!got) return passOn(got);
    auto reader = LasReader::create(std::span(start).first(*got), std::move(name), keepAttributes);
    if (!reader) return passOn(std::move(reader));
    if (fullColors) reader->keepFullColors();

    std::unique_ptr<LasSource> source(new LasSource(std::move(bytes), std::move(*reader)));
    source->recover_ = recover;
    const LasHeader& header = source->las();
    if (auto ok = source->checkExtent(); !ok) return passOn(ok);
    // A header of LAS 1.0-1.3 is shorter than what was read: the rest belongs to the variable length records.
    if (source->bytes_->size()) {
        if (auto ok = source->bytes_->seek(header.headerBytes); !ok) return passOn(ok);
        if (auto ok = source->readToPoints(header.headerBytes); !ok) return passOn(ok);
        if (auto ok = source->readEvlrs(); !ok) return passOn(ok);
        if (auto ok = source->lookAtColors(looksInParts); !ok) return passOn(ok);
        if (auto ok = source->bytes_->seek(header.pointOffset); !ok) return passOn(ok);
    } else {
        source->buffer_.assign(start.begin(), start.begin() + static_cast<std::ptrdiff_t>(*got));
        if (auto ok = source->readToPoints(*got); !ok) return passOn(ok);
    }
    source->reader_.understand();
    return source;
}

/// Reads what lies between header and points. A file was positioned at the end of its header; of a pipe, `at`
/// bytes were read and stand in the buffer, and they may reach into the points.
Expected<void> LasSource::readToPoints(std::uint64_t at) {
    std::vector<std::byte> early;
    std::vector<std::byte> records;
    if (!buffer_.empty()) {
        const auto split = std::min<std::uint64_t>(buffer_.size(), las().pointOffset);
        const auto begin = std::min<std::uint64_t>(las().headerBytes, split);
        records.assign(buffer_.begin() + static_cast<std::ptrdiff_t>(begin),
                       buffer_.begin() + static_cast<std::ptrdiff_t>(split));
        early.assign(buffer_.begin() + static_cast<std::ptrdiff_t>(split), buffer_.end());
    }
    std::vector<std::byte> piece(65536);
    while (at < las().pointOffset) {
        if (bytes_->size() && records.size() >= longestVlrs) break;  // a file seeks over the rest
        const auto want = std::min<std::uint64_t>(piece.size(), las().pointOffset - at);
        const auto got = readFully(*bytes_, std::span(piece).first(want));
        if (!got) return passOn(got);
        if (*got < want) return tl::unexpected(truncated(at + *got, 0));
        // Bytes of a header longer than we know are no records.
        const auto skip = std::min<std::uint64_t>(want, las().headerBytes > at ? las().headerBytes - at : 0);
        if (records.size() < longestVlrs)  // a pipe has to be read on, but not kept
            records.insert(records.end(), piece.begin() + static_cast<std::ptrdiff_t>(skip),
                           piece.begin() + static_cast<std::ptrdiff_t>(want));
        at += want;
    }
    reader_.takeVlrs(records);
    buffer_ = std::move(early);
    return {};
}

/// Do the promised points fit into the file? Also keeps every later product of counts within 64 bits.
Expected<void> LasSource::checkExtent() {
    const auto size = bytes_->size();
    const auto room = std::numeric_limits<std::int64_t>::max() - las().pointOffset;
    if (size && las().pointOffset > *size)
        return fail(ErrorCode::Malformed, name() + ", byte 96: the points are said to start at byte " +
                                              grouped(las().pointOffset) + ", beyond the end of the file (" +
                                              grouped(*size) + " bytes)");
    if (size) {
        auto there = (*size - las().pointOffset) / las().recordBytes;
        // A count that is wrong must not make points of the records behind them.
        if (recover_ && las().evlrs > 0 && las().evlrOffset >= las().pointOffset)
            there = std::min(there, (las().evlrOffset - las().pointOffset) / las().recordBytes);
        if (las().points > there && (!recover_ || there == 0)) return tl::unexpected(truncated(*size, there));
        if (las().points > there) loseAllBut(there);
    } else if (las().points > room / las().recordBytes) {
        return fail(ErrorCode::Malformed,
                    name() + ": " + grouped(las().points) + " points are more than any file holds");
    }
    if (las().evlrs > 0 && las().evlrOffset >= las().pointOffset && las().evlrOffset < pointsEnd())
        return fail(ErrorCode::Malformed, name() + ", byte 235: other records are said to start at byte " +
                                              grouped(las().evlrOffset) +
                                              ", among the points (which end at byte " +
                                              grouped(pointsEnd()) + ")");
    return {};
}

/// LAS 1.4 may keep its records behind the points. Like all records: whatever is wrong with it harms no
/// point.
Expected<void> LasSource::readEvlrs() {
    const auto size = *bytes_->size();
    auto at = las().evlrOffset;
    for (std::uint32_t i = 0; i < std::min(las().evlrs, mostEvlrs) && at >= pointsEnd() && at < size; ++i) {
        std::array<std::byte, evlrHeadBytes> bytes{};
        const auto got = bytes_->readAt(at, bytes);
        if (!got) return passOn(got);
        if (*got < bytes.size()) break;
        const EvlrHead head = parseEvlrHead(bytes);
        at += bytes.size();
        if (head.length > size - at) break;
        if (head.isWanted()) {
            std::vector<std::byte> content(head.length);
            const auto read = bytes_->readAt(at, content);
            if (!read) return passOn(read);
            if (*read == head.length) reader_.takeEvlr(head, content);
        }
        at += head.length;
    }
    return {};
}

/// 8-bit colours in 16-bit fields: exact, because the whole file is looked at - until the first number above
/// 255, which in real 16-bit files is found at once. Only truly 8-bit files cost a second pass.
Expected<void> LasSource::lookAtColors(bool inParts) {
    reader_.hasSeenAll();
    if (!reader_.wantsToSeeMore()) return {};
    const auto stride = std::max<std::uint64_t>(1, las().points / firstLooks);
    for (std::uint64_t first = 0; first < las().points && reader_.wantsToSeeMore(); first += stride)
        if (auto ok = see(first, std::min(firstLookRecords, las().points - first)); !ok) return ok;
    isUnseen_ = inParts && reader_.wantsToSeeMore();
    return isUnseen_ ? Expected<void>() : see(0, las().points);
}

/// Until they have told enough.
Expected<void> LasSource::see(std::uint64_t first, std::uint64_t count) {
    // Of a small file no more than it has: thousands of them may be looked at.
    const std::uint64_t atOnce =
        std::max<std::uint64_t>(1, std::min<std::uint64_t>(bufferBytes / las().recordBytes, count));
    std::vector<std::byte> piece;
    for (const std::uint64_t end = first + count; first < end && reader_.wantsToSeeMore(); first += atOnce) {
        piece.resize(std::min(end - first, atOnce) * las().recordBytes);
        const auto got = bytes_->readAt(placeOf(first), piece);
        if (!got) return passOn(got);
        if (*got < piece.size()) return tl::unexpected(truncated(placeOf(first) + *got, first));
        reader_.see(piece);
    }
    return {};
}

Expected<std::uint16_t> LasSource::lookAt(std::uint64_t first, std::uint64_t count) {
    first = std::min(first, las().points);
    if (auto ok = see(first, std::min(count, las().points - first)); !ok) return passOn(ok);
    return reader_.highestColor();
}

void LasSource::hasSeen(std::uint16_t highest) {
    reader_.hasBeenTold(highest);
    isUnseen_ = false;
}

Error LasSource::truncated(std::uint64_t at, std::uint64_t complete) const {
    return {ErrorCode::Truncated,
            name() + " ends at byte " + grouped(at) + ": its header promises " + grouped(las().points) +
                " points, there are " + grouped(complete),
            {}};
}

void LasSource::loseAllBut(std::uint64_t complete) {
    lost_ += las().points - complete;
    reader_.setPoints(complete);
}

Expected<PointBatch> LasSource::glance() {
    PointBatch all, part;
    if (!bytes_->size() || las().points < fewestToGlanceAt) return all;
    std::vector<std::byte> piece(glanceRecords * las().recordBytes);
    for (std::uint64_t place = 0; place < glances; ++place) {
        const std::uint64_t first = las().points / glances * place;
        const auto got = bytes_->readAt(placeOf(first), piece);
        if (!got) return passOn(got);
        if (*got < piece.size()) return all;  // it has become shorter; read() says where
        reader_.glance(piece, part);
        append(all, part);
    }
    return all;
}

/// One behind the last record that is read.
std::uint64_t LasSource::endOfPart() const {
    if (!part_) return las().points;
    const std::uint64_t first = std::min(part_->first, las().points);
    return first + std::min(part_->count, las().points - first);
}

Expected<bool> LasSource::read(PointBatch& batch) {
    if (std::exchange(isUnseen_, false))
        if (auto ok = see(0, las().points); !ok) return passOn(ok);
    const std::uint64_t begin = part_ ? part_->first : 0;
    for (std::uint64_t done = begin; (done = begin + reader_.recordsRead()) < endOfPart();) {
        if (part_ && reader_.recordsRead() == 0)
            if (auto ok = bytes_->seek(placeOf(begin)); !ok) return passOn(ok);
        const auto fits = std::max<std::uint64_t>(1, bufferBytes / las().recordBytes);
        auto count = std::min({endOfPart() - done, std::uint64_t(batchPoints), fits});
        const auto wanted = count * las().recordBytes;
        // A pipe has left the first bytes of the points in the buffer when its header was read.
        const auto early = done == 0 ? std::min<std::uint64_t>(buffer_.size(), wanted) : 0;
        buffer_.resize(wanted);
        const auto got = readFully(*bytes_, std::span(buffer_).subspan(early));
        if (!got) return passOn(got);
        const auto there = early + *got;
        if (there < wanted) {
            const auto whole = there / las().recordBytes;
            if (!recover_ || done + whole == 0)
                return tl::unexpected(truncated(placeOf(done) + there, done + whole));
            loseAllBut(done + whole);
            if (whole == 0) break;
            count = whole;
            buffer_.resize(count * las().recordBytes);
        }
        if (auto ok = reader_.decode(buffer_, batch); !ok) return passOn(ok);
        if (batch.size() > 0) return true;
    }
    batch.clear();
    if (part_) return false;
    if (auto ok = reader_.checkEnd(); !ok) return passOn(ok);
    return false;
}

std::vector<std::string> LasSource::notes() const {
    auto notes = reader_.notes();
    for (auto& note : notes) note = std::filesystem::path(name()).filename().string() + ": " + note;
    if (lost_ == 0) return notes;
    notes.push_back(noteOf(name(), lostPoints("it", las().points + lost_, las().points)));
    if (las().evlrs > 0 && bytes_->size() && las().evlrOffset >= *bytes_->size())
        notes.push_back(
            noteOf(name(),
                   "the records behind its points are lost, too; they may have held its coordinate "
                   "reference system"));
    return notes;
}

std::array<std::uint64_t, 2> LasSource::bytesRead() const {
    return {placeOf(reader_.recordsRead()), pointsEnd()};
}

}  // namespace scancast
