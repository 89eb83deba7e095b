#include "server/commands/config_file.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "files/input_file.hpp"
#include "protocol/json_text.hpp"
#include "protocol/nearest_name.hpp"
#include "remote/remote_url.hpp"

namespace scancast {
namespace {

using nlohmann::json;

constexpr std::size_t longestFile = 1 << 20;
// About the command line itself.
constexpr std::array<std::string_view, 3> notInFiles{"help", "config", "check-config"};

/// Empty for options that no file sets.
std::string keyOf(const CLI::Option& option) {
    if (option.get_lnames().empty()) return option.get_positional() ? filesKey : "";
    const std::string& name = option.get_lnames().front();
    return std::count(notInFiles.begin(), notInFiles.end(), name) > 0 ? "" : name;
}

bool isFlag(const CLI::Option& option) {
    return option.get_items_expected_max() == 0;
}

bool isList(const CLI::Option& option) {
    return option.get_items_expected_max() > 1;
}

Expected<std::string> textOf(const json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_number() || value.is_boolean()) return printJson(value);
    return fail(ErrorCode::InvalidArgument, "expected a string, a number, true or false");
}

Expected<std::vector<std::string>> textsOf(const CLI::Option& option, const json& value) {
    if (isFlag(option) != value.is_boolean())
        return fail(ErrorCode::InvalidArgument,
                    isFlag(option) ? "expected true or false" : "takes more than true or false");
    if (value.is_array() && !isList(option)) return fail(ErrorCode::InvalidArgument, "takes one value");
    std::vector<std::string> texts;
    for (const json& one : value.is_array() ? value : json::array({value})) {
        auto text = textOf(one);
        if (!text) return passOn(std::move(text));
        texts.push_back(std::move(*text));
    }
    return texts;
}

Expected<void> setTexts(CLI::Option& option, const std::vector<std::string>& texts) {
    try {
        option.add_result(texts);
        option.run_callback();
    } catch (const CLI::Error& error) {
        return fail(ErrorCode::InvalidArgument, error.what());
    }
    return {};
}

Expected<void> set(CLI::Option& option, const json& value) {
    const auto texts = textsOf(option, value);
    if (!texts) return passOn(texts);
    if (option.count() > 0 || texts->empty()) return {};
    return setTexts(option, *texts);
}

Expected<json> parseConfig(const std::string& text) {
    auto config = parseJson(text);
    if (config && !config->is_object())
        return fail(ErrorCode::Malformed, "expected a JSON object such as {\"port\": 9000}");
    return config;
}

json valueOf(const std::string& text) {
    const auto number = parseJson(text);
    return number && number->is_number() ? *number : json(text);
}

}  // namespace

Expected<void> applyConfigFile(CLI::App& app, const std::filesystem::path& file) {
    const auto refuse = [&](const Error& error, const std::string& key) {
        const std::string at = key.empty() ? "" : key + ": ";
        return fail(error.code, "--config " + file.string() + ": " + at + error.message, key);
    };
    const auto text = readTextFile(file, longestFile);
    if (!text) return fail(text.error().code, "--config " + text.error().message);
    const auto config = parseConfig(*text);
    if (!config) return refuse(config.error(), "");
    std::vector<std::string> keys;
    std::vector<CLI::Option*> options;
    for (CLI::Option* option : app.get_options()) {
        if (keyOf(*option).empty()) continue;
        keys.push_back(keyOf(*option));
        options.push_back(option);
    }
    const std::vector<std::string_view> known(keys.begin(), keys.end());
    for (const auto& [key, value] : config->items()) {
        const auto at = std::find(keys.begin(), keys.end(), key);
        if (at == keys.end())
            return refuse({ErrorCode::InvalidArgument, unknownName(quoteText(key), key, known), {}}, "");
        if (auto done = set(*options[std::size_t(at - keys.begin())], value); !done)
            return refuse(done.error(), key);
    }
    return {};
}

GivenFlags givenFlags(const CLI::App& app) {
    GivenFlags given;
    for (const CLI::Option* option : app.get_options()) {
        const std::string key = keyOf(*option);
        if (!key.empty() && option->count() > 0) given[key] = option->results();
    }
    return given;
}

Expected<void> applyGivenFlags(CLI::App& app, const GivenFlags& given) {
    for (CLI::Option* option : app.get_options()) {
        const auto at = given.find(keyOf(*option));
        if (at == given.end()) continue;
        if (auto done = setTexts(*option, at->second); !done)
            return fail(done.error().code, at->first + ": " + done.error().message, at->first);
    }
    return {};
}

json effectiveConfig(const CLI::App& app) {
    json config = json::object();
    for (const CLI::Option* option : app.get_options()) {
        const std::string key = keyOf(*option);
        if (key.empty()) continue;
        std::vector<std::string> texts = option->results();
        if (isFlag(*option)) {
            config[key] = option->count() > 0 && option->as<bool>();
            continue;
        }
        if (texts.empty() && !isList(*option) && !option->get_default_str().empty())
            texts = {option->get_default_str()};
        if (texts.empty()) continue;
        json& value = config[key];
        if (!isList(*option)) {
            value = valueOf(texts.front());
            continue;
        }
        for (const std::string& text : texts) value.push_back(valueOf(shownArgument(text)));
    }
    return config;
}

}  // namespace scancast
