#include "importers/e57/file_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_e57 {

std::uint64_t FileDescription::points() const {
    std::uint64_t sum = 0;
    for (const auto& scan : scans) sum += scan.hasCoordinates() ? scan.records : 0;
    return sum;
}

std::string FileDescription::called(std::size_t scan) const {
    return scans.size() == 1 ? "its scan" : fmt::format("scan {}", scan + 1);
}

Expected<FileDescription> describeFile(PagedFile& file) {
    const auto& header = file.header();
    auto at = file.logicalOffset(header.xmlOffset, "its description (XML)");
    if (!at) return passOn(at);
    if (header.xmlBytes > file.logicalBytes() - *at)
        return fail(
            ErrorCode::Malformed,
            fmt::format("byte 32: its description (XML) is said to have {} bytes; from byte {} there are {}",
                        grouped(header.xmlBytes), grouped(header.xmlOffset),
                        grouped(file.logicalBytes() - *at)));
    if (header.xmlBytes > longestXml)
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("byte 32: its description (XML) has {} bytes; {} are read at most",
                                grouped(header.xmlBytes), grouped(longestXml)));
    auto left = header.xmlBytes;
    const auto bytes = [&](std::span<std::byte> into) -> Expected<std::size_t> {
        const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(into.size(), left));
        if (auto ok = file.read(*at, into.first(count)); !ok) {
            if (ok.error().code == ErrorCode::Malformed)
                ok.error().message +=
                    ". It has what describes its scans (XML), without which no point can be read, not by "
                    "--recover either";
            return passOn(ok);
        }
        *at += count;
        left -= count;
        return count;
    };
    FileDescription result;
    const auto visit = [&](std::string_view list, const XmlElement& record) -> Expected<void> {
        if (list == "images2D") {
            if (auto photo = describePhoto(record); !photo)
                ++result.emptyPhotos;
            else if (result.photos.size() < mostScans)
                result.photos.push_back(std::move(*photo));
            else
                ++result.morePhotos;
        } else if (list == "data3D") {
            if (result.scans.size() == mostScans)
                return fail(ErrorCode::ResourceLimit,
                            fmt::format("it has more than {} scans", grouped(mostScans)));
            auto scan = describeScan(record, fmt::format("scan {}", result.scans.size() + 1));
            if (!scan) return passOn(scan);
            result.scans.push_back(std::move(*scan));
        } else if (record.name == "coordinateMetadata") {
            result.coordinates = record.text;
        }
        return {};
    };
    if (auto ok = readXmlRecords(bytes, visit); !ok) return passOn(ok);
    const bool turned = std::any_of(result.scans.begin(), result.scans.end(),
                                    [](const auto& scan) { return scan.pose && scan.pose->rotates; });
    for (auto& scan : result.scans) scan.besideTurned = turned;
    std::uint64_t room = std::uint64_t(1) << 62;  // each scan's own is checked where its points are
    for (const auto& scan : result.scans) {
        if (scan.records > room)
            return fail(ErrorCode::Malformed, "its scans declare more points than any file can hold");
        room -= scan.records;
    }
    return result;
}

std::optional<glm::dvec3> onlyScannerPosition(const FileDescription& file) {
    std::optional<glm::dvec3> position;
    for (const auto& scan : file.scans) {
        if (scan.records == 0 || !scan.hasCoordinates()) continue;
        if (!scan.standsAtOrigin()) return std::nullopt;
        const auto own = scan.inFile(glm::dvec3(0));
        if (position && glm::distance(*position, own) > 1e-3) return std::nullopt;
        position = own;
    }
    return position;
}

std::uint64_t scansOfUnknownPosition(const FileDescription& file) {
    std::uint64_t unknown = 0;
    for (const auto& scan : file.scans) unknown += scan.hasCoordinates() && !scan.standsAtOrigin();
    return unknown;
}

}  // namespace scancast::import_e57
