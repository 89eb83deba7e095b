// Photos in an E57 file (images2D): what each shows and where its bytes are; sent behind the points, one after the other. Nothing
// in their descriptions is believed. Pipeline: XML records → **photos** → point stream.
//
// A photo that cannot be read costs no point: it is left out, and the reason is counted.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "importers/e57/paged_file.hpp"
#include "importers/e57/xml_records.hpp"
#include "renderer/cloud/import/stream/point_stream_writer.hpp"
#include "renderer/cloud/stations/photo.hpp"

namespace scancast::import_e57 {

struct PhotoDescription {
    Photo photo;                ///< without its format, bytes and station
    std::string scan;           ///< guid of the scan that it belongs to; may be empty
    std::uint64_t section = 0;  ///< physical offset of its bytes' section
    std::uint64_t bytes = 0;    ///< as declared
};

/// `picture`: an entry of images2D. nullopt: there are no encoded pixels in it. Of several representations, the one that says
/// most of what its pixels show.
std::optional<PhotoDescription> describePhoto(const XmlElement& picture);

class Photos {
  public:
    /// Looks at the first bytes of each. `more`: how many there are besides. `stationOf`: of a scan's guid.
    Photos(PagedFile& file, const std::vector<PhotoDescription>& described, std::uint64_t more,
           const std::function<std::optional<std::uint32_t>(const std::string& guid)>& stationOf);

    bool empty() const { return found_.empty(); }
    /// Behind the stations. Errors, of all members: the writer's.
    Expected<void> describe(PointStreamWriter& writer) const;
    /// Behind the points; then, how many were left out, and why.
    Expected<void> send(PointStreamWriter& writer);

  private:
    struct Found {
        Photo photo;
        std::uint64_t at = 0;  ///< logical offset of its bytes
    };
    /// Why it is none to be read; nullptr: it is.
    const char* find(const PhotoDescription& described, Found& found);

    PagedFile& file_;
    std::vector<Found> found_;
    std::uint64_t bytes_ = 0;                       ///< of all of these
    std::map<std::string, std::uint64_t> leftOut_;  ///< how many, by the reason
};

}  // namespace scancast::import_e57
