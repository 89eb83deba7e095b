#include "server/net/api/api.hpp"

#include <fmt/format.h>

#include <spdlog/spdlog.h>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "protocol/guests/guest.hpp"
#include "protocol/json_text.hpp"
#include "protocol/pick_request.hpp"
#include "server/catalog/describe.hpp"
#include "server/catalog/describe_point.hpp"
#include "server/net/api/mjpeg_request.hpp"
#include "server/net/api/negotiate.hpp"
#include "server/net/api/picture_headers.hpp"
#include "server/net/api/picture_request.hpp"
#include "server/net/page/file_answer.hpp"
#include "server/scheduler/picture_bytes.hpp"

namespace scancast {
namespace {

/// A picture of a live cloud is old when the next frame comes: keeping it helps nobody.
HttpResponse pictureResponse(PictureFormat format, const PlannedView& planned, const std::string& tag,
                             bool live) {
    HttpResponse response;
    response.set("Content-Type", std::string(mediaType(format)))
        .set("ETag", tag)
        .set("Cache-Control", live ? "no-store" : "no-cache")
        .set("Vary", "Accept");
    if (format == PictureFormat::Depth) {
        response.set("Scancast-Width", std::to_string(planned.view.width))
            .set("Scancast-Height", std::to_string(planned.view.height));
    }
    response.set("Scancast-Method", planned.method);
    if (!planned.reason.empty()) response.set("Scancast-Method-Reason", planned.reason);
    return response;
}

/// Nobody keeps what holds a token.
HttpResponse asSecret(HttpResponse response) {
    std::erase_if(response.headers, [](const auto& header) { return header.first == "Cache-Control"; });
    response.set("Cache-Control", "no-store");
    return response;
}

/// For clients whose clock goes wrong.
std::int64_t secondsUntil(Grant::Time time) {
    const auto left = time - std::chrono::system_clock::now();
    return std::max<std::int64_t>(0, std::chrono::floor<std::chrono::seconds>(left).count());
}

HttpResponse refusal(Problem problem, const Routed& routed) {
    problem.instance = routed.path;
    return problemResponse(problem);
}

/// Of a view that cannot be shown: what is being loaded, or out of reach, may be asked for again.
HttpResponse refusedView(Error error, const Routed& routed, std::string_view within = {}) {
    const bool later = error.code == ErrorCode::Unavailable;
    if (!error.field.empty()) error.field.insert(0, within);
    HttpResponse response = refusal(problemOf(error), routed);
    if (later) response.set("Retry-After", "1");
    return response;
}

RasterOptions rasterOptions(const ApiOptions& options) {
    RasterOptions rasters = options.rasters;
    rasters.guestsMayExport = options.points.guestsMayExport;
    rasters.mostPixels = std::min(rasters.mostPixels, options.maxPixels);
    return rasters;
}

/// The body of a POST that drives a session: a `view` message, whose `type` and `seq` may be left out.
Expected<messages::ViewChange> parseViewChange(const std::string& body, std::uint64_t seq) {
    auto object = parseJson(body);
    if (!object) return passOn(object);
    if (object->is_object()) {
        object->emplace("type", "view");
        object->emplace("seq", seq);
    }
    auto message = parseClientMessage(printJson(*object));
    if (!message) return passOn(message);
    if (auto* change = std::get_if<messages::ViewChange>(&*message)) return std::move(*change);
    return fail(ErrorCode::InvalidArgument, "type: must be \"view\" here", "type");
}

}  // namespace

Api::Api(ApiOptions options, const Catalog& catalog, CloudAdmin& admin, const SessionRegister& sessions,
         Scheduler& scheduler, Metrics& metrics)
    : options_(std::move(options)),
      probeRules_{options_.probesHost, {}, options_.origins.allowedHosts},
      frameAncestors_(frameAncestors(options_.origins)),
      access_(options_.tokens),
      failedLogins_([](const std::string& line) { spdlog::warn("{}", line); }),
      catalog_(catalog),
      admin_(admin),
      sessions_(sessions),
      scheduler_(scheduler),
      metrics_(metrics),
      admission_(options_.rates, options_.costs, options_.memory),
      pictures_(scheduler),
      picker_(pictures_, scheduler, options_.version),
      photos_(admission_, options_.memory),
      points_(options_.memory, options_.points),
      measurer_(admission_, options_.memory, options_.maxPixels),
      rasters_(admission_, options_.memory, scheduler, rasterOptions(options_), options_.version),
      maps_({options_.maxPixels, options_.version}, admission_, pictures_, picker_, scheduler_, metrics_,
            options_.memory) {}

/// What routes answer, where that is more than a line. Lives as long as Api::answer(): what is answered later keeps
/// copies.
struct Api::Answers {
    const Api& api;
    const HttpRequest& request;
    const Routed& routed;
    const std::stop_token& gone;
    const VisibleClouds clouds_ = visibleTo(routed.grant.identity, api.catalog_);

