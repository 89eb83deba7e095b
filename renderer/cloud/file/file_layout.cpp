#include "renderer/cloud/file/file_layout.hpp"

#include <spdlog/fmt/fmt.h>
#include <xxhash.h>

#include <algorithm>

#include "files/bytes.hpp"

namespace scancast {

namespace {

constexpr std::size_t planesPartEnd = 104, ownChecksumOffset = 120;
constexpr std::size_t confidenceOffset = 142, rowsPlaceOffset = 184, rowsPlaceEnd = 204;
constexpr std::uint32_t oldestVersion = 1;

/// Walks over a record and copies value by value: into it (To) or out of it (From).
struct To {
    std::byte* at;
    template <class T>
    void operator()(const T& value) {
        storeLe(at, value);
        at += sizeof(T);
    }
};

struct From {
    const std::byte* at;
    template <class T>
    void operator()(T& value) {
        value = loadLe<T>(at);
        at += sizeof(T);
    }
};

bool allZero(std::span<const std::byte> bytes) {
    return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte(0); });
}

/// The order in which a header tells of a part.
template <class Walk, class Part>
void walkPart(Walk& copy, Part& part) {
    copy(part.offset);
    copy(part.bytes);
    copy(part.checksum);
}

/// The order of nodeRecordFields, for both directions.
template <class Walk, class Stored>
void walk(Walk copy, Stored& stored) {
    std::uint8_t zero8 = 0;
    auto& node = stored.node;
    for (auto* vector : {&node.boxMin, &node.step, &node.boxMax, &node.center})
        for (int a = 0; a < 3; ++a) copy((*vector)[a]);
    copy(node.radius);
    copy(node.spacing);
    copy(node.meanSpacing);
    copy(node.radiusUnit);
    for (int a = 0; a < 3; ++a) copy(node.cone.axis[a]);
    copy(node.cone.halfAngle);
    copy(node.parent);
    copy(node.firstChild);
    copy(node.childCount);
    copy(node.level);
    copy(node.confidence);
    copy(zero8);
    copy(node.sampleCount);
    copy(stored.samples.bytes);
    copy(node.firstSample);
    copy(node.points);
    copy(stored.samples.offset);
    copy(stored.samples.checksum);
}

tl::unexpected<Error> otherVersion(std::uint32_t version) {
    return fail(
        ErrorCode::Unsupported,
        fmt::format("this cloud file has version {}, and this Scancast reads versions {} to {}; {}", version,
                    oldestVersion, cloudFileVersion,
                    version > cloudFileVersion
                        ? "use a newer Scancast, or ingest the scan again with this one"
                        : "ingest the scan again, for example: scancast ingest scan.las -o cloud.scan"));
}

/// What can be told before the header's numbers are read.
Expected<void> checkStart(std::span<const std::byte> start) {
    if (!start.empty() && allZero(start))
        return fail(
            ErrorCode::Truncated,
            "byte 0: the header is empty; a cloud file that was never finished. Ingest the scan again");
    if (start.size() < cloudFileMagic.size() || !std::equal(cloudFileMagic.begin(), cloudFileMagic.end(),
                                                            reinterpret_cast<const char*>(start.data())))
        return fail(
            ErrorCode::Unsupported,
            "byte 0: this is no cloud file; make one of a scan, for example: scancast ingest scan.las -o "
            "cloud.scan");
    if (start.size() < cloudHeaderBytes)
        return fail(ErrorCode::Truncated,
                    fmt::format("the file ends at byte {}, within its header", start.size()));
    return {};
}

/// Written so that nothing can overflow: each number is compared with what is left of the file.
bool liesWithin(const FilePart& part, std::uint64_t from, std::uint64_t end) {
    return part.offset >= from && part.offset <= end && part.bytes <= end - part.offset;
}

