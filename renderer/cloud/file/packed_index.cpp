#include "renderer/cloud/file/packed_index.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "files/bytes.hpp"
#include "renderer/cloud/file/blocks/byte_planes.hpp"

namespace scancast {

namespace {

/// XORs a number into the bytes there.
template <class T>
void flip(std::byte* at, T expected) {
    storeLe(at, T(loadLe<T>(at) ^ expected));
}

std::uint64_t bitsOf(double value) {
    return std::bit_cast<std::uint64_t>(value);
}

/// So many bytes of so many records change places at once; whatever is beside a checksum is a multiple of it.
constexpr std::size_t side = 8;
/// Records whose bytes stay in the nearest cache while plane after plane is gone through.
constexpr std::size_t tileRecords = 64;
static_assert(packedNodes.checksumOffset % side == 0 && nodeRecordBytes % side == 0);
static_assert(packedPlaces.checksumOffset % side == 0 && planeRecordBytes % side == 0);
static_assert(leastPackedBytes == side && tileRecords % side == 0);

/// Rows become columns, of a square of bytes.
void transpose(std::array<std::uint64_t, side>& rows) {
    const auto exchange = [&](std::size_t distance, std::uint64_t mask) {
        for (std::size_t i = 0; i < side; ++i) {
            if (i & distance) continue;
            std::uint64_t &a = rows[i], &b = rows[i + distance];
            const std::uint64_t t = ((a >> (8 * distance)) ^ b) & mask;
            b ^= t;
            a ^= t << (8 * distance);
        }
    };
    exchange(4, 0x00000000ffffffff);
    exchange(2, 0x0000ffff0000ffff);
    exchange(1, 0x00ff00ff00ff00ff);
}

/// Rows of bytes to where they are columns: as many bytes as there are columns, up to `side` of each.
inline void turnRows(const std::byte* from, std::size_t fromStride, std::size_t rows, std::byte* to,
                     std::size_t toStride, std::size_t columns) {
    std::array<std::uint64_t, side> square{};
    for (std::size_t k = 0; k < rows; ++k) std::memcpy(&square[k], from + k * fromStride, columns);
    transpose(square);
    for (std::size_t k = 0; k < columns; ++k) std::memcpy(to + k * toStride, &square[k], rows);
}

/// The same, fast where the square is full.
void turnSquare(const std::byte* from, std::size_t fromStride, std::size_t rows, std::byte* to,
                std::size_t toStride, std::size_t columns) {
    if (rows == side && columns == side) return turnRows(from, fromStride, side, to, toStride, side);
    turnRows(from, fromStride, rows, to, toStride, columns);
}

/// Calls `square` with all squares of a chunk: where in the byte planes, where in the records, and how many records it has.
template <class Square>
void eachSquare(std::size_t count, const PackedLayout& layout, Square square) {
    for (std::size_t tile = 0; tile < count; tile += tileRecords)
        for (std::size_t plane = 0; plane < layout.recordBytes - leastPackedBytes; plane += side) {
            const std::size_t at = plane < layout.checksumOffset ? plane : plane + leastPackedBytes;
            const std::size_t end = std::min(count, tile + tileRecords);
            for (std::size_t i = tile; i < end; i += side)
                square(plane * count + i, i * layout.recordBytes + at, std::min(side, end - i));
        }
}

}  // namespace

std::size_t PackedLayout::longestChunk() const {
    // A plane takes one byte more than it has, at most (byte_planes.cpp).
    return leastPackedBytes * chunkRecords + (recordBytes - leastPackedBytes) * (chunkRecords + 1);
}

void ExpectedNodes::apply(std::span<const StoredNode> before, NodeRecord known,
                          std::span<std::byte, nodeRecordBytes> record) {
    constexpr std::size_t boxMin = offsetIn(nodeRecordFields, "boxMin"),
                          boxMax = offsetIn(nodeRecordFields, "boxMax"),
                          center = offsetIn(nodeRecordFields, "center"),
                          spacing = offsetIn(nodeRecordFields, "spacing"),
                          radiusUnit = offsetIn(nodeRecordFields, "radiusUnit"),
                          parent = offsetIn(nodeRecordFields, "parent"),
                          firstChild = offsetIn(nodeRecordFields, "firstChild"),
                          childCount = offsetIn(nodeRecordFields, "childCount"),
                          sampleCount = offsetIn(nodeRecordFields, "sampleCount"),
                          firstSample = offsetIn(nodeRecordFields, "firstSample"),
                          points = offsetIn(nodeRecordFields, "points"),
                          samplesOffset = offsetIn(nodeRecordFields, "samplesOffset");
    // In this order: where both are the same bytes, what is known of them is what was made right before.
    if (!before.empty()) {
        const auto& [node, samples] = before.back();
        flip(&record[parent], node.parent);
        flip(&record[firstSample], node.firstSample + node.sampleCount);
        flip(&record[samplesOffset], samples.offset + samples.bytes);
    }
    if (const auto above = loadLe<std::uint32_t>(&known[parent]); above < before.size())
        for (int a = 0; a < 3; ++a) {
            const std::size_t axis = sizeof(double) * std::size_t(a);
            flip(&record[boxMin + axis], bitsOf(before[above].node.boxMin[a]));
            flip(&record[boxMax + axis], bitsOf(before[above].node.boxMax[a]));
        }
    for (std::size_t axis = 0; axis < 3 * sizeof(double); axis += sizeof(double))
        flip(&record[center + axis],
             bitsOf((loadLe<double>(&known[boxMin + axis]) + loadLe<double>(&known[boxMax + axis])) * 0.5));
    flip(&record[radiusUnit], loadLe<std::uint32_t>(&known[spacing]));
    flip(&record[points], std::uint64_t(loadLe<std::uint32_t>(&known[sampleCount])));
    const auto children = std::uint8_t(known[childCount]);
    flip(&record[firstChild], children == 0 ? noNode : nextChild_);
    nextChild_ += children;
}

void ExpectedPlaces::apply(PlaneRecord known, std::span<std::byte, planeRecordBytes> record) {
    constexpr std::size_t offset = offsetIn(planeRecordFields, "offset"),
                          bytes = offsetIn(planeRecordFields, "bytes");
    if (planes_ > 0 && index_ % planes_ == 0 && index_ / planes_ < nodes_.size()) {
        const BlockPlace& samples = nodes_[index_ / planes_].samples;
        end_ = samples.offset + samples.bytes;
    }
    ++index_;
    const auto length = loadLe<std::uint32_t>(&known[bytes]);
    if (length == 0) return;  // nothing is anywhere
    flip(&record[offset], end_);
    end_ = loadLe<std::uint64_t>(&known[offset]) + length;
}

std::vector<std::byte> residualsOf(std::span<const StoredNode> nodes) {
    std::vector<std::byte> residuals(nodes.size() * nodeRecordBytes);
    ExpectedNodes expected;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const auto record = std::span(residuals).subspan(i * nodeRecordBytes).first<nodeRecordBytes>();
        encodeNode(nodes[i], record);
        std::array<std::byte, nodeRecordBytes> known;
        std::copy(record.begin(), record.end(), known.begin());
        expected.apply(nodes.first(i), known, record);
    }
    return residuals;
}

