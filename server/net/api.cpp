#include "server/net/api.hpp"

#include <cstdio>
#include <utility>

#include "protocol/json_text.hpp"
#include "protocol/pick_request.hpp"
#include "server/describe.hpp"
#include "server/net/negotiate.hpp"
#include "server/net/page.hpp"
#include "server/net/picture_request.hpp"

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
// could otherwise make this server work. Following a link to the page is fine.
Expected<void> checkFetchSite(const HttpRequest& request, const OriginRules& rules) {
    const std::string site = request.header("sec-fetch-site");
    if (site.empty() || site == "same-origin" || site == "none") return {};
    if (request.header("sec-fetch-mode") == "navigate" && request.header("sec-fetch-dest") == "document")
        return {};
    if (isAllowedOrigin(request.header("origin"), rules)) return {};
    return fail(ErrorCode::Unsupported,
                "Pages of another site may not use this server; --allowed-origin would let them.");
}

std::string serverTiming(const Picture& picture) {
    double select = 0;
    for (const StageTime& stage : picture.stats.stages) {
        if (stage.name == "select") select += stage.milliseconds;
    }
    char text[128];
    std::snprintf(text, sizeof text, "select;dur=%.2f, render;dur=%.2f, encode;dur=%.2f", select,
                  picture.renderMs - select, picture.encodeMs);
    return text;
}

HttpResponse pictureResponse(PictureFormat format, const View& view, const std::string& tag) {
    HttpResponse response;
    response.set("Content-Type", std::string(mediaType(format)))
        .set("ETag", tag)
        .set("Cache-Control", "no-cache")
        .set("Vary", "Accept");
    if (format == PictureFormat::Depth) {
        response.set("Scancast-Width", std::to_string(view.width))
            .set("Scancast-Height", std::to_string(view.height));
    }
    return response;
}

bool isPreflight(const HttpRequest& request) {
    return request.method == "OPTIONS" && request.count("access-control-request-method") > 0;
}

HttpResponse preflightResponse(Route route) {
    HttpResponse response;
    response.status = 204;
    response.set("Access-Control-Allow-Methods", std::string(allowedMethods(route)))
        .set("Access-Control-Allow-Headers", "Authorization, Content-Type, If-None-Match")
        .set("Access-Control-Max-Age", "600");
    return response;
}

}  // namespace

Api::Api(ApiOptions options, const Catalog& catalog, Scheduler& scheduler, Metrics& metrics)
    : options_(std::move(options)),
      access_(options_.tokens),
      catalog_(catalog),
      scheduler_(scheduler),
      metrics_(metrics),
      pictures_(scheduler),
      picker_(pictures_, scheduler, options_.version) {}

tl::expected<Routed, HttpResponse> Api::admit(const HttpRequest& request) const {
    const auto refuse = [](const Problem& problem) { return tl::unexpected(problemResponse(problem)); };
    const OriginRules& rules = options_.origins;
    if (auto host = checkHost(values(request, "host"), rules); !host) {
        return refuse(
            problemOf(host.error().code == ErrorCode::InvalidArgument ? 400 : 403, host.error().message));
    }
    if (auto origin = checkOrigin(values(request, "origin"), request.header("host"), rules); !origin) {
        return refuse(problemOf(403, origin.error().message));
    }
    if (auto site = checkFetchSite(request, rules); !site)
        return refuse(problemOf(403, site.error().message));
    auto routed = route(request.target);
    if (!routed) return refuse(routed.error());
    if (routed->route == Route::Asset && findAsset(routed->path) == nullptr) {
        return refuse(problemOf(
            404, "Nothing is served at this address; the page is at /, the API at /api/v1/clouds."));
    }
    // Asked by browsers before a page of an allowed origin may send its token; the question itself carries
    // none.
    if (isPreflight(request) && isAllowedOrigin(request.header("origin"), rules))
        return tl::unexpected(preflightResponse(routed->route));
    if (auto let = access_.check(request, routed->route); !let) return tl::unexpected(std::move(let.error()));
    const bool post = takesBody(routed->route);
    if (post ? request.method != "POST" : request.method != "GET" && request.method != "HEAD") {
        const std::string allowed(allowedMethods(routed->route));
        HttpResponse response =
            problemResponse(problemOf(405, "Understood here: " + allowed + ".", routed->path));
        response.set("Allow", allowed);
        return tl::unexpected(std::move(response));
    }
    if (post) {
        if (auto json = checkJsonBody(request); !json) return refuse(json.error());
    }
    return std::move(*routed);
}

