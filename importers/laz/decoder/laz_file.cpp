#include "importers/laz/decoder/laz_file.hpp"

#include <algorithm>
#include <cstring>
#include <optional>

#include "files/bytes.hpp"

namespace scancast::laz {

namespace {

// What Scancast accepts at most; real scans have less than one.
constexpr std::uint64_t mostPointsPerByte = 1000;
constexpr std::size_t vlrHeadBytes = 54, evlrHeadBytes = 60;
constexpr std::uint64_t longestHead = 16U << 20, longestRecords = 16U << 20;
constexpr std::uint64_t longestContent = 65536;
constexpr std::uint32_t mostRecords = 1000;

bool isLaszip(const std::byte* head) {
    constexpr char user[16] = "laszip encoded";
    return std::memcmp(head + 2, user, sizeof user) == 0 && loadLe<std::uint16_t>(head + 18) == 22204;
}

struct Head {
    std::vector<std::byte> bytes;
    std::optional<std::span<const std::byte>> laszip;  // in them
};

/// All that stands before the points.
Expected<Head> readHead(const RandomAccess& file, const LasShape& shape) {
    Head head;
    head.bytes.resize(static_cast<std::size_t>(std::min(shape.pointOffset, longestHead)));
    if (file.size() < shape.pointOffset)
        return fail(ErrorCode::Truncated, "it ends at byte " + grouped(file.size()) +
                                              ", before its points (byte " + grouped(shape.pointOffset) +
                                              ")");
    if (const auto ok = readAll(file, 0, head.bytes, "its variable length records"); !ok) return passOn(ok);
    const std::span<const std::byte> all = head.bytes;
    std::size_t at = shape.headerBytes;
    for (std::uint32_t i = 0; i < shape.vlrs && all.size() - at >= vlrHeadBytes; ++i) {
        const std::size_t length = loadLe<std::uint16_t>(all.data() + at + 20);
        if (length > all.size() - at - vlrHeadBytes) break;  // runs into the points: its length is wrong
        if (!head.laszip && isLaszip(all.data() + at)) head.laszip = all.subspan(at + vlrHeadBytes, length);
        at += vlrHeadBytes + length;
    }
    if (all.size() < shape.pointOffset)
        head.bytes.resize(at);  // never larger: what is found in it stays there
    head.bytes[104] &= std::byte{0x3f};
    return head;
}

Expected<std::vector<std::byte>> readExtendedRecords(const RandomAccess& file, const LasShape& shape) {
    std::vector<std::byte> records;
    std::uint64_t at = shape.evlrOffset;
    for (std::uint32_t i = 0; i < std::min(shape.evlrs, mostRecords); ++i) {
        if (at <= shape.pointOffset || at >= file.size() || file.size() - at < evlrHeadBytes) break;
        std::byte head[evlrHeadBytes];
        if (const auto ok = readAll(file, at, head, "an extended record"); !ok) return passOn(ok);
        at += evlrHeadBytes;
        const auto length = loadLe<std::uint64_t>(head + 20);
        if (length > file.size() - at) break;
        if (length <= longestContent) {
            if (records.size() + evlrHeadBytes + length > longestRecords) break;
            const std::size_t end = records.size();
            records.resize(end + evlrHeadBytes + static_cast<std::size_t>(length));
            std::memcpy(records.data() + end, head, evlrHeadBytes);
            const auto content = std::span(records).subspan(end + evlrHeadBytes);
            if (const auto ok = readAll(file, at, content, "an extended record"); !ok) return passOn(ok);
        }
        at += length;
    }
    return records;
}

Expected<std::vector<Chunk>> plainRecords(const RandomAccess& file, const LasShape& shape) {
    const std::uint64_t space = file.size() > shape.pointOffset ? file.size() - shape.pointOffset : 0;
    if (shape.points > space / shape.recordBytes)
        return fail(ErrorCode::Truncated, "it ends at byte " + grouped(file.size()) +
                                              "; its header promises " + grouped(shape.points) +
                                              " points from byte " + grouped(shape.pointOffset) + " on");
    return std::vector{Chunk{shape.pointOffset, shape.points * shape.recordBytes, 0, shape.points, 0, true}};
}

}  // namespace

Expected<LazFile> LazFile::open(std::shared_ptr<const RandomAccess> bytes, bool mayBeCut) {
    std::array<std::byte, longestLasHeader> start;
    const auto got = bytes->readAt(0, start);
    if (!got) return passOn(got);
    const auto shape = parseLasShape(std::span(start).first(*got));
    if (!shape) return passOn(shape);
    if (shape->points / mostPointsPerByte > bytes->size())
        return fail(ErrorCode::Malformed, "it promises " + grouped(shape->points) + " points; " +
                                              grouped(bytes->size()) + " bytes cannot hold that");
    LazFile file;
    file.shape_ = *shape;
    auto head = readHead(*bytes, *shape);
    if (!head) return passOn(head);
    if (shape->compressed) {
        if (!head->laszip)
            return fail(
                ErrorCode::Malformed,
                "it is marked as LAZ but has no LASzip record (user \"laszip encoded\", number 22204)");
        auto laszip = parseLaszipRecord(*head->laszip, shape->pointFormat, shape->recordBytes);
        if (!laszip) return passOn(laszip);
        file.laszip_ = std::move(*laszip);
    }
    auto chunks =
        shape->compressed ? readChunks(*bytes, *shape, file.laszip_, mayBeCut) : plainRecords(*bytes, *shape);
    if (!chunks) return passOn(chunks);
    file.chunks_ = std::move(*chunks);
    auto extended = readExtendedRecords(*bytes, *shape);
    if (!extended) return passOn(extended);
    file.head_ = std::move(head->bytes);
    file.extended_ = std::move(*extended);
    file.bytes_ = std::move(bytes);
    return file;
}

Expected<LazFile> LazFile::ofChunk(std::shared_ptr<const RandomAccess> bytes, int pointFormat,
                                   std::uint32_t recordBytes, std::uint64_t points,
                                   std::span<const std::byte> laszip) {
    if (pointFormat < 0 || pointFormat > 10 || recordBytes < leastRecordBytes(pointFormat))
        return fail(ErrorCode::Malformed, "its records are too short for their point format");
    auto parsed = parseLaszipRecord(laszip, pointFormat, recordBytes);
    if (!parsed) return passOn(parsed);
    LazFile file;
    file.shape_.pointFormat = pointFormat;
    file.shape_.recordBytes = recordBytes;
    file.shape_.points = points;
    file.laszip_ = std::move(*parsed);
    file.chunks_ = {Chunk{0, bytes->size(), 0, points, 0, true}};
    file.bytes_ = std::move(bytes);
    return file;
}

namespace {

/// Points from the chunk's start on that decode without looking behind the end: first by many, then one by one.
Expected<std::uint64_t> countWhole(const LazFile& file, const Chunk& chunk) {
    LazDecoder decoder(file);
    std::vector<std::byte> records;
    std::uint64_t whole = 0;
    for (const std::uint64_t step : {1000, 1}) {
        if (const auto ok = decoder.start(chunk); !ok) return passOn(ok);
        for (std::uint64_t done = 0; decoder.left() > 0; whole = std::max(whole, done)) {
            records.resize(static_cast<std::size_t>(std::min(done < whole ? 1000 : step, decoder.left())) *
                           file.shape().recordBytes);
            const auto ok = decoder.read(records);
            if (!ok && ok.error().code == ErrorCode::Io) return passOn(ok);
            if (!ok || decoder.ranDry()) break;
            done += records.size() / file.shape().recordBytes;
        }
        if (whole == chunk.points) break;
    }
    return whole;
}

}  // namespace

Expected<std::uint64_t> LazFile::keepWhole() {
    Chunk& chunk = chunks_.front();
    if (chunk.exact) return shape_.points;
    const auto whole = countWhole(*this, chunk);
    if (!whole) return whole;
    if (*whole == 0) return fail(ErrorCode::Truncated, "it ends before its first point does");
    chunk.points = *whole;
    return whole;
}

}  // namespace scancast::laz
