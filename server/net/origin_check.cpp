#include "server/net/origin_check.hpp"

#include <algorithm>
#include <optional>

#include "protocol/nearest_name.hpp"
#include "server/net/clients/ip_address.hpp"

namespace scancast {
namespace {

std::string lower(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
    return result;
}

struct Authority {
    std::string host;  ///< lower case; IPv6 without brackets; without a trailing dot
    std::string port;  ///< may be empty
};

bool isPort(std::string_view text) {
    return !text.empty() && text.size() <= 5 &&
           std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool isAddress(const std::string& host) {
    return IpAddress::parse(host).has_value();
}

bool isName(std::string_view host) {
    return !host.empty() && host.size() <= 253 && std::all_of(host.begin(), host.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '.' || c == '_';
    });
}

// host[:port] or [v6][:port]; nothing else, no user, no path.
std::optional<Authority> parseAuthority(std::string_view text) {
    const std::string all = lower(text);
    Authority authority;
    std::string_view rest;
    if (!all.empty() && all.front() == '[') {
        const auto close = all.find(']');
        if (close == std::string::npos) return std::nullopt;
        authority.host = all.substr(1, close - 1);
        if (!isAddress(authority.host)) return std::nullopt;
        rest = std::string_view(all).substr(close + 1);
    } else {
        const auto colon = all.find(':');
        authority.host = all.substr(0, colon);
        if (!authority.host.empty() && authority.host.back() == '.') authority.host.pop_back();
        if (!isName(authority.host)) return std::nullopt;
        if (colon != std::string::npos) rest = std::string_view(all).substr(colon);
    }
    if (!rest.empty()) {
        if (rest.front() != ':' || !isPort(rest.substr(1))) return std::nullopt;
        authority.port = std::string(rest.substr(1));
    }
    return authority;
}

struct Origin {
    std::string scheme;
    Authority authority;
    std::string effectivePort() const {
        if (!authority.port.empty()) return authority.port;
        return scheme == "https" ? "443" : "80";
    }
};

std::optional<Origin> parseOrigin(std::string_view text) {
    const auto separator = text.find("://");
    if (separator == std::string_view::npos) return std::nullopt;
    Origin origin;
    origin.scheme = lower(text.substr(0, separator));
    if (origin.scheme != "http" && origin.scheme != "https") return std::nullopt;
    const auto authority = parseAuthority(text.substr(separator + 3));
    if (!authority) return std::nullopt;
    origin.authority = *authority;
    return origin;
}

/// An address of version 6 may stand without brackets, because no port follows.
std::optional<Authority> parseAllowedHost(std::string_view text) {
    const std::string name = lower(text);
    if (isAddress(name)) return Authority{name, {}};
    auto authority = parseAuthority(text);
    if (authority && !authority->port.empty()) return std::nullopt;
    return authority;
}

bool isLoopback(const std::string& host) {
    return host == "localhost" || host == "::1" || (isAddress(host) && host.rfind("127.", 0) == 0);
}

bool same(const Origin& a, const Origin& b) {
    return a.scheme == b.scheme && a.authority.host == b.authority.host &&
           a.effectivePort() == b.effectivePort();
}

}  // namespace

Expected<void> checkHost(const std::vector<std::string>& hostHeaders, const OriginRules& rules) {
    if (hostHeaders.size() != 1)
        return fail(ErrorCode::InvalidArgument, "A request needs exactly one Host header.");
    const auto host = parseAuthority(hostHeaders.front());
    if (!host) {
        return fail(ErrorCode::InvalidArgument,
                    "The Host header " + quoteText(hostHeaders.front()) + " is malformed.");
    }
    const std::string bind = lower(rules.bindHost);
    if (host->host == bind || isLoopback(host->host)) return {};
    if (!isLoopback(bind) && isAddress(host->host)) return {};
    for (const std::string& allowed : rules.allowedHosts) {
        const auto name = parseAllowedHost(allowed);
        if (name && name->host == host->host) return {};
    }
    for (const std::string& allowed : rules.allowedOrigins) {
        const auto origin = parseOrigin(allowed);
        if (origin && origin->authority.host == host->host) return {};
    }
    return fail(ErrorCode::Unsupported,
                "This server does not answer to the name " + quoteText(host->host) +
                    ". To allow that name, start the server with --allowed-host NAME.");
}

bool isAllowedOrigin(std::string_view origin, const OriginRules& rules) {
    const auto given = parseOrigin(origin);
    return given &&
           std::any_of(rules.allowedOrigins.begin(), rules.allowedOrigins.end(), [&](const auto& allowed) {
               const auto known = parseOrigin(allowed);
               return known && same(*given, *known);
           });
}

Expected<void> checkOrigin(const std::vector<std::string>& originHeaders, std::string_view host,
                           const OriginRules& rules) {
    if (originHeaders.empty()) return {};
    const auto refused = fail(ErrorCode::Unsupported,
                              "Pages of " + quoteText(originHeaders.front()) +
                                  " may not use this server, unless it is started with --allowed-origin.");
    if (originHeaders.size() != 1) return refused;
    if (isAllowedOrigin(originHeaders.front(), rules)) return {};
    const auto origin = parseOrigin(originHeaders.front());
    const auto own = parseAuthority(host);
    if (!origin || !own || origin->authority.host != own->host) return refused;
    // TLS may end at a proxy, so the scheme of our own origin is not known here; its default port is.
    const std::string ownPort = own->port.empty() ? (origin->scheme == "https" ? "443" : "80") : own->port;
    if (origin->effectivePort() != ownPort) return refused;
    return {};
}

std::string frameAncestors(const OriginRules& rules) {
    std::string list = "'self'";
    for (const std::string& allowed : rules.allowedOrigins) {
        const auto origin = parseOrigin(allowed);
        if (!origin || origin->authority.host.find(':') != std::string::npos) continue;
        list += " " + origin->scheme + "://" + origin->authority.host;
        if (!origin->authority.port.empty()) list += ":" + origin->authority.port;
    }
    return list;
}

Expected<void> checkAllowedOrigin(std::string_view origin) {
    if (parseOrigin(origin)) return {};
    return fail(ErrorCode::InvalidArgument,
                quoteText(origin) +
                    " is no origin; it looks like https://viewer.example.org or "
                    "http://localhost:3000.",
                "allowed-origin");
}

Expected<void> checkAllowedHost(std::string_view host) {
    if (parseAllowedHost(host)) return {};
    return fail(ErrorCode::InvalidArgument,
                quoteText(host) +
                    " is no name of a host; it looks like scans.example.org, without scheme, port or "
                    "patterns: each name is given by a flag of its own.",
                "allowed-host");
}

}  // namespace scancast
