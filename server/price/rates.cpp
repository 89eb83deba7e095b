#include "server/price/rates.hpp"

#include <nlohmann/json.hpp>

#include "protocol/json_fields.hpp"
#include "protocol/json_text.hpp"

namespace scancast {
namespace {

constexpr double mostRate = 1e6;  // ns: a millisecond for a pixel

Error wrongRate(const std::string& key, const std::string& why) {
    return {ErrorCode::InvalidArgument, key + ": " + why, key};
}

Expected<double> rateOf(const nlohmann::json& value, const std::string& key) {
    if (!value.is_number() || !(value.get<double>() >= 0) || !(value.get<double>() <= mostRate))
        return tl::unexpected(wrongRate(key, "must be a number of nanoseconds, from 0 to 1000000"));
    return value.get<double>();
}

/// Of names that are known: a misspelt one would leave another's rate as it was, and nobody would know.
Expected<void> readRates(const nlohmann::json& object, const std::string& path,
                         std::map<std::string, double>& rates) {
    if (!object.is_object()) return tl::unexpected(wrongRate(path, "must be an object"));
    for (const auto& [name, value] : object.items()) {
        const std::string key = path + "." + name;
        const auto known = rates.find(name);
        if (known == rates.end()) return tl::unexpected(wrongRate(key, "is not known here"));
        const auto rate = rateOf(value, key);
        if (!rate) return passOn(rate);
        known->second = *rate;
    }
    return {};
}

Expected<void> readMethods(const nlohmann::json& object, std::map<std::string, Rates::Method>& methods) {
    if (!object.is_object()) return tl::unexpected(wrongRate("methods", "must be an object"));
    for (const auto& [name, value] : object.items()) {
        const std::string path = "methods." + name;
        const auto known = methods.find(name);
        if (known == methods.end()) return tl::unexpected(wrongRate(path, "is no method of this server"));
        std::map<std::string, double> rates{{"pixel", known->second.pixel}, {"sample", known->second.sample}};
        if (auto ok = readRates(value, path, rates); !ok) return ok;
        known->second = {rates.at("pixel"), rates.at("sample")};
    }
    return {};
}

}  // namespace

const Rates& shippedRates() {
    static const Rates rates{
        {
            {"paraboloid", {7, 6}},
            {"cone", {7, 6}},
            {"sphere", {8, 6}},
            {"circle", {7, 6}},
            {"square", {7, 6}},
            {"point", {4, 4}},
            {"hqs", {14, 14}},
            {"disc", {7, 7}},
            {"ewa", {18, 26}},
            {"voronoi", {28, 26}},
            {"pyramid", {13, 3}},
        },
        {{"phong", 8}, {"eyedome", 5}, {"occlusion", 73}, {"shadow", 10}},
        {{"jpeg", 1.5}, {"png", 15}, {"depth", 1}},
    };
    return rates;
}

Expected<Rates> parseRates(const std::string& text) {
    const auto object = parseJson(text);
    if (!object) return passOn(object);
    if (!object->is_object())
        return fail(
            ErrorCode::Malformed,
            "expected a JSON object such as {\"methods\": {\"ewa\": {\"pixel\": 18, \"sample\": 26}}}");
    Rates rates = shippedRates();
    for (const auto& [key, value] : object->items()) {
        Expected<void> ok;
        if (key == "methods")
            ok = readMethods(value, rates.methods);
        else if (key == "passes")
            ok = readRates(value, key, rates.passes);
        else if (key == "encoders")
            ok = readRates(value, key, rates.encoders);
        else
            ok = tl::unexpected(wrongRate(key, "is not known here; methods, passes and encoders are"));
        if (!ok) return passOn(ok);
    }
    return rates;
}

}  // namespace scancast
