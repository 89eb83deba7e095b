// What a coordinate reference system means, so that two can be compared, however programs spell them. Heights are
// left aside: what x and y are decides whether scans lie beside each other. Pure functions on text from outside.
// Pipeline: scan header → **meaning** → may scans be put together (build/merged_crs.hpp).
//
// There is no register of the world's systems here. So there are three answers: the same and different are proved by
// what both sides say - numbers, units, zones, parameters -, and what is neither is unclear.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace scancast {

struct CrsMeaning {
    enum class Kind : std::uint8_t { Unknown, Projected, Geographic, Geocentric, Local };
    /// Of a map projection, by whatever names.
    enum Parameter : std::uint8_t {
        Longitude,
        Latitude,
        FirstParallel,
        SecondParallel,
        Scale,
        FalseEasting,
        FalseNorthing
    };
    static constexpr std::size_t parameters = 7;

    std::optional<int> epsg;  ///< of what x and y are, not of a compound with heights
    Kind kind = Kind::Unknown;
    double unit = 0;    ///< of x and y: metres, of Geographic radians; 0 = unknown
    std::string name;   ///< its words in one spelling: "nad 83 utm 10 n"
    std::string datum;  ///< likewise
    std::array<std::optional<double>, parameters> parameter{};  ///< degrees, metres
    std::string text;                                           ///< the WKT without blanks
    /// Metres that one unit of x or y is about; 1 where that is unknown.
    double metres() const;
};

/// As a scan's header has them; nullopt where both are empty: nothing is said.
std::optional<CrsMeaning> crsMeaning(std::string_view wkt, std::optional<int> epsg);

enum class CrsRelation : std::uint8_t { Same, Different, Unclear };
CrsRelation compare(const CrsMeaning& a, const CrsMeaning& b);

}  // namespace scancast
