#include "client/cpp/server_url.hpp"

#include <algorithm>
#include <charconv>

#include "protocol/nearest_name.hpp"

namespace scancast::client {
namespace {

constexpr std::string_view advice = "write something like http://127.0.0.1:8080/";

tl::unexpected<Error> refuse(std::string_view text, std::string_view why) {
    return fail(ErrorCode::InvalidArgument,
                quoteText(text) + " is no server's URL: " + std::string(why) + "; " + std::string(advice),
                "URL");
}

bool isHostCharacter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '-' || c == '_';
}

bool isAddressCharacter(char c) {
    return (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F') || (c >= '0' && c <= '9') || c == ':' || c == '.';
}

/// Takes the host off the front of `rest`; empty when there is none.
std::string_view takeHost(std::string_view& rest) {
    if (rest.starts_with('[')) {
        const auto end = rest.find(']');
        if (end == std::string_view::npos) return {};
        const auto host = rest.substr(1, end - 1);
        rest.remove_prefix(end + 1);
        return std::all_of(host.begin(), host.end(), isAddressCharacter) ? host : std::string_view{};
    }
    const auto host = rest.substr(0, rest.find(':'));
    rest.remove_prefix(host.size());
    return std::all_of(host.begin(), host.end(), isHostCharacter) ? host : std::string_view{};
}

}  // namespace

std::string ServerUrl::authority() const {
    const auto number = std::to_string(port);
    return host.find(':') == std::string::npos ? host + ":" + number : "[" + host + "]:" + number;
}

Expected<ServerUrl> parseServerUrl(std::string_view text) {
    std::string_view rest = text;
    bool tls = false;
    if (const auto scheme = rest.find("://"); scheme == std::string_view::npos) {
        return refuse(text, "it does not start with http:// or https://");
    } else {
        const auto name = rest.substr(0, scheme);
        tls = name == "https" || name == "wss";
        if (!tls && name != "http" && name != "ws")
            return refuse(text, "it does not start with http:// or https://");
        rest.remove_prefix(scheme + 3);
    }
    const auto path = rest.find_first_of("/?#");
    if (path != std::string_view::npos && rest.substr(path) != "/")
        return refuse(text, "nothing but / may follow the host and port");
    rest = rest.substr(0, path);

    ServerUrl url;
    url.tls = tls;
    url.port = tls ? 443 : 80;
    url.host = takeHost(rest);
    if (url.host.empty() || url.host.size() > 253) return refuse(text, "the host is missing or malformed");
    if (rest.empty()) return url;
    const auto* end = rest.data() + rest.size();
    const auto number = std::from_chars(rest.data() + 1, end, url.port);
    if (rest.front() != ':' || number.ec != std::errc{} || number.ptr != end || url.port == 0)
        return refuse(text, "the port is no number from 1 to 65535");
    return url;
}

}  // namespace scancast::client
