#include "tests/support/json_schema.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

namespace scancast::test {
namespace {

using nlohmann::json;
using Errors = std::vector<std::string>;

struct Check {
    const json& document;
    const json& schema;
    const json& value;
    const std::string& path;
    Errors& errors;

    void wrong(const std::string& what) const { errors.push_back(path + ": " + what); }
    void also(const json& other, const json& part, const std::string& at) const {
        const Errors found = schemaErrors(document, other, part, at);
        errors.insert(errors.end(), found.begin(), found.end());
    }
};

bool isOfType(const json& value, const std::string& type) {
    if (type == "integer")
        return value.is_number_integer() ||
               (value.is_number() && value.get<double>() == double(std::int64_t(value.get<double>())));
    if (type == "number") return value.is_number();
    if (type == "string") return value.is_string();
    if (type == "boolean") return value.is_boolean();
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    return type == "null" && value.is_null();
}

void checkType(const Check& c, const json& types) {
    const json list = types.is_array() ? types : json::array({types});
    if (std::none_of(list.begin(), list.end(), [&](const json& one) { return isOfType(c.value, one); }))
        c.wrong("is no " + types.dump());
}

void checkProperties(const Check& c, const json& properties) {
    if (!c.value.is_object()) return;
    for (const auto& [name, schema] : properties.items())
        if (c.value.contains(name)) c.also(schema, c.value[name], c.path + "." + name);
}

void checkAdditional(const Check& c, const json& allowed) {
    if (!c.value.is_object()) return;
    const json none = json::object();
    const json& named = c.schema.contains("properties") ? c.schema["properties"] : none;
    for (const auto& [name, member] : c.value.items()) {
        if (named.contains(name)) continue;
        if (allowed == json(false)) c.wrong("has " + name + ", which is not described");
        if (allowed.is_object()) c.also(allowed, member, c.path + "." + name);
    }
}

void checkRequired(const Check& c, const json& names) {
    if (!c.value.is_object()) return;
    for (const std::string name : names)
        if (!c.value.contains(name)) c.wrong("lacks " + name);
}

void checkItems(const Check& c, const json& schema) {
    if (!c.value.is_array()) return;
    for (std::size_t i = 0; i < c.value.size(); ++i)
        c.also(schema, c.value[i], c.path + "[" + std::to_string(i) + "]");
}

void checkAnyOf(const Check& c, const json& schemas) {
    Errors all;
    for (const json& schema : schemas) {
        const Errors found = schemaErrors(c.document, schema, c.value, c.path);
        if (found.empty()) return;
        all.insert(all.end(), found.begin(), found.end());
    }
    c.wrong("fits none of anyOf");
    c.errors.insert(c.errors.end(), all.begin(), all.end());
}

template <class Holds>
std::function<void(const Check&, const json&)> numeric(Holds holds, const char* what) {
    return [=](const Check& c, const json& limit) {
        if (c.value.is_number() && !holds(c.value.get<double>(), limit.get<double>()))
            c.wrong(what + limit.dump());
    };
}

void ignore(const Check&, const json&) {}

using Keyword = std::function<void(const Check&, const json&)>;
const std::map<std::string, Keyword>& keywords() {
    static const std::map<std::string, Keyword> known{
        {"type", checkType},
        {"properties", checkProperties},
        {"additionalProperties", checkAdditional},
        {"required", checkRequired},
        {"items", checkItems},
        {"anyOf", checkAnyOf},
        {"enum",
         [](const Check& c, const json& values) {
             if (std::find(values.begin(), values.end(), c.value) == values.end())
                 c.wrong("is none of " + values.dump());
         }},
        {"const",
         [](const Check& c, const json& only) {
             if (c.value != only) c.wrong("is not " + only.dump());
         }},
        {"minimum", numeric(std::greater_equal<>(), "is below ")},
        {"maximum", numeric(std::less_equal<>(), "is above ")},
        {"exclusiveMinimum", numeric(std::greater<>(), "is not above ")},
        {"exclusiveMaximum", numeric(std::less<>(), "is not below ")},
        {"minItems",
         [](const Check& c, const json& n) {
             if (c.value.is_array() && c.value.size() < n.get<std::size_t>()) c.wrong("has too few items");
         }},
        {"maxItems",
         [](const Check& c, const json& n) {
             if (c.value.is_array() && c.value.size() > n.get<std::size_t>()) c.wrong("has too many items");
         }},
        {"minLength",
         [](const Check& c, const json& least) {
             if (c.value.is_string() &&
                 c.value.get_ref<const std::string&>().size() < least.get<std::size_t>())
                 c.wrong("is shorter than " + least.dump());
         }},
        {"maxLength",
         [](const Check& c, const json& most) {
             if (c.value.is_string() &&
                 c.value.get_ref<const std::string&>().size() > most.get<std::size_t>())
                 c.wrong("is longer than " + most.dump());
         }},
        {"pattern",
         [](const Check& c, const json& pattern) {
             if (c.value.is_string() &&
                 !std::regex_search(c.value.get<std::string>(), std::regex(pattern.get<std::string>())))
                 c.wrong("does not match " + pattern.dump());
         }},
        {"description", ignore},
        {"default", ignore},          // what holds where nothing is sent
        {"format", ignore},           // an annotation, as the standard has it
        {"contentEncoding", ignore},  // of bytes that are no JSON
    };
    return known;
}

}  // namespace

const json& resolved(const json& document, const json& value) {
    if (!value.is_object() || !value.contains("$ref")) return value;
    return document.at(json::json_pointer(value["$ref"].get<std::string>().substr(1)));
}

Errors schemaErrors(const json& document, const json& schema, const json& value, const std::string& path) {
    const json& whole = resolved(document, schema);
    Errors errors;
    for (const auto& [keyword, argument] : whole.items()) {
        const auto known = keywords().find(keyword);
        if (known == keywords().end()) {
            errors.push_back(path + ": the schema has " + keyword + ", which this checker does not know");
        } else {
            known->second(Check{document, whole, value, path, errors}, argument);
        }
    }
    return errors;
}

}  // namespace scancast::test
