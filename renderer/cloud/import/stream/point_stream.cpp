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
enum HeaderColumn : unsigned { color = 1, intensity = 2, classification = 4, normal = 8, lasRecords = 16 };
enum Known : unsigned {
    knownPoints = 1,
    knownBounds = 2,
    knownEpsg = 4,
    knownScanner = 8,
    stepsForPositions = 16
};

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

std::size_t pointBytes(const Attributes& attributes, bool areSteps) {
    return (areSteps ? stepBytes : sizeof(glm::dvec3)) + (attributes.color ? 3u : 0u) +
           (attributes.intensity ? 2u : 0u) + (attributes.classification ? 1u : 0u) +
           (attributes.normal ? 12u : 0u);
}

std::vector<std::byte> encodeHeader(const ScanHeader& header, bool areSteps, bool newest) {
    const auto format = printableText(header.format, longestFormat);
    const auto wkt = printableText(header.crsWkt, longestWkt);
    const auto further = encodeColumns(header.columns);
    const std::size_t scanner = header.scannerOrigin ? scannerBytes : 0;
    std::vector<std::byte> bytes(headerBytes + scanner + format.size() + wkt.size() + further.size());
    auto* data = bytes.data();
    std::memcpy(data, magic.data(), magic.size());
    storeLe(data + atVersion, areSteps || newest ? newestVersion : version);
    const auto& has = header.attributes;
    const unsigned columns = (has.color ? color : 0u) | (has.intensity ? intensity : 0u) |
                             (has.classification ? classification : 0u) | (has.normal ? normal : 0u);
    storeLe(data + atColumns, static_cast<std::uint16_t>(columns));
    const unsigned known = (header.points ? knownPoints : 0u) | (header.bounds ? knownBounds : 0u) |
                           (header.crsEpsg ? knownEpsg : 0u) | (header.scannerOrigin ? knownScanner : 0u) |
                           (areSteps ? stepsForPositions : 0u);
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

std::vector<std::byte> encodeLasHeader(const LasPreamble& las) {
    const auto format = printableText(las.format, longestFormat);
    std::vector<std::byte> bytes(headerBytes + format.size() + lasLengthsBytes);
    auto* data = bytes.data();
    std::memcpy(data, magic.data(), magic.size());
    storeLe(data + atVersion, newestVersion);
    storeLe(data + atColumns, static_cast<std::uint16_t>(lasRecords));
    storeLe(data + atKnown, static_cast<std::uint32_t>(las.points ? knownPoints : 0u));
    storeLe(data + atPoints, las.points.value_or(0));
    storeLe(data + atFormatBytes, static_cast<std::uint32_t>(format.size()));
    data += headerBytes;
    if (!format.empty()) std::memcpy(data, format.data(), format.size());
    storeLe(data + format.size(), static_cast<std::uint32_t>(las.head.size()));
    storeLe(data + format.size() + 4, static_cast<std::uint32_t>(las.evlrs.size()));
    bytes.insert(bytes.end(), las.head.begin(), las.head.end());
    bytes.insert(bytes.end(), las.evlrs.begin(), las.evlrs.end());
    return bytes;
}

namespace {

/// All that is left of the header where a head of LAS says it.
Expected<void> checkLasHeader(const DecodedHeader& decoded, unsigned columns, unsigned known) {
    const ScanHeader& header = decoded.header;
    if (columns != lasRecords) return wrongHeader(atColumns, "other columns beside records of LAS");
    if ((known & ~unsigned(knownPoints)) != 0)
        return wrongHeader(atKnown, "of records of LAS nothing but their number may be known");
    if (header.gridStep != glm::dvec3(0) || header.gridOrigin != glm::dvec3(0))
        return wrongHeader(atGridStep, "a grid beside records of LAS, which have their own");
    if (decoded.wktBytes > 0 || decoded.columnsBytes > 0)
        return wrongHeader(atWktBytes, "texts beside records of LAS, which say it themselves");
    return {};
}

}  // namespace

Expected<DecodedHeader> decodeHeader(std::span<const std::byte> bytes) {
    const auto* data = bytes.data();
    if (bytes.size() < headerBytes || std::memcmp(data, magic.data(), magic.size()) != 0)
        return wrongHeader(0, "it does not start as a point stream does");
    const auto found = loadLe<std::uint16_t>(data + atVersion);
    if (found != version && found != newestVersion)
        return wrongHeader(atVersion,
                           fmt::format("version {} is not known here, versions 1 and 2 are", found));
    DecodedHeader decoded;
    decoded.version = found;
    auto& header = decoded.header;
    const unsigned columns = loadLe<std::uint16_t>(data + atColumns);
    decoded.isLas = found >= newestVersion && (columns & lasRecords) != 0;
    if ((columns & ~(decoded.isLas ? unsigned(lasRecords) : 0u)) >
        (color | intensity | classification | normal))
        return wrongHeader(atColumns, "unknown columns");
    header.attributes = {(columns & color) != 0, (columns & intensity) != 0, (columns & classification) != 0,
                         (columns & normal) != 0};
    const unsigned known = loadLe<std::uint32_t>(data + atKnown);
    decoded.areSteps = found >= newestVersion && (known & stepsForPositions) != 0;
    if ((known & ~(decoded.areSteps ? unsigned(stepsForPositions) : 0u)) >
        (knownPoints | knownBounds | knownEpsg | knownScanner))
        return wrongHeader(atKnown, "unknown bits");
    if ((known & knownPoints) != 0) header.points = loadLe<std::uint64_t>(data + atPoints);
    header.gridStep = loadVector(data + atGridStep);
    header.gridOrigin = loadVector(data + atGridOrigin);
    if (!finite(header.gridStep) || header.gridStep.x < 0 || header.gridStep.y < 0 || header.gridStep.z < 0)
        return wrongHeader(atGridStep, "a grid step is negative or not a number");
    if (!finite(header.gridOrigin)) return wrongHeader(atGridOrigin, "the grid's origin is not a number");
    if (decoded.areSteps && (header.gridStep.x <= 0 || header.gridStep.y <= 0 || header.gridStep.z <= 0 ||
                             !std::isfinite(StepGrid{header.gridOrigin, header.gridStep}.reach())))
        return wrongHeader(atGridStep,
                           "positions are steps of a grid, and there is none that they could be of");
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
    if (decoded.isLas)
        if (auto ok = checkLasHeader(decoded, columns, known); !ok) return passOn(ok);
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
