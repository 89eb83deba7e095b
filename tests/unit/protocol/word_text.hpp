// A value of the JSON view as the text of a word: what a query would say.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace scancast::test {

inline std::string textOf(const nlohmann::json& value) {
    if (value.is_null()) return "auto";
    if (value.is_string()) return value.get<std::string>();
    if (!value.is_array()) return value.dump();
    std::string text;
    for (const auto& item : value) text += (text.empty() ? "" : ",") + textOf(item);
    return text;
}

}  // namespace scancast::test