    HttpResponse asset() const {
        HttpResponse response = fileAnswer(request, *findAsset(routed.path));
        // Frames are the page's; its parts are loaded by who asks with an Origin (modules do), to whom this means nothing.
        const bool mayBeFramed = routed.path == "/" && !api.options_.origins.allowedOrigins.empty();
        response.set("Content-Security-Policy", pagePolicy(api.frameAncestors_))
            .set("Cross-Origin-Resource-Policy", mayBeFramed ? "cross-origin" : "same-origin")
            .set("Referrer-Policy", "no-referrer");
        return response;
    }

    HttpResponse apiDescription() const {
        return fileAnswer(request, {&scancast::apiDescription().files.front(), false});
    }

    // What a GET would begin; its words are looked at, but no session is opened.
    HttpResponse mjpegHead() const {
        const auto asked = mjpegRequest(request, routed, clouds_, api.options_.maxPixels);
        if (!asked) return refusal(asked.error(), routed);
        HttpResponse response;
        response.set("Content-Type", std::string(mjpegMediaType)).set("Cache-Control", "no-store");
        sayMethod(response, *asked);
        response.bodyUnknown = true;
        return response;
    }

    HttpResponse clouds() const {
        if (request.method == "POST") return addCloud();
        return jsonResponse(cloudListJson(clouds_.list()));
    }

    HttpResponse addCloud() const {
        const auto asked = parseAddCloud(request.body);
        if (!asked) return refusal(problemOf(asked.error()), routed);
        const auto id = api.admin_.add(*asked);
        if (!id) return refusal(id.error(), routed);
        const auto entry = clouds_.find(*id);
        HttpResponse response = jsonResponse(entry ? cloudJson(*entry) : nlohmann::json{{"id", *id}});
        response.status = 202;
        response.set("Location", "/api/v1/clouds/" + *id);
        return response;
    }

    /// What tells views of a cloud. The query's words are those of a snapshot; its camera has no part in it.
    template <class Tell>
    HttpResponse viewsBy(Tell tell) const {
        const auto cloud = clouds_.cloud(routed.id);
        if (!cloud) return refusal(cloud.error(), routed);
        const auto asked = viewOfQuery(clouds_, routed.id, routed.query, api.options_.maxPixels);
        if (!asked) return refusedView(asked.error(), routed);
        return jsonResponse(tell(*asked->cloud, asked->planned->view));
    }

    HttpResponse photos() const {
        return viewsBy(
            [this](const Cloud& cloud, const View& base) { return photosJson(routed.id, cloud, base); });
    }

    void photo(Respond respond) const {
        auto cloud = clouds_.cloud(routed.id);
        if (!cloud) return respond(refusal(std::move(cloud.error()), routed));
        if ((*cloud)->photos.empty())  // a coarse one to look at has none yet
            if (const auto entry = clouds_.find(routed.id); entry && entry->state == CloudState::Loading)
                return respond(refusal(
                    problemOf(
                        503,
                        "This cloud is still being read, and its photos with it; ask again in a moment."),
                    routed));
        api.photos_.answer(request, routed, *cloud, std::move(respond), gone);
    }

    // Who looks at it is told at once; its memory is given back when the last picture of it is done.
    HttpResponse removeCloud() const {
        if (auto removed = api.admin_.remove(routed.id); !removed) return refusal(removed.error(), routed);
        api.sessions_.wakeAll();
        HttpResponse response;
        response.status = 204;
        return response;
    }

