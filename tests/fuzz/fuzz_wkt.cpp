// Any text at all as the WKT of a coordinate reference system: a name or none, never a crash.
#include <cstdlib>

#include "renderer/cloud/import/crs_text.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const std::string_view wkt(reinterpret_cast<const char*>(data), size);
    const auto epsg = epsgOfWkt(wkt);
    if (epsg && (*epsg < 1 || *epsg > 32766)) std::abort();
    // A name or a unit is part of the text, or a few words of ours.
    if (crsName(wkt, epsg).size() > size + 64 || crsUnit(wkt, epsg).size() > size + 64) std::abort();
    return 0;
}
