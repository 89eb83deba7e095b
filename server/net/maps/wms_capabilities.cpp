// WMS 1.3.0 (OGC 06-042), annex E.1, and 1.1.1 (01-068r3), annex A.1; legends as 05-078r4 has them.
#include <fmt/format.h>

#include "server/net/maps/capabilities.hpp"
#include "server/net/maps/xml_text.hpp"

namespace scancast {
namespace {

constexpr std::string_view onlineResource =
    "<OnlineResource xmlns:xlink=\"http://www.w3.org/1999/xlink\" xlink:type=\"simple\" xlink:href=\"";

/// An address that programs put their words behind: it ends with '?' or '&'.
std::string wmsAddressOf(const MapFacts& facts) {
    const std::string words = printQuery(facts.words);
    std::string address = facts.address + "/wms?";
    if (!words.empty()) address += words + "&";
    return address;
}

std::string wmsOperation(std::string_view name, std::initializer_list<std::string_view> formats,
                         const std::string& address) {
    std::string text = "<";
    text.append(name).append(">\n");
    for (const std::string_view format : formats) text += xmlElement("Format", format);
    text.append("<DCPType><HTTP><Get>")
        .append(onlineResource)
        .append(xmlText(address))
        .append("\"/></Get></HTTP></DCPType>\n</");
    return text.append(name).append(">\n");
}

/// `isOld`: WMS 1.1.1, where x comes first whatever the system's axes are.
std::string wmsBounds(std::string_view crs, const MapBounds& box, bool northFirst, bool isOld) {
    const bool swapped = northFirst && !isOld;
    const auto at = [&](int corner, int axis) { return box[std::size_t(corner)][swapped ? 1 - axis : axis]; };
    return fmt::format("<BoundingBox {}=\"{}\" minx=\"{}\" miny=\"{}\" maxx=\"{}\" maxy=\"{}\"/>\n",
                       isOld ? "SRS" : "CRS", xmlText(crs), at(0, 0), at(0, 1), at(1, 0), at(1, 1));
}

std::string wmsStyle(const MapFacts& facts, const MapStyle& style) {
    std::string text = "<Style>\n" + xmlElement("Name", style.name) + xmlElement("Title", style.title);
    text += fmt::format("<LegendURL width=\"{}\" height=\"{}\">\n", style.legend.width, style.legend.height) +
            xmlElement("Format", "image/png");
    text.append(onlineResource).append(xmlText(legendAddress(facts, style))).append("\"/>\n</LegendURL>\n");
    return text + "</Style>\n";
}

std::string wmsGeographicBounds(const MapBounds& box, bool isOld) {
    if (isOld)
        return fmt::format("<LatLonBoundingBox minx=\"{}\" miny=\"{}\" maxx=\"{}\" maxy=\"{}\"/>\n", box[0].x,
                           box[0].y, box[1].x, box[1].y);
    return fmt::format(
        "<EX_GeographicBoundingBox><westBoundLongitude>{}</westBoundLongitude><eastBoundLongitude>{}</"
        "eastBoundLongitude>"
        "<southBoundLatitude>{}</southBoundLatitude><northBoundLatitude>{}</northBoundLatitude></"
        "EX_GeographicBoundingBox>\n",
        box[0].x, box[1].x, box[0].y, box[1].y);
}

std::string wmsLayer(const MapFacts& facts, bool isOld) {
    std::string text = "<Layer queryable=\"1\" opaque=\"0\">\n" + xmlElement("Name", facts.layer) +
                       xmlElement("Title", facts.title);
    const std::string_view crs = isOld ? "SRS" : "CRS";
    const std::string own =
        facts.crs && facts.crs->epsg ? fmt::format("EPSG:{}", *facts.crs->epsg) : std::string();
    if (!own.empty()) text += xmlElement(crs, own);
    for (const char* world : {"EPSG:3857", "EPSG:4326"})
        if (facts.lonLat && own != world) text += xmlElement(crs, world);
    if (facts.lonLat && !isOld) text += xmlElement(crs, "CRS:84");
    if (own.empty()) text += xmlElement(crs, fileCrs);
    if (facts.lonLat) text += wmsGeographicBounds(*facts.lonLat, isOld);
    if (!own.empty()) text += wmsBounds(own, facts.bounds, facts.crs->northFirst, isOld);
    if (facts.mercator && own != "EPSG:3857") text += wmsBounds("EPSG:3857", *facts.mercator, false, isOld);
    if (facts.lonLat) {
        if (own != "EPSG:4326") text += wmsBounds("EPSG:4326", *facts.lonLat, true, isOld);
        if (!isOld) text += wmsBounds("CRS:84", *facts.lonLat, false, isOld);
    }
    if (own.empty()) text += wmsBounds(fileCrs, facts.bounds, false, isOld);
    if (!facts.attribution.empty())
        text += "<Attribution>" + xmlElement("Title", facts.attribution) + "</Attribution>\n";
    for (const MapStyle& style : facts.styles) text += wmsStyle(facts, style);
    return text + "</Layer>\n";
}

/// What stands before <Service>, and what that begins with.
std::string_view wmsHead(bool isOld) {
    if (isOld)
        return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!DOCTYPE WMT_MS_Capabilities SYSTEM "
               "\"http://schemas.opengis.net/wms/1.1.1/WMS_MS_Capabilities.dtd\">\n<WMT_MS_Capabilities "
               "version=\"1.1.1\">\n<Service>\n<Name>OGC:WMS</Name>\n";
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<WMS_Capabilities version=\"1.3.0\" "
           "xmlns=\"http://www.opengis.net/wms\" "
           "xmlns:sld=\"http://www.opengis.net/sld\">\n<Service>\n<Name>WMS</Name>\n";
}

}  // namespace

std::string wmsCapabilities(const MapFacts& facts, bool isOld) {
    const std::string address = wmsAddressOf(facts);
    std::string text(wmsHead(isOld));
    text += xmlElement("Title", facts.title);
    text.append(onlineResource).append(xmlText(address)).append("\"/>\n");
    if (!isOld) {
        text +=
            fmt::format("<LayerLimit>1</LayerLimit>\n<MaxWidth>{0}</MaxWidth>\n<MaxHeight>{0}</MaxHeight>\n",
                        facts.widest);
    }
    text += "</Service>\n<Capability>\n<Request>\n";
    const std::string_view xml = isOld ? "application/vnd.ogc.wms_xml" : "text/xml";
    text += wmsOperation("GetCapabilities", {xml}, address);
    text += wmsOperation("GetMap", {"image/png", "image/jpeg"}, address);
    text += wmsOperation("GetFeatureInfo",
                         {"application/json", "application/geo+json", "text/plain", "text/html"}, address);
    text += wmsOperation(isOld ? "GetLegendGraphic" : "sld:GetLegendGraphic", {"image/png", "image/jpeg"},
                         address);
    text += "</Request>\n<Exception>";
    text += xmlElement("Format", isOld ? "application/vnd.ogc.se_xml" : "XML") + "</Exception>\n<Layer>\n";
    text += xmlElement("Title", facts.title) + wmsLayer(facts, isOld);
    text += "</Layer>\n</Capability>\n";
    return text + (isOld ? "</WMT_MS_Capabilities>\n" : "</WMS_Capabilities>\n");
}

}  // namespace scancast
