#include "server/net/api/router.hpp"

#include <fmt/format.h>

#include <vector>

#include "protocol/nearest_name.hpp"
#include "protocol/view/query.hpp"

namespace scancast {
namespace {

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

constexpr std::string_view apiPrefix = "/api/v1";

constexpr bool areInOrder() {
    for (std::size_t i = 0; i < routes.size(); ++i)
        if (routes[i].route != Route(i)) return false;
    return true;
}
static_assert(areInOrder());

/// What of a request stands for this part of a pattern; nullptr for parts that stand for themselves.
std::string* placeOf(std::string_view part, Routed& routed) {
    if (part == "{id}") return &routed.id;
    if (part == "{n}") return &routed.n;
    if (part == "{set}") return &routed.tile.set;
    if (part == "{z}") return &routed.tile.z;
    if (part == "{x}") return &routed.tile.x;
    if (part == "{y}") return &routed.tile.y;
    return nullptr;
}

// Whether the segments are those of the pattern; what stands for its placeholders is put into `routed`, of which nothing is
// worth anything where they are not.
bool fits(const std::vector<std::string>& segments, std::string_view pattern, Routed& routed) {
    const auto parts = split(pattern);
    if (parts.size() != segments.size()) return false;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        std::string* const place = placeOf(parts[i], routed);
        if (place != nullptr ? segments[i].empty() : segments[i] != parts[i]) return false;
        if (place != nullptr) *place = segments[i];
    }
    return true;
}

}  // namespace

tl::expected<Routed, Problem> route(std::string_view target) {
    if (target.size() > maxTargetLength) {
        return tl::unexpected(
            problemOf(414, fmt::format("The address is longer than {} bytes.", maxTargetLength)));
    }
    if (target.empty() || target.front() != '/') {
        return tl::unexpected(problemOf(400, "The address must be a path that begins with a slash."));
    }
    Routed routed;
    const auto question = target.find('?');
    if (question != std::string_view::npos) routed.query = std::string(target.substr(question + 1));
    const std::string_view path = target.substr(0, question);

    std::vector<std::string> segments;
    for (std::string_view segment : split(path)) {
        auto decoded = percentDecode(segment, "The address");
        if (!decoded) return tl::unexpected(problemOf(decoded.error()));
        routed.path += "/" + *decoded;
        segments.push_back(std::move(*decoded));
    }
    const bool versioned = segments.size() > 2 && segments[0] == "api" && segments[1] == "v1";
    if (versioned) segments.erase(segments.begin(), segments.begin() + 2);
    for (const RouteInfo& info : routes) {
        if (info.route == Route::Asset) continue;
        const bool ofApi = info.pattern.starts_with(apiPrefix);
        if (versioned && !ofApi) continue;
        const auto rest = ofApi ? info.pattern.substr(apiPrefix.size()) : info.pattern;
        Routed fitting = routed;
        if (!fits(segments, rest, fitting)) continue;
        fitting.route = info.route;
        return fitting;
    }
    if (versioned || segments[0] == "api") {
        return tl::unexpected(problemOf(404, "Nothing is served at " + quoteText(routed.path) + "."));
    }
    return routed;
}

}  // namespace scancast