    HttpResponse guestLink() const {
        const auto asked = parseGuestLinkRequest(request.body);
        if (!asked) return refusal(problemOf(asked.error()), routed);
        if (!clouds_.find(asked->cloud)) return refusal(noSuchCloud(asked->cloud), routed);
        const auto link = api.access_.guestLink(asked->cloud, std::chrono::seconds(asked->seconds));
        if (!link) {
            const bool hasNoKey = link.error().code == ErrorCode::Unsupported;
            return refusal(problemOf(hasNoKey ? 409 : 503, link.error().message), routed);
        }
        HttpResponse response = jsonResponse({{"token", link->token},
                                              {"cloud", asked->cloud},
                                              {"expires", utcText(link->until)},
                                              {"path", guestPath(link->token)}});
        return asSecret(std::move(response));
    }

    HttpResponse guestSession() const {
        const auto token = parseGuestSessionRequest(request.body);
        if (!token) return refusal(problemOf(token.error()), routed);
        auto pass = api.access_.guestPass(*token);
        if (!pass) {
            LoginRefusal& refused = pass.error();
            return api.loginFailed(request, *refused.failure, std::move(refused.response));
        }
        HttpResponse response = jsonResponse({{"token", pass->token},
                                              {"cloud", pass->cloud},
                                              {"expires", utcText(pass->expires)},
                                              {"linkExpires", utcText(pass->until)},
                                              {"expiresInSeconds", secondsUntil(pass->expires)},
                                              {"mayExport", api.options_.points.guestsMayExport}});
        return asSecret(std::move(response));
    }

    HttpResponse ready() const {
        if (api.leaving()) return problemResponse(problemOf(503, "The server is shutting down.", "/readyz"));
        const DeviceStatus device = api.scheduler_.device();
        if (device.state == DeviceStatus::State::Failed) {
            return problemResponse(problemOf(503, "No rendering device: " + device.error.message, "/readyz"));
        }
        if (device.state == DeviceStatus::State::Opening) {
            return problemResponse(problemOf(503, "The rendering device is being opened.", "/readyz"));
        }
        if (!api.catalog_.settled())
            return problemResponse(
                problemOf(503, "The first clouds are still being loaded, or there is none.", "/readyz"));
        if (!device.lost) return textResponse(200, "ready\n");
        return textResponse(200, "ready\nThe device " + title(device.lost->info) + " was lost, and " +
                                     title(device.info) +
                                     " draws in its place: " + device.lost->error.message + "\n");
    }

    HttpResponse cloud() const {
        if (request.method == "DELETE") return removeCloud();
        const auto entry = clouds_.find(routed.id);
        if (entry && entry->state != CloudState::Failed) return jsonResponse(cloudJson(*entry));
        return refusal(clouds_.cloud(routed.id).error(), routed);
    }

    void sessionView(Respond respond) const {
        const auto session = api.sessions_.find(routed.id);
        if (!session)
            return respond(
                refusal(problemOf(404, "There is no session of that id; it may have ended."), routed));
        auto change = parseViewChange(request.body, api.sessions_.seqOf(routed.id));
        if (!change) return respond(refusal(problemOf(change.error()), routed));
        session->changeView(
            std::move(*change), [respond, routed = routed](const tl::expected<SharedView, Problem>& shown) {
                respond(shown ? jsonResponse(toJson(*shown)) : refusal(shown.error(), routed));
            });
    }

    HttpResponse metricsText() const {
        api.metrics_.setPointsResident(api.catalog_.pointsResident());
        api.metrics_.setPicturesAwaited(api.pictures_.waiting());
        if (api.options_.cache) api.metrics_.setResidency(api.options_.cache->stats());
        if (api.options_.kept) {
            const KeptCloudsStats kept = api.options_.kept->stats();
            api.metrics_.setKeptClouds(kept.bytes, kept.limit, kept.evicted);
        }
        if (api.options_.remote) api.metrics_.setRemote(api.options_.remote->stats());
        if (api.options_.ranks) api.metrics_.setRanks(api.options_.ranks());
        api.metrics_.setMemory(api.options_.memory);
        api.metrics_.setQueues(api.scheduler_.queues());
        api.metrics_.setRenderSaturation(api.scheduler_.saturation());
        HttpResponse response = textResponse(200, api.metrics_.text());
        response.headers.front().second = "text/plain; version=0.0.4; charset=utf-8";
        return response;
    }