void Api::complete(const HttpRequest& request, std::string_view routePattern, HttpResponse& response) const {
    response.set("X-Content-Type-Options", "nosniff").set("Server", "scancast/" + options_.version);
    const std::string origin = request.header("origin");
    if (isAllowedOrigin(origin, options_.origins)) {
        response.set("Access-Control-Allow-Origin", origin).set("Vary", "Origin");
        response.set("Access-Control-Expose-Headers",
                     "ETag, Retry-After, Server-Timing, Scancast-Width, Scancast-Height");
    }
    if (access_.isPrivate(request)) {
        for (auto& [name, value] : response.headers)
            if (name == "Cache-Control" && value == "no-cache") value = "private, no-cache";
    }
    metrics_.httpRequest(routePattern, response.status);
}

void Api::answer(const HttpRequest& request, const Routed& routed, Respond respond) const {
    switch (routed.route) {
        case Route::Asset:
            return respond(asset(request, routed));
        case Route::Health:
            return respond(textResponse(200, "ok\n"));
        case Route::Ready:
            return respond(ready());
        case Route::Metrics:
            return respond(metricsText());
        case Route::Clouds:
            return respond(jsonResponse(cloudListJson(catalog_.list())));
        case Route::Cloud:
            return respond(cloud(routed));
        case Route::Methods:
            return respond(jsonResponse(methodListJson()));
        case Route::SnapshotJpeg:
        case Route::SnapshotPng:
        case Route::Snapshot:
            return snapshot(request, routed, std::move(respond));
        case Route::Pick:
            return pick(request, routed, std::move(respond));
        case Route::Stream:
            break;
    }
    HttpResponse response = problemResponse(problemOf(426, "This address is a WebSocket.", routed.path));
    response.set("Upgrade", "websocket");
    respond(std::move(response));
}

HttpResponse Api::asset(const HttpRequest& request, const Routed& routed) const {
    const Asset* asset = findAsset(routed.path);
    const std::string tag = contentTag(asset->bytes);
    HttpResponse response;
    response.set("ETag", tag).set("Cache-Control", "no-cache");
    response.set("Content-Security-Policy", std::string(contentSecurityPolicy))
        .set("Referrer-Policy", "no-referrer");
    if (matchesAny(request.header("if-none-match"), tag)) {
        response.status = 304;
        return response;
    }
    response.set("Content-Type", std::string(contentTypeOf(asset->path)));
    response.text = std::string(asset->bytes);
    return response;
}

HttpResponse Api::ready() const {
    if (scheduler_.draining())
        return problemResponse(problemOf(503, "The server is shutting down.", "/readyz"));
    const DeviceStatus device = scheduler_.device();
    if (device.state == DeviceStatus::State::Failed) {
        return problemResponse(problemOf(503, "No rendering device: " + device.error.message, "/readyz"));
    }
    if (device.state == DeviceStatus::State::Opening) {
        return problemResponse(problemOf(503, "The rendering device is being opened.", "/readyz"));
    }
    if (!catalog_.settled())
        return problemResponse(problemOf(503, "Clouds are still being loaded.", "/readyz"));
    if (!device.lost) return textResponse(200, "ready\n");
    return textResponse(200, "ready\nThe device " + title(device.lost->info) + " was lost, and " +
                                 title(device.info) + " draws in its place: " + device.lost->error.message +
                                 "\n");
}

HttpResponse Api::cloud(const Routed& routed) const {
    const auto entry = catalog_.find(routed.cloud);
    if (entry && entry->state != CloudState::Failed) return jsonResponse(cloudJson(*entry));
    Problem problem = catalog_.cloud(routed.cloud).error();
    problem.instance = routed.path;
    return problemResponse(problem);
}

