#include "renderer/cloud/import/stream/point_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "files/bytes.hpp"
#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/stream/stream_columns.hpp"

namespace scancast::point_stream {

namespace {

enum At : std::size_t {
    atVersion = 8,
    atColumns = 10,
    atKnown = 12,
    atPoints = 16,
    atGridStep = 24,
    atGridOrigin = 48,
    atBounds = 72,
    atEpsg = 120,
    atFormatBytes = 124,
    atWktBytes = 128,
    atColumnsBytes = 132,
};
enum HeaderColumn : unsigned { color = 1, intensity = 2, classification = 4, normal = 8 };
enum Known : unsigned { knownPoints = 1, knownBounds = 2, knownEpsg = 4, knownScanner = 8 };

void storeVector(std::byte* to, const glm::dvec3& v) {
    for (int i = 0; i < 3; ++i) storeLe(to + 8 * i, v[i]);
}

glm::dvec3 loadVector(const std::byte* from) {
    return {loadLe<double>(from), loadLe<double>(from + 8), loadLe<double>(from + 16)};
}

bool finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

tl::unexpected<Error> wrongHeader(std::size_t at, const std::string& reason) {
    return fail(ErrorCode::Importer, fmt::format("its point stream is wrong at byte {}: {}", at, reason));
}

struct CodePair {
    std::uint32_t number;
    ErrorCode code;
};
constexpr CodePair codes[] = {{1, ErrorCode::Malformed}, {2, ErrorCode::Truncated},
                              {3, ErrorCode::Empty},     {4, ErrorCode::Unsupported},
                              {5, ErrorCode::Io},        {6, ErrorCode::ResourceLimit}};

}  // namespace

std::size_t pointBytes(const Attributes& attributes) {
    return 24 + (attributes.color ? 3u : 0u) + (attributes.intensity ? 2u : 0u) +
           (attributes.classification ? 1u : 0u) + (attributes.normal ? 12u : 0u);
}

std::vector<std::byte> encodeHeader(const ScanHeader& header) {
    const auto format = printableText(header.format, longestFormat);
    const auto wkt = printableText(header.crsWkt, longestWkt);
    const auto further = encodeColumns(header.columns);
    const std::size_t scanner = header.scannerOrigin ? scannerBytes : 0;
    std::vector<std::byte> bytes(headerBytes + scanner + format.size() + wkt.size() + further.size());
    auto* data = bytes.data();
    std::memcpy(data, magic.data(), magic.size());
    storeLe(data + atVersion, version);
    const auto& has = header.attributes;
    const unsigned columns = (has.color ? color : 0u) | (has.intensity ? intensity : 0u) |
                             (has.classification ? classification : 0u) | (has.normal ? normal : 0u);
    storeLe(data + atColumns, static_cast<std::uint16_t>(columns));
    const unsigned known = (header.points ? knownPoints : 0u) | (header.bounds ? knownBounds : 0u) |
                           (header.crsEpsg ? knownEpsg : 0u) | (header.scannerOrigin ? knownScanner : 0u);
    storeLe(data + atKnown, static_cast<std::uint32_t>(known));
    storeLe(data + atPoints, header.points.value_or(0));
    storeVector(data + atGridStep, header.gridStep);
    storeVector(data + atGridOrigin, header.gridOrigin);
    if (header.bounds) {
        storeVector(data + atBounds, (*header.bounds)[0]);
        storeVector(data + atBounds + 24, (*header.bounds)[1]);
    }
    storeLe(data + atEpsg, static_cast<std::int32_t>(header.crsEpsg.value_or(0)));
    storeLe(data + atFormatBytes, static_cast<std::uint32_t>(format.size()));
    storeLe(data + atWktBytes, static_cast<std::uint32_t>(wkt.size()));
    storeLe(data + atColumnsBytes, static_cast<std::uint32_t>(further.size()));
    data += headerBytes;
    if (header.scannerOrigin) storeVector(data, *header.scannerOrigin);
    data += scanner;
    if (!format.empty()) std::memcpy(data, format.data(), format.size());
    if (!wkt.empty()) std::memcpy(data + format.size(), wkt.data(), wkt.size());
    if (!further.empty()) std::memcpy(data + format.size() + wkt.size(), further.data(), further.size());
    return bytes;
}

Expected<DecodedHeader> decodeHeader(std::span<const std::byte> bytes) {
    const auto* data = bytes.data();
    if (bytes.size() < headerBytes || std::memcmp(data, magic.data(), magic.size()) != 0)
        return wrongHeader(0, "it does not start as a point stream does");
    if (const auto found = loadLe<std::uint16_t>(data + atVersion); found != version)
        return wrongHeader(atVersion, fmt::format("version {} is not known here, version 1 is", found));
    DecodedHeader decoded;
    auto& header = decoded.header;
    const unsigned columns = loadLe<std::uint16_t>(data + atColumns);
    if (columns > (color | intensity | classification | normal))
        return wrongHeader(atColumns, "unknown columns");
    header.attributes = {(columns & color) != 0, (columns & intensity) != 0, (columns & classification) != 0,
                         (columns & normal) != 0};
    const unsigned known = loadLe<std::uint32_t>(data + atKnown);
    if (known > (knownPoints | knownBounds | knownEpsg | knownScanner))
        return wrongHeader(atKnown, "unknown bits");
    if ((known & knownPoints) != 0) header.points = loadLe<std::uint64_t>(data + atPoints);
    header.gridStep = loadVector(data + atGridStep);
    header.gridOrigin = loadVector(data + atGridOrigin);
    if (!finite(header.gridStep) || header.gridStep.x < 0 || header.gridStep.y < 0 || header.gridStep.z < 0)
        return wrongHeader(atGridStep, "a grid step is negative or not a number");
    if (!finite(header.gridOrigin)) return wrongHeader(atGridOrigin, "the grid's origin is not a number");
    if ((known & knownBounds) != 0) {
        const std::array<glm::dvec3, 2> bounds{loadVector(data + atBounds), loadVector(data + atBounds + 24)};
        if (finite(bounds[0]) && finite(bounds[1])) header.bounds = bounds;
    }
    if ((known & knownEpsg) != 0) header.crsEpsg = loadLe<std::int32_t>(data + atEpsg);
    decoded.hasScanner = (known & knownScanner) != 0;
    decoded.formatBytes = loadLe<std::uint32_t>(data + atFormatBytes);
    decoded.wktBytes = loadLe<std::uint32_t>(data + atWktBytes);
    if (decoded.formatBytes > longestFormat) return wrongHeader(atFormatBytes, "the format text is too long");
    if (decoded.wktBytes > longestWkt) return wrongHeader(atWktBytes, "the WKT text is too long");
    decoded.columnsBytes = loadLe<std::uint32_t>(data + atColumnsBytes);
    if (decoded.columnsBytes > longestColumns)
        return wrongHeader(atColumnsBytes, "the list of columns is too long");
    return decoded;
}

Expected<glm::dvec3> decodeScanner(std::span<const std::byte, scannerBytes> bytes) {
    const glm::dvec3 scanner = loadVector(bytes.data());
    if (!finite(scanner)) return wrongHeader(headerBytes, "the scanner's place is not a number");
    return scanner;
}

std::uint32_t failureCode(ErrorCode code) {
    const auto* found =
        std::find_if(std::begin(codes), std::end(codes), [&](auto& c) { return c.code == code; });
    return found == std::end(codes) ? 1 : found->number;
}

ErrorCode failureCode(std::uint32_t number) {
    const auto* found =
        std::find_if(std::begin(codes), std::end(codes), [&](auto& c) { return c.number == number; });
    return found == std::end(codes) ? ErrorCode::Importer : found->code;
}

}  // namespace scancast::point_stream
