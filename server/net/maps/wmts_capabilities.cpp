// WMTS 1.0.0 (OGC 07-057r7), clause 7.1.
#include <fmt/format.h>

#include "server/net/maps/capabilities.hpp"
#include "server/net/maps/tile_sets.hpp"
#include "server/net/maps/xml_text.hpp"

namespace scancast {
namespace {

/// m: of a pixel, as OGC takes screens to be.
constexpr double screenPixel = 0.00028;

std::string wmtsCorner(std::string_view name, const glm::dvec2& place, bool swapped) {
    return fmt::format("<{0}>{1} {2}</{0}>\n", name, swapped ? place.y : place.x,
                       swapped ? place.x : place.y);
}

std::string wmtsLimits(std::string_view set, const TileSet& tiles, const MapBounds& bounds) {
    std::string text = "<TileMatrixSetLink>\n" + xmlElement("TileMatrixSet", set) + "<TileMatrixSetLimits>\n";
    for (int z = 0; z < tiles.levels; ++z) {
        const TileRange range = tilesIn(tiles, z, bounds[0], bounds[1]);
        text += fmt::format(
            "<TileMatrixLimits><TileMatrix>{}</TileMatrix><MinTileRow>{}</MinTileRow><MaxTileRow>{}</"
            "MaxTileRow><MinTileCol>{}</MinTileCol>"
            "<MaxTileCol>{}</MaxTileCol></TileMatrixLimits>\n",
            z, range.top, range.bottom, range.left, range.right);
    }
    return text + "</TileMatrixSetLimits>\n</TileMatrixSetLink>\n";
}

std::string wmtsMatrices(std::string_view set, const TileSet& tiles, const std::string& crs, bool swapped,
                         double metres) {
    std::string text =
        "<TileMatrixSet>\n" + xmlElement("ows:Identifier", set) + xmlElement("ows:SupportedCRS", crs);
    if (set == mercatorSet)
        text += xmlElement("WellKnownScaleSet", "urn:ogc:def:wkss:OGC:1.0:GoogleMapsCompatible");
    for (int z = 0; z < tiles.levels; ++z) {
        text += fmt::format(
            "<TileMatrix>\n<ows:Identifier>{}</ows:Identifier>\n<ScaleDenominator>{}</ScaleDenominator>\n", z,
            tiles.side(z) / tileSide * metres / screenPixel);
        text += wmtsCorner("TopLeftCorner", tiles.corner, swapped);
        text += fmt::format(
            "<TileWidth>{0}</TileWidth>\n<TileHeight>{0}</TileHeight>\n<MatrixWidth>{1}</"
            "MatrixWidth>\n<MatrixHeight>{1}</MatrixHeight>\n"
            "</TileMatrix>\n",
            tileSide, std::uint32_t(1) << z);
    }
    return text + "</TileMatrixSet>\n";
}

std::string wmtsStyle(const MapFacts& facts, const MapStyle& style) {
    std::string text = &style == &facts.styles.front() ? "<Style isDefault=\"true\">" : "<Style>";
    text += xmlElement("ows:Title", style.title) + xmlElement("ows:Identifier", style.name);
    text += fmt::format("<LegendURL format=\"image/png\" xlink:href=\"{}\" width=\"{}\" height=\"{}\"/>\n",
                        xmlText(legendAddress(facts, style)), style.legend.width, style.legend.height);
    return text + "</Style>\n";
}

std::string wmtsResource(const MapFacts& facts, std::string_view format, std::string_view end) {
    std::string address = facts.address + "/tiles/{TileMatrixSet}/{TileMatrix}/{TileCol}/{TileRow}.";
    address.append(end).append("?style={Style}");
    const std::string words = printQuery(facts.words);
    if (!words.empty()) address += "&" + words;
    return fmt::format("<ResourceURL format=\"{}\" resourceType=\"tile\" template=\"{}\"/>\n", format,
                       xmlText(address));
}

std::string wmtsOperation(std::string_view name, const MapFacts& facts) {
    const std::string words = printQuery(facts.words);
    std::string address = facts.address + "/wmts?";
    if (!words.empty()) address += words + "&";
    return fmt::format(
        "<ows:Operation name=\"{}\"><ows:DCP><ows:HTTP><ows:Get xlink:href=\"{}\"><ows:Constraint "
        "name=\"GetEncoding\"><ows:AllowedValues>"
        "<ows:Value>KVP</ows:Value></ows:AllowedValues></ows:Constraint></ows:Get></ows:HTTP></ows:DCP></"
        "ows:Operation>\n",
        name, xmlText(address));
}

/// Of the set in the cloud's own coordinates. Where it has no number it is told as WKT, which the standard does not know, but GDAL
/// does: it opens nothing whose system it cannot read.
std::string wmtsCrs(const MapFacts& facts) {
    if (facts.crs && facts.crs->epsg) return fmt::format("urn:ogc:def:crs:EPSG::{}", *facts.crs->epsg);
    if (!facts.wkt.empty()) return facts.wkt;
    return R"(LOCAL_CS["coordinates of the file",UNIT["unknown",1]])";
}

}  // namespace

std::string wmtsCapabilities(const MapFacts& facts, const CloudFacts& cloud) {
    const TileSet own = fileTiles(cloud), mercator = mercatorTiles();
    const std::string ownCrs = wmtsCrs(facts);
    const bool swapped = facts.crs && facts.crs->epsg && facts.crs->northFirst;
    std::string text =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Capabilities xmlns=\"http://www.opengis.net/wmts/1.0\" "
        "xmlns:ows=\"http://www.opengis.net/ows/1.1\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" "
        "version=\"1.0.0\">\n<ows:ServiceIdentification>\n";
    text += xmlElement("ows:Title", facts.title);
    text +=
        "<ows:ServiceType>OGC "
        "WMTS</ows:ServiceType>\n<ows:ServiceTypeVersion>1.0.0</ows:ServiceTypeVersion>\n</"
        "ows:ServiceIdentification>\n";
    text += "<ows:OperationsMetadata>\n" + wmtsOperation("GetCapabilities", facts) +
            wmtsOperation("GetTile", facts) + "</ows:OperationsMetadata>\n";
    text += "<Contents>\n<Layer>\n" + xmlElement("ows:Title", facts.title);
    if (facts.lonLat) {
        text += "<ows:WGS84BoundingBox>\n" + wmtsCorner("ows:LowerCorner", (*facts.lonLat)[0], false) +
                wmtsCorner("ows:UpperCorner", (*facts.lonLat)[1], false) + "</ows:WGS84BoundingBox>\n";
    }
    text += xmlElement("ows:Identifier", facts.layer);
    if (facts.crs && facts.crs->epsg) {
        text += "<ows:BoundingBox crs=\"" + ownCrs + "\">\n" +
                wmtsCorner("ows:LowerCorner", facts.bounds[0], swapped) +
                wmtsCorner("ows:UpperCorner", facts.bounds[1], swapped) + "</ows:BoundingBox>\n";
    }
    for (const MapStyle& style : facts.styles) text += wmtsStyle(facts, style);
    text += "<Format>image/png</Format>\n<Format>image/jpeg</Format>\n";
    if (facts.mercator) text += wmtsLimits(mercatorSet, mercator, *facts.mercator);
    text += wmtsLimits(fileCrs, own, facts.bounds);
    text += wmtsResource(facts, "image/png", "png") + wmtsResource(facts, "image/jpeg", "jpg");
    text += "</Layer>\n";
    if (facts.mercator) text += wmtsMatrices(mercatorSet, mercator, "urn:ogc:def:crs:EPSG::3857", false, 1);
    const double metres = facts.crs ? facts.crs->metresPerUnit : 1;
    text += wmtsMatrices(fileCrs, own, ownCrs, swapped, metres);
    text += "</Contents>\n" + fmt::format("<ServiceMetadataURL xlink:href=\"{}\"/>\n",
                                          xmlText(facts.address + "/wmts/1.0.0/WMTSCapabilities.xml"));
    return text + "</Capabilities>\n";
}

}  // namespace scancast