HttpResponse Api::metricsText() const {
    metrics_.setPointsResident(catalog_.pointsResident());
    if (options_.cache) metrics_.setResidency(options_.cache->stats());
    HttpResponse response = textResponse(200, metrics_.text());
    response.headers.front().second = "text/plain; version=0.0.4; charset=utf-8";
    return response;
}

Expected<View> Api::snapshotView(const Cloud& cloud, const HttpRequest& request, const Routed& routed,
                                 PictureFormat format) const {
    Expected<View> view = tl::unexpected(Error());
    if (takesBody(routed.route)) {
        const auto changes = parseJson(request.body);
        if (!changes) return tl::unexpected(changes.error());
        view = viewOfJson(cloud, *changes, options_.maxPixels);
    } else {
        view = viewOfQuery(cloud, routed.query, options_.maxPixels);
    }
    if (view && format == PictureFormat::Depth) return depthView(std::move(*view));
    return view;
}

void Api::snapshot(const HttpRequest& request, const Routed& routed, Respond respond) const {
    const auto refuse = [&](Problem problem) {
        problem.instance = routed.path;
        respond(problemResponse(problem));
    };
    auto cloud = catalog_.cloud(routed.cloud);
    if (!cloud) return refuse(std::move(cloud.error()));
    const auto format = requestedFormat(request, routed.route);
    if (!format) return refuse(format.error());
    auto view = snapshotView(**cloud, request, routed, *format);
    if (!view) return refuse(problemOf(view.error()));
    const DeviceStatus device = scheduler_.device();
    if (device.state != DeviceStatus::State::Ready) {
        return refuse(problemOf(503, "The rendering device is not available."));
    }
    const auto headBy = [cloud = *cloud, view = *view, format = *format,
                         version = options_.version](const DeviceInfo& drawnBy) {
        return pictureResponse(format, view, pictureTag(*cloud, view, format, drawnBy, version));
    };
    HttpResponse head = headBy(device.info);
    const std::string tag = *head.find("ETag");
    if (matchesAny(request.header("if-none-match"), tag)) {
        head.status = 304;
        return respond(std::move(head));
    }
    if (request.method == "HEAD") {  // the tag is known without the picture, its length is not
        head.bodyUnknown = true;
        return respond(std::move(head));
    }
    PictureOrder order{std::move(*cloud), std::move(*view), *format, false};
    auto done = [respond, headBy, path = routed.path](const Expected<Picture>& picture) {
        if (!picture) return respond(problemResponse(problemOf(picture.error(), path)));
        // Not by the device that was there when it was asked for: that one may have been lost since.
        HttpResponse response = headBy(picture->device);
        response.set("Server-Timing", serverTiming(*picture));
        response.bytes = picture->bytes;
        respond(std::move(response));
    };
    if (auto queued = pictures_.order(tag, std::move(order), std::move(done)); !queued) {
        refuse(problemOf(503, queued.error().message));
    }
}

void Api::pick(const HttpRequest& request, const Routed& routed, Respond respond) const {
    const auto refuse = [&](Problem problem) {
        problem.instance = routed.path;
        respond(problemResponse(problem));
    };
    auto cloud = catalog_.cloud(routed.cloud);
    if (!cloud) return refuse(std::move(cloud.error()));
    if (!accepts(request.header("accept"), "application/json"))
        return refuse(problemOf(406, "This address answers with JSON, which the Accept header rules out."));
    const auto asked = parsePickRequest(request.body);
    if (!asked) return refuse(problemOf(asked.error()));
    const auto view = viewOfJson(**cloud, asked->view, options_.maxPixels);
    if (!view) {
        Error error = view.error();
        if (!error.field.empty()) error.field = "view." + error.field;
        return refuse(problemOf(error));
    }
    auto done = [respond, cloud = *cloud, path = routed.path](Expected<std::optional<Picked>> picked) {
        if (!picked) return respond(problemResponse(problemOf(picked.error(), path)));
        respond(jsonResponse(*picked ? pickedJson(*cloud, **picked) : nlohmann::json()));
    };
    if (auto queued = picker_.pick(*cloud, *view, asked->x, asked->y, std::move(done)); !queued)
        refuse(problemOf(queued.error()));
}

}  // namespace scancast
