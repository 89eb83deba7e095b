#include "remote/cloud_list.hpp"

#include <algorithm>

#include "protocol/json_text.hpp"

namespace scancast {
namespace {

constexpr std::size_t mostWords = 100'000;

tl::unexpected<Error> malformed(std::string_view why) {
    return fail(ErrorCode::Malformed, "it is no list of clouds: " + std::string(why));
}

std::string_view trimmedLine(std::string_view line) {
    const auto isBlank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!line.empty() && isBlank(line.front())) line.remove_prefix(1);
    while (!line.empty() && isBlank(line.back())) line.remove_suffix(1);
    return line;
}

Expected<std::vector<std::string>> wordsOfJson(std::string_view text) {
    const auto json = parseJson(text);
    if (!json) return malformed(json.error().message);
    const bool isObject = json->is_object() && json->contains("clouds");
    const nlohmann::json& list = isObject ? (*json)["clouds"] : *json;
    if (!list.is_array()) return malformed("expected an array of texts, or {\"clouds\": [...]}");
    if (list.size() > mostWords) return malformed("it names more than 100000");
    std::vector<std::string> words;
    for (const nlohmann::json& word : list) {
        if (!word.is_string()) return malformed("its array holds something else than texts");
        words.push_back(word.get<std::string>());
    }
    return words;
}

/// Whether it begins as a URL does, of whatever scheme.
bool hasScheme(std::string_view word) {
    const auto colon = word.find(':');
    return colon != word.npos && colon > 0 && word.substr(colon).starts_with("://") &&
           word.substr(0, colon).find_first_of("/?#.%") == word.npos;
}

/// Whether it may be meant as a cloud's: sentences, which servers answer as well, are not.
bool isOfCloud(std::string_view word) {
    const std::string_view path = word.substr(0, word.find('?'));
    return path.ends_with(".scan") || path.ends_with(".laz") || path.ends_with("/ept.json") ||
           (hasScheme(word) && word.find(' ') == word.npos);
}

bool hasDots(std::string_view path) {
    path = path.substr(0, path.find('?'));
    for (std::size_t at = 0; at <= path.size();) {
        const auto end = std::min(path.find('/', at), path.size());
        if (path.substr(at, end - at) == "..") return true;
        at = end + 1;
    }
    return false;
}

std::string asUrl(std::string_view word) {
    std::string url;
    for (const char c : word) {
        const bool isOfUrls =
            c > 0x20 && c < 0x7f && std::string_view("\"<>\\^`{|}").find(c) == std::string_view::npos;
        url += isOfUrls ? std::string(1, c) : percentEncoded(std::string_view(&c, 1));
    }
    return url;
}

}  // namespace

Expected<std::vector<std::string>> parseCloudList(std::string_view text) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    const auto first = text.find_first_not_of(" \t\r\n");
    if (first == text.npos)
        return malformed("nothing stands in it (write a line that begins with # where there is none)");
    if (text[first] == '<') return malformed("it begins as a page of HTML or XML does");
    if (text[first] == '[' || text[first] == '{') return wordsOfJson(text);
    std::vector<std::string> words;
    for (std::size_t at = 0; at < text.size();) {
        const auto end = std::min(text.find('\n', at), text.size());
        const std::string_view line = trimmedLine(text.substr(at, end - at));
        at = end + 1;
        if (line.empty() || line.starts_with('#')) continue;
        if (line.find('\0') != line.npos) return malformed("it is no text");
        if (words.size() == mostWords) return malformed("it names more than 100000");
        words.emplace_back(line);
    }
    if (!words.empty() && std::ranges::none_of(words, isOfCloud))
        return malformed("no line of it is a URL, or a name that ends with .scan, .laz or /ept.json");
    return words;
}

Expected<RemoteUrl> urlIn(const RemoteUrl& list, std::string_view word) {
    using Scheme = RemoteUrl::Scheme;
    const bool ofS3 = list.scheme() == Scheme::S3;
    if (word.empty() || hasDots(word))
        return fail(ErrorCode::InvalidArgument, "a name in a list is not empty, and has no .. in it");
    if (hasScheme(word)) {
        auto url = RemoteUrl::parse(word);
        if (!url) return url;
        if (url->scheme() == Scheme::S3 && !ofS3)
            return fail(
                ErrorCode::InvalidArgument,
                url->shown() + ": only a list that is in S3 itself names what is asked for with credentials");
        if (url->scheme() == Scheme::Http && list.scheme() != Scheme::Http)
            return fail(ErrorCode::InvalidArgument,
                        url->shown() + ": a list that came encrypted names nothing that does not");
        return url;
    }
    if (ofS3) {
        const std::string folder = list.key().substr(0, list.key().rfind('/') + 1);
        return RemoteUrl::parse(
            "s3://" + list.bucket() + "/" +
            (word.starts_with('/') ? std::string(word.substr(1)) : folder + std::string(word)));
    }
    const std::string& shown = list.shown();
    const auto path = shown.find('/', shown.find("://") + 3);
    const std::string base = shown.substr(0, word.starts_with('/') ? path : shown.rfind('/') + 1);
    return RemoteUrl::parse(base + asUrl(word));
}

}  // namespace scancast
