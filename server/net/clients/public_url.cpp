#include "server/net/clients/public_url.hpp"

#include <algorithm>
#include <string_view>

namespace scancast {
namespace {

constexpr std::size_t longestPrefix = 200;

/// What a path has that needs no escaping, anywhere.
bool isPath(std::string_view text) {
    return text.size() <= longestPrefix && text.starts_with('/') && std::ranges::all_of(text, [](char c) {
               return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '/' || c == '-' || c == '_' || c == '.' || c == '~';
           });
}

}  // namespace

std::string publicUrl(const HttpRequest& request, bool encrypted, bool trusted) {
    std::string scheme = encrypted ? "https" : "http", prefix;
    if (trusted) {
        const std::string said = lowerCase(request.header("x-forwarded-proto"));
        if (said == "http" || said == "https") scheme = said;
        const std::string path = request.header("x-forwarded-prefix");
        if (isPath(path)) prefix = path;
        while (prefix.ends_with('/')) prefix.pop_back();
    }
    if (request.header("host").empty()) return prefix;  // HTTP/1.0: paths are all that can be said
    std::string url = scheme;
    url += "://";
    url += request.header("host");
    return url + prefix;
}

}  // namespace scancast