    Expected<AskedView> snapshotView() const {
        if (request.method != "POST")
            return viewOfQuery(clouds_, routed.id, routed.query, api.options_.maxPixels);
        const auto changes = parseJson(request.body);
        if (!changes) return passOn(changes);
        return viewOfJson(clouds_, routed.id, *changes, api.options_.maxPixels);
    }

    void snapshot(Respond respond) const {
        const auto refuse = [&](Problem problem) { respond(refusal(std::move(problem), routed)); };
        if (auto own = clouds_.cloud(routed.id); !own) return refuse(std::move(own.error()));
        const auto format = requestedFormat(request, routed.route);
        if (!format) return refuse(format.error());
        const auto asked = snapshotView();
        if (!asked) return respond(refusedView(asked.error(), routed));
        const auto& [cloud, planned] = *asked;
        View view = planned->view;
        if (*format == PictureFormat::Depth) view = depthView(std::move(view));
        const DeviceStatus device = api.scheduler_.device();
        if (device.state != DeviceStatus::State::Ready) {
            return refuse(problemOf(503, "The rendering device is not available."));
        }
        const auto headBy = [cloud = asked->cloud, view, planned = asked->planned, format = *format,
                             live = clouds_.isLive(routed.id, view.with),
                             version = api.options_.version](const DeviceInfo& drawnBy) {
            return pictureResponse(format, *planned, pictureTag(*cloud, view, format, drawnBy, version),
                                   live);
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
        const auto price = api.admission_.price(*cloud, *planned, *format);
        if (!price) return refuseCostly(respond, price.error());
        PictureOrder order{cloud, view, *format, false};
        order.planned = planned;
        order.price = *price;
        order.client = request.client;
        PictureDone done = [respond, headBy, path = routed.path, price = *price, drawn = order.cloud,
                            most = mostSamples(*order.cloud)](const Expected<EncodedPicture>& picture) {
            if (!picture) return respond(problemResponse(problemOf(picture.error(), path)));
            // Not by the device that was there when it was asked for: that one may have been lost since.
            HttpResponse response = headBy(picture->device);
            // Ranks that came or went meanwhile: it may be of either limit.
            if (mostSamples(*drawn) != most) forbidKeeping(response);
            if (picture->stats.nodesDamaged > 0) sayDamaged(response, picture->stats.nodesDamaged);
            response.set("Server-Timing", serverTiming(*picture));
            response.set("Scancast-Price", fmt::format("{:.0f}", price));
            response.price = price / 1000;
            response.bytes = picture->bytes;
            respond(std::move(response));
        };
        if (api.pictures_.join(tag, done, gone)) return;
        auto ticket = api.admission_.take(request.client, *price);
        if (!ticket) return refuseCostly(respond, ticket.error());
        auto kept = api.admission_.keep(request.client, bytesToKeep(order.view, order.format));
        if (!kept) return refuseCostly(respond, kept.error());
        order.kept = std::move(*kept);
        api.metrics_.pictureAdmitted(*price / 1000);
        if (auto queued = api.pictures_.order(tag, std::move(order),
                                              holding(std::move(*ticket), std::move(done)), gone);
            !queued)
            refuse(problemOf(503, queued.error().message));
    }

    /// The same, with the ticket until it is called or forgotten: who has been answered waits for nothing any more.
    static PictureDone holding(WorkBudget::Ticket ticket, PictureDone done) {
        return [held = std::make_shared<WorkBudget::Ticket>(std::move(ticket)),
                done = std::move(done)](Expected<EncodedPicture> picture) {
            held->reset();
            done(std::move(picture));
        };
    }

    void refuseCostly(const Respond& respond, Problem problem) const {
        api.metrics_.pictureRefused(problem.status == 413   ? CostRefusal::Picture
                                    : problem.status == 429 ? CostRefusal::Client
                                                            : CostRefusal::Total);
        const bool later = problem.status != 413;
        HttpResponse response = refusal(std::move(problem), routed);
        if (later) response.set("Retry-After", "1");
        respond(std::move(response));
    }

    void measure(Respond respond) const {
        const auto cloud = clouds_.cloud(routed.id);
        if (!cloud) return respond(refusal(cloud.error(), routed));
        api.measurer_.answer(request, routed, *cloud, std::move(respond), gone);
    }

    void pick(Respond respond) const {
        const auto refuse = [&](Problem problem) { respond(refusal(std::move(problem), routed)); };
        if (auto own = clouds_.cloud(routed.id); !own) return refuse(std::move(own.error()));
        const auto asked = parsePickRequest(request.body);
        if (!asked) return refuse(problemOf(asked.error()));
        const auto viewed = viewOfJson(clouds_, routed.id, asked->view, api.options_.maxPixels);
        if (!viewed) return respond(refusedView(viewed.error(), routed, "view."));
        const auto price = api.admission_.price(*viewed->cloud, *viewed->planned, PictureFormat::Depth);
        if (!price) return refuseCostly(respond, price.error());
        auto ticket = api.admission_.take(request.client, *price);
        if (!ticket) return refuseCostly(respond, ticket.error());
        auto done = [respond, cloud = viewed->cloud, path = routed.path, seconds = *price / 1000,
                     held = std::make_shared<WorkBudget::Ticket>(std::move(*ticket))](
                        Expected<std::optional<Picked>> picked) {
            held->reset();
            if (!picked) return respond(problemResponse(problemOf(picked.error(), path)));
            HttpResponse response = jsonResponse(*picked ? pickedJson(*cloud, **picked) : nlohmann::json());
            response.price = seconds;
            respond(std::move(response));
        };
        if (auto queued = api.picker_.pick(viewed->cloud, viewed->planned, asked->x, asked->y, std::move(done),
                                           {request.client, *price, gone});
            !queued)
            refuse(problemOf(queued.error()));
    }
};

void Api::answer(const HttpRequest& request, const Routed& routed, Respond respond,
                 const std::stop_token& gone) const {
    if (infoOf(routed.route).json && !accepts(request.header("accept"), "application/json")) {
        return respond(refusal(
            problemOf(406, "This address answers in JSON, which the Accept header rules out."), routed));
    }
    const Answers answers{*this, request, routed, gone};
    switch (routed.route) {
        case Route::Asset:
            return respond(answers.asset());
        case Route::OpenApi:
            return respond(answers.apiDescription());
        case Route::Sessions:
            return respond(jsonResponse(sessionListJson(sessions_.list())));
        case Route::SessionView:
            return answers.sessionView(std::move(respond));
        case Route::StreamMjpeg:
            return respond(answers.mjpegHead());
        case Route::Health:
            return respond(textResponse(200, "ok\n"));
        case Route::Ready:
            return respond(answers.ready());
        case Route::Metrics:
            return respond(answers.metricsText());
        case Route::Clouds:
            return respond(answers.clouds());
        case Route::Cloud:
            return respond(answers.cloud());
        case Route::CloudViews:
            return respond(answers.viewsBy(viewsJson));
        case Route::CloudStations:
            return respond(answers.viewsBy(stationsJson));
        case Route::CloudPhotos:
            return respond(answers.photos());
        case Route::CloudPhoto:
            return answers.photo(std::move(respond));
        case Route::Methods:
            return respond(jsonResponse(methodListJson()));
        case Route::SnapshotJpeg:
        case Route::SnapshotPng:
        case Route::Snapshot:
            return answers.snapshot(std::move(respond));
        case Route::Pick:
            return answers.pick(std::move(respond));
        case Route::Measure:
            return answers.measure(std::move(respond));
        case Route::Points:
            return points_.points(request, routed, answers.clouds_, std::move(respond), gone);
        case Route::Profile:
            return points_.profile(request, routed, answers.clouds_, std::move(respond), gone);
        case Route::Elevation:
        case Route::Orthophoto:
            return rasters_.answer(request, routed, answers.clouds_, std::move(respond), gone);
        case Route::Wms:
        case Route::Wmts:
        case Route::WmtsCapabilities:
        case Route::MapTile:
        case Route::LonLat:
            return maps_.answer(request, routed, answers.clouds_, std::move(respond), gone);
        case Route::GuestLinks:
            return respond(answers.guestLink());
        case Route::GuestSession:
            return respond(answers.guestSession());
        case Route::Stream:
            break;
    }
    HttpResponse response = problemResponse(problemOf(426, "This address is a WebSocket.", routed.path));
    response.set("Upgrade", "websocket");
    respond(std::move(response));
}

}  // namespace scancast
