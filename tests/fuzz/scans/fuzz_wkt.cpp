// Any text at all as the WKT of a coordinate reference system: a name or none, a meaning that is the same as itself, and
// relations that go both ways; never a crash. Two texts are parted by a zero byte.
#include <algorithm>
#include <cstdlib>

#include "renderer/cloud/import/assumed_crs.hpp"
#include "renderer/cloud/import/crs_meaning.hpp"
#include "renderer/cloud/import/crs_text.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const std::string_view wkt(reinterpret_cast<const char*>(data), size);
    const auto epsg = epsgOfWkt(wkt);
    if (epsg && (*epsg < 1 || *epsg > 32766)) std::abort();
    // A name or a unit is part of the text, or a few words of ours.
    if (crsName(wkt, epsg).size() > size + 64 || crsUnit(wkt, epsg).size() > size + 64) std::abort();
    const auto parted = std::min(wkt.find('\0'), size);
    const auto first = wkt.substr(0, parted), second = wkt.substr(std::min(parted + 1, size));
    const auto a = crsMeaning(first, epsg), b = crsMeaning(second, std::nullopt);
    if (a.has_value() == (first.empty() && !epsg)) std::abort();
    // Units that contradict each other do so in one and the same text, too: only the text as it is decides.
    if (a && !first.empty() && compare(*a, *a) == CrsRelation::Different) std::abort();
    if (a && b && compare(*a, *b) != compare(*b, *a)) std::abort();
    if (a && !(a->metres() > 0)) std::abort();
    if (const auto crs = parseCrs(wkt); crs && crs->wkt.empty() && !crs->epsg) std::abort();
    return 0;
}
