// What an E57 file says of itself: its scans, its photos, its coordinates. Pipeline: pages → XML records → **description** →
// points.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "importers/e57/paged_file.hpp"
#include "importers/e57/photos.hpp"
#include "importers/e57/scan_description.hpp"

namespace scancast::import_e57 {

struct FileDescription {
    std::vector<ScanDescription> scans;
    std::vector<PhotoDescription> photos;
    std::uint64_t emptyPhotos = 0;  ///< entries for photos without one
    std::uint64_t morePhotos = 0;   ///< that are not described
    std::string coordinates;        ///< coordinateMetadata, WKT as a rule; may be empty

    std::uint64_t points() const;
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