/// Whether the parts lie as the header's version has them, in a file of `fileBytes` bytes.
bool partsFit(const CloudFileHeader& h, std::uint64_t fileBytes) {
    const bool packed = h.version >= firstPackedVersion;
    if (h.nodes == 0 ||
        (packed ? h.index.bytes / leastPackedBytes < h.nodes
                : h.index.bytes != std::uint64_t(h.nodes) * nodeRecordBytes) ||
        !liesWithin(h.index, cloudHeaderBytes, h.fileBytes) || !liesWithin(h.facts, 0, h.fileBytes) ||
        h.facts.end() != h.fileBytes)
        return false;
    if (h.version == 1)
        return h.fileBytes == fileBytes && h.facts.offset == h.index.end() && h.planes == FilePart{};
    return h.planes.offset == h.index.end() && liesWithin(h.planes, 0, h.fileBytes) &&
           (packed || h.planes.bytes % (std::uint64_t(h.nodes) * planeRecordBytes) == 0) &&
           h.facts.offset >= h.planes.end();
}

}  // namespace

std::uint64_t checksumOf(std::span<const std::byte> bytes) {
    return XXH3_64bits(bytes.data(), bytes.size());
}

std::array<std::byte, cloudHeaderBytes> encodeHeader(const CloudFileHeader& header) {
    std::array<std::byte, cloudHeaderBytes> bytes{};
    To put{bytes.data()};
    put(cloudFileMagic);
    put(header.version);
    put(std::uint32_t(cloudHeaderBytes));
    put(header.fileBytes);
    walkPart(put, header.index);
    walkPart(put, header.facts);
    put(header.nodes);
    put(std::uint32_t(nodeRecordBytes));
    walkPart(put, header.planes);
    storeLe(&bytes[ownChecksumOffset], checksumOf(std::span(bytes).first(ownChecksumOffset)));
    return bytes;
}

Expected<CloudFileHeader> parseHeader(std::span<const std::byte> start, std::uint64_t fileBytes) {
    if (auto ok = checkStart(start); !ok) return passOn(ok);
    std::array<char, 8> magic;
    std::uint32_t headerBytes, recordBytes;
    CloudFileHeader header;
    From take{start.data()};
    take(magic);
    take(header.version);
    if (header.version < oldestVersion || header.version > cloudFileVersion)
        return otherVersion(header.version);
    take(headerBytes);
    take(header.fileBytes);
    walkPart(take, header.index);
    walkPart(take, header.facts);
    take(header.nodes);
    take(recordBytes);
    walkPart(take, header.planes);
    if (loadLe<std::uint64_t>(&start[ownChecksumOffset]) != checksumOf(start.first(ownChecksumOffset)))
        return fail(ErrorCode::Malformed, "byte 0: the header is damaged, its checksum is wrong");
    if (header.fileBytes > fileBytes)
        return fail(ErrorCode::Truncated,
                    fmt::format("the file ends at byte {}, and should at {}", fileBytes, header.fileBytes));
    if (headerBytes != cloudHeaderBytes || recordBytes != nodeRecordBytes ||
        !allZero(start.subspan(planesPartEnd, ownChecksumOffset - planesPartEnd)) ||
        !partsFit(header, fileBytes))
        return fail(ErrorCode::Malformed, "byte 0: the header contradicts itself or the size of the file");
    return header;
}

void encodeNode(const StoredNode& node, std::span<std::byte, nodeRecordBytes> record) {
    std::fill(record.begin(), record.end(), std::byte(0));
    walk(To{record.data()}, node);
}

StoredNode decodeNode(NodeRecord record) {
    StoredNode node{};
    walk(From{record.data()}, node);
    return node;
}

BlockPlace decodeRowsPlace(NodeRecord record) {
    BlockPlace place;
    From take{record.data() + rowsPlaceOffset};
    take(place.offset);
    take(place.checksum);
    take(place.bytes);
    return place;
}

bool reservedAreZero(NodeRecord record, std::uint32_t version) {
    if (version == 1)
        return allZero(record.subspan(confidenceOffset, 2)) && allZero(record.subspan(rowsPlaceEnd));
    return allZero(record.subspan(confidenceOffset + 1, 1)) && allZero(record.subspan(rowsPlaceOffset));
}

void encodePlane(const BlockPlace& place, std::span<std::byte, planeRecordBytes> record) {
    To put{record.data()};
    put(place.offset);
    put(place.checksum);
    put(place.bytes);
    put(std::uint32_t(0));
}

BlockPlace decodePlane(PlaneRecord record) {
    BlockPlace place;
    From take{record.data()};
    take(place.offset);
    take(place.checksum);
    take(place.bytes);
    return place;
}

bool reservedAreZero(PlaneRecord record) {
    return allZero(record.subspan(planeRecordFields.back().offset));
}

}  // namespace scancast