std::vector<std::byte> residualsOf(std::span<const BlockPlace> places, std::span<const StoredNode> nodes,
                                   std::size_t planes) {
    std::vector<std::byte> residuals(places.size() * planeRecordBytes);
    ExpectedPlaces expected(nodes, planes);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const auto record = std::span(residuals).subspan(i * planeRecordBytes).first<planeRecordBytes>();
        encodePlane(places[i], record);
        std::array<std::byte, planeRecordBytes> known;
        std::copy(record.begin(), record.end(), known.begin());
        expected.apply(known, record);
    }
    return residuals;
}

std::vector<std::byte> packRecords(std::span<const std::byte> records, const PackedLayout& layout) {
    std::vector<std::byte> packed, planes;
    const std::size_t count = records.size() / layout.recordBytes;
    for (std::size_t first = 0; first < count; first += chunkRecords) {
        const std::size_t n = std::min(chunkRecords, count - first);
        const auto chunk = records.subspan(first * layout.recordBytes, n * layout.recordBytes);
        for (std::size_t i = 0; i < n; ++i) {
            const auto checksum =
                chunk.subspan(i * layout.recordBytes + layout.checksumOffset, leastPackedBytes);
            packed.insert(packed.end(), checksum.begin(), checksum.end());
        }
        planes.resize(n * (layout.recordBytes - leastPackedBytes));
        eachSquare(n, layout, [&](std::size_t inPlanes, std::size_t inRecords, std::size_t rows) {
            turnSquare(&chunk[inRecords], layout.recordBytes, rows, &planes[inPlanes], n, side);
        });
        packPlanes(planes, n, packed);
    }
    return packed;
}

Expected<std::span<std::byte>> RecordUnpacker::next(std::span<const std::byte>& stored) {
    const std::size_t n = std::min<std::uint64_t>(chunkRecords, left_);
    const std::size_t checksums = n * leastPackedBytes;
    if (n == 0 || stored.size() < checksums)
        return fail(ErrorCode::Malformed, "it holds more or fewer records than it should");
    planes_.resize(n * (layout_.recordBytes - leastPackedBytes));
    records_.resize(n * layout_.recordBytes);
    const auto kept = stored.first(checksums);
    stored = stored.subspan(checksums);
    if (auto ok = unpackPlanes(stored, n, planes_); !ok)
        return fail(ErrorCode::Malformed, "it does not decode to what it should hold");
    for (std::size_t i = 0; i < n; ++i)
        std::copy_n(&kept[i * leastPackedBytes], leastPackedBytes,
                    &records_[i * layout_.recordBytes + layout_.checksumOffset]);
    eachSquare(n, layout_, [&](std::size_t inPlanes, std::size_t inRecords, std::size_t rows) {
        turnSquare(&planes_[inPlanes], n, side, &records_[inRecords], layout_.recordBytes, rows);
    });
    left_ -= n;
    return std::span(records_);
}

}  // namespace scancast
