#include "server/net/maps/service_exception.hpp"

#include "server/net/maps/xml_text.hpp"

namespace scancast {
namespace {

/// OGC 06-042, table E.1; empty where none fits.
std::string_view wmsCode(std::string_view field) {
    if (field == "CRS") return "InvalidCRS";
    if (field == "SRS") return "InvalidSRS";
    if (field == "FORMAT" || field == "INFO_FORMAT") return "InvalidFormat";
    if (field == "LAYERS" || field == "LAYER" || field == "QUERY_LAYERS") return "LayerNotDefined";
    if (field == "STYLES" || field == "STYLE") return "StyleNotDefined";
    if (field == "I" || field == "J" || field == "X" || field == "Y") return "InvalidPoint";
    if (field == "REQUEST") return "OperationNotSupported";
    return {};
}

/// OGC 06-121r3, table 25, and 07-057r7, table 24.
std::string_view owsCode(const Problem& problem, std::string_view field) {
    if (field == "REQUEST") return "OperationNotSupported";
    if (field == "TILEROW" || field == "TILECOL") return "TileOutOfRange";
    return problem.status == 400 && !field.empty() ? "InvalidParameterValue" : "NoApplicableCode";
}

std::string xmlAttribute(std::string_view name, std::string_view value) {
    if (value.empty()) return {};
    std::string text = " ";
    return text.append(name).append("=\"").append(xmlText(value)).append("\"");
}

}  // namespace

HttpResponse exceptionResponse(MapService service, const Problem& problem, std::string_view field) {
    HttpResponse response = problemResponse(problem);
    if (service == MapService::Plain) return response;
    response.problem.reset();
    std::erase_if(response.headers, [](const auto& header) { return header.first == "Content-Type"; });
    response.set("Content-Type", "text/xml; charset=utf-8");
    std::string& text = response.text;
    text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    if (service == MapService::Wms) {
        text +=
            "<ServiceExceptionReport version=\"1.3.0\" "
            "xmlns=\"http://www.opengis.net/ogc\">\n<ServiceException";
        text += xmlAttribute("code", wmsCode(field));
        text += xmlAttribute("locator", field);
        text += ">" + xmlText(problem.detail) + "</ServiceException>\n</ServiceExceptionReport>\n";
        return response;
    }
    text +=
        "<ExceptionReport xmlns=\"http://www.opengis.net/ows/1.1\" version=\"1.1.0\" "
        "xml:lang=\"en\">\n<Exception";
    text += xmlAttribute("exceptionCode", owsCode(problem, field));
    text += xmlAttribute("locator", field);
    text += ">\n" + xmlElement("ExceptionText", problem.detail) + "</Exception>\n</ExceptionReport>\n";
    return response;
}

}  // namespace scancast
