#include "importers/pcl/pcd_import.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>

#include "importers/pcl/pcd_body.hpp"
#include "importers/pcl/point_converter.hpp"
#include "renderer/cloud/import/lost_points.hpp"

namespace scancast::import_pcl {

namespace {

std::string formatText(const PcdHeader& header) {
    static constexpr const char* kinds[] = {"ascii", "binary", "binary_compressed"};
    return "PCD " + header.version + ", " + kinds[static_cast<int>(header.data)];
}

}  // namespace

Expected<void> importPcd(const std::string& file, PointStreamWriter& writer, bool recover) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) return fail(ErrorCode::Io, "it cannot be opened: " + std::generic_category().message(errno));
    const auto fileBytes = static_cast<std::uint64_t>(stream.tellg());
    std::string start(std::min<std::uint64_t>(fileBytes, longestPcdHeader), '\0');
    stream.seekg(0);
    stream.read(start.data(), static_cast<std::streamsize>(start.size()));
    start.resize(static_cast<std::size_t>(stream.gcount()));
    auto header = checkPcdHeader(start, fileBytes, recover);
    if (!header) return passOn(header);
    std::string lost;
    if (recover) {
        const auto whole = wholePcdPoints(file, fileBytes, *header);
        if (!whole) return passOn(whole);
        if (*whole == 0) return fail(ErrorCode::Truncated, "it ends before its first point does");
        if (*whole < header->points) lost = lostPoints("it", header->points, *whole);
        header->points = *whole;
    }

    ValueRanges ranges;
    if (needsRanges(header->meanings)) {
        const auto measured =
            readPcdPoints(file, fileBytes, *header, [&](const RawPoint& point) -> Expected<void> {
                ranges.take(point, header->meanings);
                return {};
            });
        if (!measured) return measured;
    }
    ScanHeader scan;
    scan.format = formatText(*header);
    scan.points = header->points;
    scan.attributes = header->meanings.attributes();
    scan.scannerOrigin = header->viewpoint;
    if (auto ok = writer.writeHeader(scan); !ok) return ok;
    if (!lost.empty())
        if (auto ok = writer.writeNote(lost); !ok) return ok;
    PointConverter converter(header->meanings, ranges, writer);
    const auto sent =
        readPcdPoints(file, fileBytes, *header, [&](const RawPoint& point) { return converter.add(point); });
    if (!sent) return sent;
    return converter.finish();
}

}  // namespace scancast::import_pcl
