// What an E57 file says of itself: its scans, its pictures, its coordinates. Pipeline: pages → XML records → **description** →
// points.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "importers/e57/paged_file.hpp"
#include "importers/e57/scan_description.hpp"

namespace scancast::import_e57 {

struct FileDescription {
    std::vector<ScanDescription> scans;
    std::map<std::string, std::uint64_t> pictures;  ///< how many, by pictureKind()
    std::string coordinates;                        ///< coordinateMetadata, WKT as a rule; may be empty

    std::uint64_t points() const;
    std::uint64_t pictureCount() const;
    /// "scan 3", or "its scan" of a file with one.
    std::string called(std::size_t scan) const;
};

inline constexpr std::uint64_t longestXml = std::uint64_t(64) << 20;
inline constexpr std::size_t mostScans = 65535;

/// Errors, without the file's name: Malformed, ResourceLimit for an XML section that is longer, or has more scans, than any;
/// those of the pages.
Expected<FileDescription> describeFile(PagedFile& file);

/// Where all scans were taken from: the position in file coordinates, if it is known of every scan with points and the same.
std::optional<glm::dvec3> onlyScannerPosition(const FileDescription& file);
/// Of how many scans it is not known.
std::uint64_t scansOfUnknownPosition(const FileDescription& file);

}  // namespace scancast::import_e57
