#include "renderer/cloud/import/printable_text.hpp"

#include <algorithm>

namespace scancast {

std::string printableText(std::string_view text, std::size_t longest) {
    text = text.substr(0, std::min({text.size(), longest, text.find('\0')}));
    const auto first = text.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) return {};
    text = text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
    std::string result(text);
    for (char& c : result) {
        const bool plain = (c >= ' ' && c <= '~') || c == '\n' || c == '\t';
        if (!plain) c = '?';
    }
    return result;
}

std::string quotedText(std::string_view text) {
    std::string result("\"");
    result += printableText(text, 40);
    result += '"';
    return result;
}

}  // namespace scancast
