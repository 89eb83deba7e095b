// WMS 1.3.0 (OGC 06-042), annex E.1.
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

std::string wmsBounds(std::string_view crs, const MapBounds& box, bool swapped) {
    const auto at = [&](int corner, int axis) { return box[std::size_t(corner)][swapped ? 1 - axis : axis]; };
    return fmt::format("<BoundingBox CRS=\"{}\" minx=\"{}\" miny=\"{}\" maxx=\"{}\" maxy=\"{}\"/>\n",
                       xmlText(crs), at(0, 0), at(0, 1), at(1, 0), at(1, 1));
}

std::string wmsStyle(std::string_view name, std::string_view title) {
    return "<Style>\n" + xmlElement("Name", name) + xmlElement("Title", title) + "</Style>\n";
}

std::string wmsLayer(const MapFacts& facts) {
    std::string text = "<Layer queryable=\"1\" opaque=\"0\">\n" + xmlElement("Name", facts.layer) +
                       xmlElement("Title", facts.title);
    const std::string own =
        facts.crs && facts.crs->epsg ? fmt::format("EPSG:{}", *facts.crs->epsg) : std::string();
    if (!own.empty()) text += xmlElement("CRS", own);
    for (const char* world : {"EPSG:3857", "EPSG:4326"})
        if (facts.lonLat && own != world) text += xmlElement("CRS", world);
    if (facts.lonLat) text += xmlElement("CRS", "CRS:84");
    if (own.empty()) text += xmlElement("CRS", fileCrs);
    if (facts.lonLat) {
        const MapBounds& box = *facts.lonLat;
        text += fmt::format(
            "<EX_GeographicBoundingBox><westBoundLongitude>{}</westBoundLongitude><eastBoundLongitude>{}</"
            "eastBoundLongitude>"
            "<southBoundLatitude>{}</southBoundLatitude><northBoundLatitude>{}</northBoundLatitude></"
            "EX_GeographicBoundingBox>\n",
            box[0].x, box[1].x, box[0].y, box[1].y);
    }
    if (!own.empty()) text += wmsBounds(own, facts.bounds, facts.crs->northFirst);
    if (facts.mercator && own != "EPSG:3857") text += wmsBounds("EPSG:3857", *facts.mercator, false);
    if (facts.lonLat) {
        if (own != "EPSG:4326") text += wmsBounds("EPSG:4326", *facts.lonLat, true);
        text += wmsBounds("CRS:84", *facts.lonLat, false);
    }
    if (own.empty()) text += wmsBounds(fileCrs, facts.bounds, false);
    if (!facts.attribution.empty())
        text += "<Attribution>" + xmlElement("Title", facts.attribution) + "</Attribution>\n";
    text += wmsStyle("default", "as the cloud is best seen");
    for (const std::string& name : facts.styles) text += wmsStyle(name, name);
    return text + "</Layer>\n";
}

}  // namespace

std::string wmsCapabilities(const MapFacts& facts) {
    const std::string address = wmsAddressOf(facts);
    std::string text =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<WMS_Capabilities version=\"1.3.0\" "
        "xmlns=\"http://www.opengis.net/wms\">\n<Service>\n";
    text += "<Name>WMS</Name>\n" + xmlElement("Title", facts.title);
    text.append(onlineResource).append(xmlText(address)).append("\"/>\n");
    text += fmt::format(
        "<LayerLimit>1</LayerLimit>\n<MaxWidth>{0}</MaxWidth>\n<MaxHeight>{0}</MaxHeight>\n</"
        "Service>\n<Capability>\n<Request>\n",
        facts.widest);
    text += wmsOperation("GetCapabilities", {"text/xml"}, address);
    text += wmsOperation("GetMap", {"image/png", "image/jpeg"}, address);
    text += wmsOperation("GetFeatureInfo",
                         {"application/json", "application/geo+json", "text/plain", "text/html"}, address);
    text += "</Request>\n<Exception><Format>XML</Format></Exception>\n<Layer>\n" +
            xmlElement("Title", facts.title) + wmsLayer(facts);
    return text + "</Layer>\n</Capability>\n</WMS_Capabilities>\n";
}

}  // namespace scancast
