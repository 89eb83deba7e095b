// What the API refuses before anything is done, and what all answers carry.
#include "server/net/api/api.hpp"
#include "server/net/api/picture_request.hpp"
#include "server/net/page/error_page.hpp"
#include "server/net/page/page.hpp"

namespace scancast {
namespace {

std::vector<std::string> values(const HttpRequest& request, std::string_view name) {
    std::vector<std::string> list;
    for (const auto& [key, value] : request.headers) {
        if (key == name) list.push_back(value);
    }
    return list;
}

// Browsers say where a request comes from even where they send no Origin: <img> and <script> of another site
// could otherwise make this server work. Following a link to the page is fine, and so is having a file of the page: it holds
// no data, and who may use it is said beside it (frame-ancestors, Cross-Origin-Resource-Policy). What the page does then,
// in a frame of whomever, it does as our own page.
Expected<void> checkFetchSite(const HttpRequest& request, bool toFileOfPage, const OriginRules& rules) {
    const std::string site = request.header("sec-fetch-site");
    if (site.empty() || site == "same-origin" || site == "none") return {};
    if (request.header("sec-fetch-mode") == "navigate" && request.header("sec-fetch-dest") == "document")
        return {};
    if (toFileOfPage && (request.method == "GET" || request.method == "HEAD")) return {};
    if (isAllowedOrigin(request.header("origin"), rules)) return {};
    return fail(
        ErrorCode::Unsupported,
        "Pages of another website may not use this server, unless it is started with --allowed-origin.");
}

bool isProbe(Route route) {
    return route == Route::Health || route == Route::Ready || route == Route::Metrics;
}

bool isPreflight(const HttpRequest& request) {
    return request.method == "OPTIONS" && request.count("access-control-request-method") > 0;
}

HttpResponse preflightResponse(Route route) {
    HttpResponse response;
    response.status = 204;
    response.set("Access-Control-Allow-Methods", std::string(infoOf(route).methods))
        .set("Access-Control-Allow-Headers",
             "Authorization, Content-Type, If-None-Match, X-Request-Id, traceparent")
        .set("Access-Control-Max-Age", "600");
    return response;
}

}  // namespace

tl::expected<Routed, HttpResponse> Api::admit(const HttpRequest& request, Entrance entrance) const {
    const auto refuse = [](const Problem& problem) { return tl::unexpected(problemResponse(problem)); };
    const bool isPublic = entrance == Entrance::Public;
    const OriginRules& rules = isPublic ? options_.origins : probeRules_;
    if (auto host = checkHost(values(request, "host"), rules); !host) {
        return refuse(
            problemOf(host.error().code == ErrorCode::InvalidArgument ? 400 : 403, host.error().message));
    }
    if (auto origin = checkOrigin(values(request, "origin"), request.header("host"), rules); !origin) {
        return refuse(problemOf(403, origin.error().message));
    }
    auto routed = route(request.target);
    const bool toAsset = isPublic && routed && routed->route == Route::Asset;
    if (auto site = checkFetchSite(request, toAsset, rules); !site)
        return refuse(problemOf(403, site.error().message));
    if (!routed) return refuse(routed.error());
    if (!isPublic && !isProbe(routed->route)) {
        return refuse(
            problemOf(404,
                      "At this address (--admin-listen) are /healthz, /readyz and /metrics alone; the "
                      "page and the clouds are where --host and --port say.",
                      routed->path));
    }
    if (routed->route == Route::Asset && !findAsset(routed->path)) {
        return refuse(problemOf(
            404, "Nothing is served at this address; the page is at /, the API at /api/v1/clouds."));
    }
    // Asked by browsers before a page of an allowed origin may send its token; the question itself carries
    // none.
    if (isPublic && isPreflight(request) && isAllowedOrigin(request.header("origin"), rules))
        return tl::unexpected(preflightResponse(routed->route));
    auto grant = access_.check(request, routed->route);
    if (!grant) {
        LoginRefusal& refused = grant.error();
        if (!refused.failure) return tl::unexpected(std::move(refused.response));
        return tl::unexpected(loginFailed(request, *refused.failure, std::move(refused.response)));
    }
    routed->grant = std::move(*grant);
    const std::string allowed(infoOf(routed->route).methods);
    if ((", " + allowed + ",").find(" " + request.method + ",") == std::string::npos) {
        HttpResponse response = problemResponse(
            problemOf(405, "Methods that this address understands: " + allowed + ".", routed->path));
        response.set("Allow", allowed);
        return tl::unexpected(std::move(response));
    }
    if (request.method == "POST") {
        if (auto json = checkJsonBody(request); !json) return refuse(json.error());
    }
    return std::move(*routed);
}

HttpResponse Api::loginFailed(const HttpRequest& request, LoginFailure why, HttpResponse answer) const {
    metrics_.loginFailed(why);
    const auto wait = failedLogins_.failed(request.client, why, std::chrono::steady_clock::now());
    if (!wait) return answer;
    HttpResponse response =
        problemResponse(problemOf(429,
                                  "Too many wrong tokens have come from this address. Wait before you try "
                                  "again; a correct one is accepted at any time."));
    response.set("Retry-After", std::to_string(wait->count()));
    return response;
}

void Api::complete(const HttpRequest& request, std::string_view routePattern, HttpResponse& response,
                   Entrance entrance) const {
    response.identify(request.ids)
        .set("X-Content-Type-Options", "nosniff")
        .set("Server", "scancast/" + options_.version);
    if (entrance == Entrance::Public && !options_.strictTransport.empty())
        response.set("Strict-Transport-Security", options_.strictTransport);
    const std::string origin = request.header("origin");
    // A cache that has an answer from before the origin asked for it must not give it that one.
    if (!options_.origins.allowedOrigins.empty()) response.set("Vary", "Origin");
    if (isAllowedOrigin(origin, options_.origins)) {
        response.set("Access-Control-Allow-Origin", origin);
        response.set(
            "Access-Control-Expose-Headers",
            "ETag, Location, Retry-After, Server-Timing, Scancast-Session, Scancast-Width, "
            "Scancast-Height, Scancast-Method, Scancast-Method-Reason, Scancast-Price, "
            "Scancast-Damaged, Scancast-Points, Scancast-Losses, Scancast-Profile, Scancast-Raster, Content-Disposition, "
            "X-Request-Id");
    }
    if (access_.isPrivate(request)) {
        for (auto& [name, value] : response.headers)
            if (name == "Cache-Control" && value == "no-cache") value = "private, no-cache";
    }
    if (entrance == Entrance::Public) presentProblem(request, response, frameAncestors_);
    metrics_.httpRequest(routePattern, response.status);
}

}  // namespace scancast
