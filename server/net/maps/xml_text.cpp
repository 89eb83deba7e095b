#include "server/net/maps/xml_text.hpp"

#include "protocol/text/plain_text.hpp"

namespace scancast {

std::string xmlText(std::string_view text) {
    std::string escaped;
    for (const char c : plainLine(text)) {
        switch (c) {
            case '&':
                escaped += "&amp;";
                break;
            case '<':
                escaped += "&lt;";
                break;
            case '>':
                escaped += "&gt;";
                break;
            case '"':
                escaped += "&quot;";
                break;
            case '\'':
                escaped += "&apos;";
                break;
            default:
                escaped += c;
        }
    }
    return escaped;
}

std::string xmlElement(std::string_view name, std::string_view text) {
    std::string element = "<";
    element.append(name).append(">").append(xmlText(text)).append("</").append(name).append(">\n");
    return element;
}

}  // namespace scancast
