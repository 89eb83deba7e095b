// Which route a request is for. Pure functions; any thread.
// Pipeline: http session → **router** → api.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "protocol/error.hpp"
#include "protocol/problem.hpp"

namespace scancast {

enum class Route : std::uint8_t {
    Asset,  ///< the page and what belongs to it
    OpenApi,
    Health,
    Ready,
    Metrics,
    Clouds,
    Cloud,
    Methods,
    SnapshotJpeg,
    SnapshotPng,
    Snapshot,  ///< Accept chooses
    Pick,
    StreamMjpeg,
    Stream,
    Sessions,
    SessionView,
};

struct RouteInfo {
    Route route;
    std::string_view pattern;  ///< as it is named in metrics and in openapi.json: "/api/v1/clouds/{id}"
    std::string_view methods;  ///< as Allow names them: "GET, HEAD"; a POST brings JSON
};
std::span<const RouteInfo> routes();

std::string_view pattern(Route route);
std::string_view allowedMethods(Route route);

struct Routed {
    Route route = Route::Asset;
    std::string path;   ///< decoded
    std::string query;  ///< as sent, without the question mark
    std::string id;     ///< decoded, of a cloud or a session; it is only ever looked up
};

inline constexpr std::size_t maxTargetLength = 8192;

/// Problems: 400 for a path that is malformed, 404 for one that is not served, 414 for a target that is too
/// long. Whether an asset of that name exists is the page's to say. Paths under /api/v1 are served without
/// that prefix too.
tl::expected<Routed, Problem> route(std::string_view target);

}  // namespace scancast
