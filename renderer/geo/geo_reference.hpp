// Where a cloud lies in the world: its coordinates ↔ longitudes and latitudes (WGS 84), and web mercator. The only room that includes
// PROJ, which knows the world's systems from its own database; it asks no network for grids.
//
// What a scan's WKT says is text from outside: it is taken apart by code of ours first (renderer/cloud/import/crs_meaning.hpp), and where
// that finds a number of EPSG's register, PROJ gets the number and never sees the text
// (docs/decisions/034-maps.md). Pipeline: cloud's facts → **geo reference** → renderer/map, lonlat.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// What maps are in, beside a cloud's own coordinates; x is to the east, y to the north.
enum class WorldCrs : std::uint8_t {
    LonLat,       ///< degrees, WGS 84 (OGC:CRS84)
    WebMercator,  ///< metres, EPSG:3857
};

/// What x and y of a cloud are.
struct FileCrs {
    std::optional<int> epsg;  ///< by which maps ask for it; of a compound system that of its horizontal part
    std::string name;
    bool northFirst = false;   ///< EPSG's order of its axes: services that follow it write y before x
    bool degrees = false;      ///< x and y are longitude and latitude
    double metresPerUnit = 1;  ///< of degrees: on the equator
};

/// What a system is made of, for files that must write it down since it has no number.
struct CrsParts {
    struct Base {  ///< its longitudes and latitudes
        std::optional<int> epsg;
        std::string name;
        double semiMajor = 0;          ///< metres
        double inverseFlattening = 0;  ///< 0: a sphere
        double primeMeridian = 0;      ///< degrees east of Greenwich
    };
    Base base;
    int method = 0;  ///< EPSG's number of the way it is projected; 0: of none, or one without a number
    std::map<int, double> parameters{};  ///< by EPSG's numbers: degrees, metres, ratios
};

/// Owned by whoever made it. *Thread safety*: none, not even of const functions - PROJ's objects belong to one thread.
class GeoReference {
  public:
    /// Unsupported, with the reason in a sentence: nothing is known of the coordinates; they are local, or geocentric; PROJ does not
    /// know the system. Takes some milliseconds.
    static Expected<GeoReference> create(const CloudFacts& cloud);

    GeoReference(GeoReference&&) noexcept;
    GeoReference& operator=(GeoReference&&) noexcept;
    ~GeoReference();

    const FileCrs& file() const;
    /// Of x and y. nullopt where PROJ does not tell its ellipsoid.
    std::optional<CrsParts> parts() const;
    /// In place. A place that has none there becomes two infinities.
    void fromFile(WorldCrs world, std::span<glm::dvec2> places) const;
    void toFile(WorldCrs world, std::span<glm::dvec2> places) const;

  private:
    struct Proj;
    explicit GeoReference(std::unique_ptr<Proj> proj);
    std::unique_ptr<Proj> proj_;
};

/// Of PROJ and of its register of systems: where it changes, so may places. Any thread.
std::string projectionsVersion();

}  // namespace scancast
