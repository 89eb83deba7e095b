#include "renderer/cloud/file/file_layout.hpp"

#include <spdlog/fmt/fmt.h>
#include <xxhash.h>

#include <algorithm>

#include "files/bytes.hpp"

namespace scancast {

// Offsets stand here once; the functions below walk through the same order.
const std::array<FileField, 14> cloudHeaderFields{{{0, 8, "magic"},
                                                   {8, 4, "version"},
                                                   {12, 4, "headerBytes"},
                                                   {16, 8, "fileBytes"},
                                                   {24, 8, "indexOffset"},
                                                   {32, 8, "indexBytes"},
                                                   {40, 8, "indexChecksum"},
                                                   {48, 8, "factsOffset"},
                                                   {56, 8, "factsBytes"},
                                                   {64, 8, "factsChecksum"},
                                                   {72, 4, "nodes"},
                                                   {76, 4, "nodeRecordBytes"},
                                                   {80, 40, "zero"},
                                                   {120, 8, "headerChecksum"}}};

const std::array<FileField, 25> nodeRecordFields{
    {{0, 24, "boxMin"},         {24, 24, "step"},          {48, 24, "boxMax"},
     {72, 24, "center"},        {96, 8, "radius"},         {104, 4, "spacing"},
     {108, 4, "meanSpacing"},   {112, 4, "radiusUnit"},    {116, 12, "coneAxis"},
     {128, 4, "coneHalfAngle"}, {132, 4, "parent"},        {136, 4, "firstChild"},
     {140, 1, "childCount"},    {141, 1, "level"},         {142, 2, "zero"},
     {144, 4, "sampleCount"},   {148, 4, "samplesBytes"},  {152, 8, "firstSample"},
     {160, 8, "points"},        {168, 8, "samplesOffset"}, {176, 8, "samplesChecksum"},
     {184, 8, "rowsOffset"},    {192, 8, "rowsChecksum"},  {200, 4, "rowsBytes"},
     {204, 4, "zero"}}};

namespace {

constexpr std::size_t ownChecksumOffset = 120;

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

/// The order of nodeRecordFields, for both directions.
template <class Walk, class Stored>
void walk(Walk copy, Stored& stored) {
    std::uint16_t zero16 = 0;
    std::uint32_t zero32 = 0;
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
    copy(zero16);
    copy(node.sampleCount);
    copy(stored.samples.bytes);
    copy(node.firstSample);
    copy(node.points);
    copy(stored.samples.offset);
    copy(stored.samples.checksum);
    copy(stored.rows.offset);
    copy(stored.rows.checksum);
    copy(stored.rows.bytes);
    copy(zero32);
}

tl::unexpected<Error> otherVersion(std::uint32_t version) {
    return fail(
        ErrorCode::Unsupported,
        fmt::format("this cloud file has version {}, and this Scancast reads version {}; {}", version,
                    cloudFileVersion,
                    version > cloudFileVersion
                        ? "use a newer Scancast, or ingest the scan again with this one"
                        : "ingest the scan again, for example: scancast ingest scan.las -o cloud.scan"));
}

}  // namespace

std::uint64_t checksumOf(std::span<const std::byte> bytes) {
    return XXH3_64bits(bytes.data(), bytes.size());
}

std::array<std::byte, cloudHeaderBytes> encodeHeader(const CloudFileHeader& header) {
    std::array<std::byte, cloudHeaderBytes> bytes{};
    To put{bytes.data()};
    put(cloudFileMagic);
    put(cloudFileVersion);
    put(std::uint32_t(cloudHeaderBytes));
    put(header.fileBytes);
    put(header.index.offset);
    put(header.indexBytes());
    put(header.index.checksum);
    put(header.factsOffset);
    put(header.factsBytes);
    put(header.factsChecksum);
    put(header.nodes);
    put(std::uint32_t(nodeRecordBytes));
    storeLe(&bytes[ownChecksumOffset], checksumOf(std::span(bytes).first(ownChecksumOffset)));
    return bytes;
}

Expected<CloudFileHeader> parseHeader(std::span<const std::byte> start, std::uint64_t fileBytes) {
    const auto isMagic = [&] {
        return start.size() >= cloudFileMagic.size() &&
               std::equal(cloudFileMagic.begin(), cloudFileMagic.end(),
                          reinterpret_cast<const char*>(start.data()));
    };
    if (!start.empty() &&
        std::all_of(start.begin(), start.end(), [](std::byte b) { return b == std::byte(0); }))
        return fail(
            ErrorCode::Truncated,
            "byte 0: the header is empty; a cloud file that was never finished. Ingest the scan again");
    if (!isMagic())
        return fail(
            ErrorCode::Unsupported,
            "byte 0: this is no cloud file; make one of a scan, for example: scancast ingest scan.las -o "
            "cloud.scan");
    if (start.size() < cloudHeaderBytes)
        return fail(ErrorCode::Truncated,
                    fmt::format("the file ends at byte {}, within its header", start.size()));
    std::array<char, 8> magic;
    std::uint32_t version, headerBytes, recordBytes;
    std::uint64_t indexBytes;
    CloudFileHeader header;
    From take{start.data()};
    take(magic);
    take(version);
    if (version != cloudFileVersion) return otherVersion(version);
    take(headerBytes);
    take(header.fileBytes);
    take(header.index.offset);
    take(indexBytes);
    take(header.index.checksum);
    take(header.factsOffset);
    take(header.factsBytes);
    take(header.factsChecksum);
    take(header.nodes);
    take(recordBytes);
    if (loadLe<std::uint64_t>(&start[ownChecksumOffset]) != checksumOf(start.first(ownChecksumOffset)))
        return fail(ErrorCode::Malformed, "byte 0: the header is damaged, its checksum is wrong");
    if (header.fileBytes > fileBytes)
        return fail(ErrorCode::Truncated,
                    fmt::format("the file ends at byte {}, and should at {}", fileBytes, header.fileBytes));
    // Written so that nothing can overflow: each number is compared with what is left of the file.
    const bool fits =
        headerBytes == cloudHeaderBytes && recordBytes == nodeRecordBytes && header.fileBytes == fileBytes &&
        indexBytes == header.indexBytes() && header.nodes > 0 && header.index.offset >= cloudHeaderBytes &&
        header.index.offset <= fileBytes && indexBytes <= fileBytes - header.index.offset &&
        header.factsOffset == header.index.offset + indexBytes &&
        header.factsBytes == fileBytes - header.factsOffset &&
        std::all_of(&start[80], &start[ownChecksumOffset], [](std::byte b) { return b == std::byte(0); });
    if (!fits)
        return fail(ErrorCode::Malformed, "byte 0: the header contradicts itself or the size of the file");
    return header;
}

void encodeNode(const StoredNode& node, std::span<std::byte, nodeRecordBytes> record) {
    walk(To{record.data()}, node);
}

StoredNode decodeNode(std::span<const std::byte, nodeRecordBytes> record) {
    StoredNode node{};
    walk(From{record.data()}, node);
    return node;
}

bool reservedAreZero(std::span<const std::byte, nodeRecordBytes> record) {
    return loadLe<std::uint16_t>(&record[142]) == 0 && loadLe<std::uint32_t>(&record[204]) == 0;
}

}  // namespace scancast
