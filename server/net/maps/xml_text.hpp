// Text in XML. Pure functions; any thread.
#pragma once

#include <string>
#include <string_view>

namespace scancast {

/// As it may stand between tags and in attributes, in a line: what XML has a meaning for is escaped, and a '?' stands for characters that
/// it does not allow and bytes that are no UTF-8.
std::string xmlText(std::string_view text);

/// <name>text</name>, in a line of its own.
std::string xmlElement(std::string_view name, std::string_view text);

}  // namespace scancast
