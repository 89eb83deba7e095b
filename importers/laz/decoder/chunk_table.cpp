#include "importers/laz/decoder/chunk_table.hpp"

#include <algorithm>
#include <array>

#include "files/bytes.hpp"
#include "importers/laz/decoder/integer_decoder.hpp"

namespace scancast::laz {

namespace {

// In chunks of 50,000, as everybody writes them, these are 100 billion points.
constexpr std::uint64_t mostChunks = 2'000'000;
constexpr std::uint64_t tableHeadBytes = 8, placeBytes = 8;
// What an entry of the table takes at most, generously, and what its decoder reads ahead.
constexpr std::uint64_t entryBytes = 16, readAhead = 64;
// It stands at the end of the file, and what its decoder reads ahead may be left away there.
constexpr std::uint64_t readAheadOfTable = 8;

tl::unexpected<Error> wrongTable(std::uint64_t place, const std::string& reason) {
    return fail(ErrorCode::Malformed, "byte " + grouped(place) + ": the chunk table " + reason);
}

tl::unexpected<Error> endsBeforePoints(const RandomAccess& file, const LasShape& shape) {
    return fail(ErrorCode::Truncated, "it ends at byte " + grouped(file.size()) +
                                          ", before its points (byte " + grouped(shape.pointOffset) + ")");
}

/// All that is between the start of the points and the end of the file, as one.
Chunk wholeFile(const RandomAccess& file, const LasShape& shape, std::uint64_t from, std::uint64_t restart) {
    Chunk chunk;
    chunk.at = from;
    chunk.bytes = file.size() - from;
    chunk.points = shape.points;
    chunk.restart = restart;
    chunk.exact = false;
    return chunk;
}

Expected<std::int64_t> placeAt(const RandomAccess& file, std::uint64_t at) {
    std::array<std::byte, placeBytes> bytes;
    if (const auto ok = readAll(file, at, bytes, "the place of the chunk table"); !ok) return passOn(ok);
    return loadLe<std::int64_t>(bytes.data());
}

/// Where the table begins; where the points do: it was never written.
Expected<std::uint64_t> placeOfTable(const RandomAccess& file, const LasShape& shape) {
    const std::uint64_t start = shape.pointOffset + placeBytes;
    if (start > file.size()) return endsBeforePoints(file, shape);
    auto place = placeAt(file, shape.pointOffset);
    if (!place) return passOn(place);
    // A writer that could not go back has left the place at the end of the file.
    if (*place == -1 && file.size() >= start + placeBytes) place = placeAt(file, file.size() - placeBytes);
    if (!place) return passOn(place);
    const auto table = static_cast<std::uint64_t>(*place);
    // One that was interrupted has left it as it was at first.
    if (*place >= 0 && table == shape.pointOffset) return table;
    if (*place >= 0 && table >= start && table + tableHeadBytes <= file.size()) return table;
    if (*place >= 0 && table + tableHeadBytes > file.size())
        return fail(ErrorCode::Truncated, "byte " + grouped(shape.pointOffset) +
                                              ": the chunk table is said to start at byte " + grouped(table) +
                                              "; the file ends at byte " + grouped(file.size()));
    return fail(ErrorCode::Malformed,
                "byte " + grouped(shape.pointOffset) + ": the place of the chunk table is wrong (" +
                    std::to_string(*place) + "): the file was never finished, or it is damaged");
}

/// Entries of the table, front to back.
class TableReader {
  public:
    TableReader(const RandomAccess& file, std::uint64_t from, std::uint64_t count) {
        const std::uint64_t to = std::min(file.size(), from + entryBytes * count + readAhead);
        decoder_.feed.open(file, from, std::max(from, to), 65536);
        decoder_.start();
    }
    std::uint32_t points() { return points_ = next(points_, 0); }
    std::uint32_t bytes() { return bytes_ = next(bytes_, 1); }
    bool isDamaged() const { return decoder_.damage(readAheadOfTable) != nullptr; }
    const std::optional<Error>& failure() const { return decoder_.feed.failure(); }

  private:
    std::uint32_t next(std::uint32_t before, std::size_t context) {
        return static_cast<std::uint32_t>(
            numbers_.decode(decoder_, static_cast<std::int32_t>(before), context));
    }

