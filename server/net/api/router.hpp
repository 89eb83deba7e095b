// Which route a request is for. Pure functions; any thread.
// Pipeline: http session → **router** → api.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "protocol/error.hpp"
#include "protocol/problem.hpp"
#include "server/access/identity.hpp"

namespace scancast {

enum class Route : std::uint8_t {
    Asset,
    OpenApi,
    Health,
    Ready,
    Metrics,
    Clouds,
    Cloud,
    CloudViews,
    CloudStations,
    CloudPhotos,
    CloudPhoto,
    Methods,
    SnapshotJpeg,
    SnapshotPng,
    Snapshot,
    Pick,
    Measure,
    Points,
    Profile,
    Elevation,
    Orthophoto,
    Wms,
    Wmts,
    WmtsCapabilities,
    MapTile,
    LonLat,
    StreamMjpeg,
    Stream,
    Sessions,
    SessionView,
    GuestLinks,
    GuestSession,
};

/// Whose token a request needs, where the server was started with tokens.
enum class Need : std::uint8_t {
    Nothing,
    Guest,  ///< a guest's, or a user's
    Token,  ///< a user's
    Admin,
};

struct RouteInfo {
    Route route;
    std::string_view pattern;  ///< as it is named in metrics and in openapi.json: "/api/v1/clouds/{id}"
    std::string_view methods;  ///< as Allow names them: "GET, HEAD"; a POST brings JSON
    Need need;
    bool json;                          ///< the answer is JSON: an Accept that rules that out is refused
    std::string_view adminMethod = {};  ///< needs the administrator, whatever the others need; may be empty
};

/// All that is known of a route but its answer, which is Api::answer()'s; in the order of Route.
inline constexpr std::array routes{
    // The page and what belongs to it; it has to be there to ask for the token.
    RouteInfo{Route::Asset, "/", "GET, HEAD", Need::Nothing, false},
    RouteInfo{Route::OpenApi, "/openapi.json", "GET, HEAD", Need::Guest, true},
    RouteInfo{Route::Health, "/healthz", "GET, HEAD", Need::Nothing, false},
    RouteInfo{Route::Ready, "/readyz", "GET, HEAD", Need::Nothing, false},
    RouteInfo{Route::Metrics, "/metrics", "GET, HEAD", Need::Token, false},
    RouteInfo{Route::Clouds, "/api/v1/clouds", "GET, HEAD, POST", Need::Guest, true, "POST"},
    RouteInfo{Route::Cloud, "/api/v1/clouds/{id}", "GET, HEAD, DELETE", Need::Guest, true, "DELETE"},
    RouteInfo{Route::CloudViews, "/api/v1/clouds/{id}/views", "GET, HEAD", Need::Guest, true},
    RouteInfo{Route::CloudStations, "/api/v1/clouds/{id}/stations", "GET, HEAD", Need::Guest, true},
    RouteInfo{Route::CloudPhotos, "/api/v1/clouds/{id}/photos", "GET, HEAD", Need::Guest, true},
    RouteInfo{Route::CloudPhoto, "/api/v1/clouds/{id}/photos/{n}", "GET, HEAD", Need::Guest, false},
    RouteInfo{Route::Methods, "/api/v1/methods", "GET, HEAD", Need::Guest, true},
    RouteInfo{Route::SnapshotJpeg, "/api/v1/clouds/{id}/snapshot.jpg", "GET, HEAD", Need::Guest, false},
    RouteInfo{Route::SnapshotPng, "/api/v1/clouds/{id}/snapshot.png", "GET, HEAD", Need::Guest, false},
    // Accept chooses the format.
    RouteInfo{Route::Snapshot, "/api/v1/clouds/{id}/snapshot", "POST", Need::Guest, false},
    RouteInfo{Route::Pick, "/api/v1/clouds/{id}/pick", "POST", Need::Guest, true},
    RouteInfo{Route::Measure, "/api/v1/clouds/{id}/measure", "POST", Need::Guest, true},
    // Guests get pictures of profiles, and points where they may (points_answers.hpp).
    RouteInfo{Route::Points, "/api/v1/clouds/{id}/points", "POST", Need::Guest, false},
    RouteInfo{Route::Profile, "/api/v1/clouds/{id}/profile", "POST", Need::Guest, false},
    // Guests get orthophotos, and elevations where they may (raster_answers.hpp).
    RouteInfo{Route::Elevation, "/api/v1/clouds/{id}/dem.tif", "GET, HEAD", Need::Guest, false},
    RouteInfo{Route::Orthophoto, "/api/v1/clouds/{id}/ortho.tif", "GET, HEAD", Need::Guest, false},
    // Maps (server/net/maps/); their services answer errors in XML.
    RouteInfo{Route::Wms, "/api/v1/clouds/{id}/wms", "GET, HEAD", Need::Guest, false},
    RouteInfo{Route::Wmts, "/api/v1/clouds/{id}/wmts", "GET, HEAD", Need::Guest, false},
    RouteInfo{Route::WmtsCapabilities, "/api/v1/clouds/{id}/wmts/1.0.0/WMTSCapabilities.xml", "GET, HEAD",
              Need::Guest, false},
    RouteInfo{Route::MapTile, "/api/v1/clouds/{id}/tiles/{set}/{z}/{x}/{y}", "GET, HEAD", Need::Guest, false},
    RouteInfo{Route::LonLat, "/api/v1/clouds/{id}/lonlat", "POST", Need::Guest, true},
    RouteInfo{Route::StreamMjpeg, "/api/v1/clouds/{id}/stream.mjpg", "GET, HEAD", Need::Guest, false},
    RouteInfo{Route::Stream, "/api/v1/stream", "GET, HEAD", Need::Guest, false},
    RouteInfo{Route::Sessions, "/api/v1/sessions", "GET, HEAD", Need::Admin, true},
    RouteInfo{Route::SessionView, "/api/v1/sessions/{id}/view", "POST", Need::Token, true},
    RouteInfo{Route::GuestLinks, "/api/v1/guest-links", "POST", Need::Admin, true},
    // The link's token is in the body.
    RouteInfo{Route::GuestSession, "/api/v1/guest-session", "POST", Need::Nothing, true},
};
constexpr const RouteInfo& infoOf(Route route) {
    return routes[std::size_t(route)];
}
constexpr Need needOf(Route route, std::string_view method) {
    const RouteInfo& info = infoOf(route);
    return !method.empty() && method == info.adminMethod ? Need::Admin : info.need;
}
constexpr std::string_view pattern(Route route) {
    return infoOf(route).pattern;
}

struct Routed {
    Route route = Route::Asset;
    std::string path;   ///< decoded
    std::string query;  ///< as sent, without the question mark
    std::string id;     ///< decoded, of a cloud or a session; it is only ever looked up
    std::string
        n;  ///< decoded, what stands for {n}: the number of one of the cloud's; nobody has looked whether it is one
    struct Tile {
        std::string set, z, x, y;  ///< decoded; nobody has looked what they are
    };
    Tile tile{};    ///< of map tiles
    Grant grant{};  ///< of whoever asks; Api::admit() says it
};

inline constexpr std::size_t maxTargetLength = 8192;

/// Problems: 400 for a path that is malformed, 404 for one that is not served, 414 for a target that is too
/// long. Whether an asset of that name exists is the page's to say. Paths under /api/v1 are served without
/// that prefix too.
tl::expected<Routed, Problem> route(std::string_view target);

}  // namespace scancast
