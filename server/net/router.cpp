#include "server/net/router.hpp"

#include <optional>
#include <vector>

#include "protocol/nearest_name.hpp"

namespace scancast {
namespace {

std::optional<int> hexDigit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return std::nullopt;
}

// Segments are split before they are decoded, so that an escaped slash stays part of its segment.
std::vector<std::string_view> split(std::string_view path) {
    std::vector<std::string_view> segments;
    while (!path.empty()) {
        path.remove_prefix(1);  // the slash
        const auto end = path.find('/');
        segments.push_back(path.substr(0, end));
        path = end == std::string_view::npos ? std::string_view() : path.substr(end);
    }
    return segments;
}

std::optional<Route> apiRoute(const std::vector<std::string>& s) {
    if (s.size() == 1 && s[0] == "clouds") return Route::Clouds;
    if (s.size() == 1 && s[0] == "methods") return Route::Methods;
    if (s.size() == 1 && s[0] == "stream") return Route::Stream;
    if (s.size() < 2 || s[0] != "clouds" || s[1].empty()) return std::nullopt;
    if (s.size() == 2) return Route::Cloud;
    if (s.size() == 3 && s[2] == "snapshot.jpg") return Route::SnapshotJpeg;
    if (s.size() == 3 && s[2] == "snapshot.png") return Route::SnapshotPng;
    if (s.size() == 3 && s[2] == "snapshot") return Route::Snapshot;
    if (s.size() == 3 && s[2] == "pick") return Route::Pick;
    return std::nullopt;
}

std::optional<Route> serviceRoute(std::string_view path) {
    if (path == "/healthz") return Route::Health;
    if (path == "/readyz") return Route::Ready;
    if (path == "/metrics") return Route::Metrics;
    return std::nullopt;
}

}  // namespace

std::string_view pattern(Route route) {
    switch (route) {
        case Route::Asset:
            return "/";
        case Route::Health:
            return "/healthz";
        case Route::Ready:
            return "/readyz";
        case Route::Metrics:
            return "/metrics";
        case Route::Clouds:
            return "/api/v1/clouds";
        case Route::Cloud:
            return "/api/v1/clouds/{id}";
        case Route::Methods:
            return "/api/v1/methods";
        case Route::SnapshotJpeg:
            return "/api/v1/clouds/{id}/snapshot.jpg";
        case Route::SnapshotPng:
            return "/api/v1/clouds/{id}/snapshot.png";
        case Route::Snapshot:
            return "/api/v1/clouds/{id}/snapshot";
        case Route::Pick:
            return "/api/v1/clouds/{id}/pick";
        case Route::Stream:
            return "/api/v1/stream";
    }
    return "other";
}

bool takesBody(Route route) {
    return route == Route::Snapshot || route == Route::Pick;
}

std::string_view allowedMethods(Route route) {
    return takesBody(route) ? "POST" : "GET, HEAD";
}

Expected<std::string> percentDecode(std::string_view text) {
    std::string decoded;
    decoded.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        char c = text[i];
        if (c == '%') {
            const auto high = i + 1 < text.size() ? hexDigit(text[i + 1]) : std::nullopt;
            const auto low = i + 2 < text.size() ? hexDigit(text[i + 2]) : std::nullopt;
            if (!high || !low) {
                return fail(ErrorCode::InvalidArgument,
                            "The address has a % that two hexadecimal digits do not follow.");
            }
            c = char(*high * 16 + *low);
            i += 2;
        }
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
            return fail(ErrorCode::InvalidArgument, "The address has a control character in it.");
        }
        decoded.push_back(c);
    }
    return decoded;
}

tl::expected<Routed, Problem> route(std::string_view target) {
    if (target.size() > maxTargetLength) {
        return tl::unexpected(
            problemOf(414, "The address is longer than " + std::to_string(maxTargetLength) + " bytes."));
    }
    if (target.empty() || target.front() != '/') {
        return tl::unexpected(problemOf(400, "The address must be a path that starts with a slash."));
    }
    Routed routed;
    const auto question = target.find('?');
    if (question != std::string_view::npos) routed.query = std::string(target.substr(question + 1));
    const std::string_view path = target.substr(0, question);

    std::vector<std::string> segments;
    for (std::string_view segment : split(path)) {
        auto decoded = percentDecode(segment);
        if (!decoded) return tl::unexpected(problemOf(decoded.error()));
        routed.path += "/" + *decoded;
        segments.push_back(std::move(*decoded));
    }
    if (const auto service = serviceRoute(routed.path)) {
        routed.route = *service;
        return routed;
    }
    const bool versioned = segments.size() > 2 && segments[0] == "api" && segments[1] == "v1";
    if (versioned) segments.erase(segments.begin(), segments.begin() + 2);
    if (const auto api = apiRoute(segments)) {
        routed.route = *api;
        if (segments.size() > 1) routed.cloud = segments[1];
        return routed;
    }
    if (versioned || segments[0] == "api") {
        return tl::unexpected(problemOf(404, "Nothing is served at " + quoteText(routed.path) + "."));
    }
    return routed;
}

}  // namespace scancast