    ArithmeticDecoder decoder_;
    IntegerDecoder<32> numbers_{2};
    std::uint32_t points_ = 0, bytes_ = 0;
};

Expected<std::uint64_t> readCount(const RandomAccess& file, const LasShape& shape, std::uint64_t place,
                                  std::uint32_t chunkPoints) {
    std::array<std::byte, tableHeadBytes> head;
    if (const auto ok = readAll(file, place, head, "the chunk table"); !ok) return passOn(ok);
    if (const auto version = loadLe<std::uint32_t>(head.data()); version != 0)
        return wrongTable(place, "has version " + std::to_string(version) + "; only 0 is known");
    const std::uint64_t count = loadLe<std::uint32_t>(head.data() + 4);
    // Every chunk starts with a whole record: no lie about their number gets past this.
    const std::uint64_t space = place - shape.pointOffset - placeBytes;
    if (count == 0 || count > space / shape.recordBytes + 1)
        return wrongTable(place, "promises " + grouped(count) + " chunks; " + grouped(space) +
                                     " bytes of points cannot hold that");
    if (count > mostChunks)
        return fail(ErrorCode::ResourceLimit, "it has " + grouped(count) + " chunks; up to " +
                                                  grouped(mostChunks) +
                                                  " can be read: write it again in larger ones");
    if (chunkPoints != variableChunks && count != (shape.points - 1) / chunkPoints + 1)
        return wrongTable(place, "has " + grouped(count) + " chunks of " + grouped(chunkPoints) +
                                     " points; the header promises " + grouped(shape.points) + " points");
    return count;
}

Expected<std::vector<Chunk>> readTable(const RandomAccess& file, const LasShape& shape, std::uint64_t place,
                                       std::uint32_t chunkPoints) {
    const auto count = readCount(file, shape, place, chunkPoints);
    if (!count) return passOn(count);
    TableReader table(file, place + tableHeadBytes, *count);
    std::vector<Chunk> chunks;
    chunks.reserve(static_cast<std::size_t>(*count));
    std::uint64_t at = shape.pointOffset + placeBytes;
    std::uint64_t done = 0;
    for (std::uint64_t i = 0; i < *count; ++i) {
        const std::uint64_t left = shape.points - done;
        const std::uint64_t points =
            chunkPoints == variableChunks ? table.points() : std::min<std::uint64_t>(chunkPoints, left);
        const std::uint64_t bytes = table.bytes();
        if (table.failure()) return tl::unexpected<Error>(*table.failure());
        if (table.isDamaged())
            return wrongTable(place, "is damaged after " + grouped(i) + " of " + grouped(*count) + " chunks");
        if (points > left)
            return wrongTable(
                place, "has more points than the " + grouped(shape.points) + " that the header promises");
        if (points > 0 && bytes < shape.recordBytes)
            return wrongTable(place, "says that chunk " + grouped(i) + " has " + grouped(bytes) +
                                         " bytes for " + grouped(points) + " points");
        if (bytes > place - at)
            return wrongTable(place, "says that chunk " + grouped(i) + " at byte " + grouped(at) + " has " +
                                         grouped(bytes) + " bytes, beyond the points");
        if (points > 0) chunks.push_back({at, bytes, done, points, 0, true});
        at += bytes;
        done += points;
    }
    if (done < shape.points)
        return wrongTable(place,
                          "has " + grouped(done) + " points; the header promises " + grouped(shape.points));
    return chunks;
}

}  // namespace

Expected<std::vector<Chunk>> readChunks(const RandomAccess& file, const LasShape& shape,
                                        const LaszipRecord& laszip, bool mayBeCut) {
    if (laszip.compressor == Compressor::Pointwise) {
        if (file.size() <= shape.pointOffset) return endsBeforePoints(file, shape);
        return std::vector{wholeFile(file, shape, shape.pointOffset, 0)};
    }
    const std::uint64_t start = shape.pointOffset + placeBytes;
    const bool isVariable = laszip.chunkPoints == variableChunks;
    const auto place = placeOfTable(file, shape);
    if (!place && mayBeCut && !isVariable && file.size() > start)
        return std::vector{wholeFile(file, shape, start, laszip.chunkPoints)};
    if (!place) return passOn(place);
    if (*place != shape.pointOffset) {
        auto chunks = readTable(file, shape, *place, laszip.chunkPoints);
        if (chunks || !mayBeCut || isVariable) return chunks;
        return std::vector{wholeFile(file, shape, start, laszip.chunkPoints)};
    }
    if (isVariable)
        return fail(ErrorCode::Truncated,
                    "byte " + grouped(*place) +
                        ": its chunk table was never written, and only that would say how many "
                        "points each chunk has: the file was never finished");
    return std::vector{wholeFile(file, shape, start, laszip.chunkPoints)};
}

}  // namespace scancast::laz
