// Well-known text taken apart: KEYWORD[value, "text", NESTED[…]], as coordinate reference systems are
// written. Pure functions on text from outside.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scancast {

struct WktNode {
    std::string keyword;              ///< upper case
    std::vector<std::string> values;  ///< texts and numbers, without quotation marks, in order
    std::vector<WktNode> nodes;

    /// The first nested node with one of these keywords; nullptr = none.
    const WktNode* find(std::initializer_list<std::string_view> keywords) const;
};

/// nullopt for what is no WKT, is nested deeper than 16, or has more than 10,000 parts.
std::optional<WktNode> parseWkt(std::string_view text);

}  // namespace scancast
