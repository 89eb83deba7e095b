#include "client/cpp/program/points/say_values.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "client/cpp/program/say.hpp"
#include "protocol/json_text.hpp"

namespace scancast::client {
namespace {

std::string plainValue(const nlohmann::json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_null()) return "not known";
    if (!value.is_array()) return printJson(value);
    std::string line;
    for (const auto& one : value) line += (line.empty() ? "" : " ") + plainValue(one);
    return line;
}

void sayUnder(const std::string& name, const nlohmann::json& value) {
    const std::string start = name.empty() ? "" : name + ".";
    if (value.is_object()) {
        for (const auto& [key, inner] : value.items()) sayUnder(start + key, inner);
        return;
    }
    const bool isListOfObjects =
        value.is_array() &&
        std::any_of(value.begin(), value.end(), [](const auto& one) { return one.is_object(); });
    if (isListOfObjects) {
        for (std::size_t i = 0; i < value.size(); ++i) sayUnder(start + std::to_string(i), value[i]);
        return;
    }
    sayOn(stdout, "%-24s %s\n", name.c_str(), plainValue(value).c_str());
}

}  // namespace

void sayValues(const nlohmann::json& object) {
    sayUnder({}, object);
}

}  // namespace scancast::client
