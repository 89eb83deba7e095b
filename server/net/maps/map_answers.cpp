#include "server/net/maps/map_answers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "protocol/view/view_words.hpp"
#include "renderer/cloud/import/crs_meaning.hpp"
#include "renderer/plan.hpp"
#include "server/base/faults.hpp"
#include "server/net/api/negotiate.hpp"
#include "server/net/api/picture_headers.hpp"
#include "server/net/api/picture_request.hpp"
#include "server/net/maps/map_asked.hpp"
#include "server/net/maps/map_place.hpp"
#include "server/net/maps/tile_sets.hpp"
#include "server/scheduler/picture_bytes.hpp"

namespace scancast {
namespace {

constexpr std::size_t mostWaitingMaps = 256;
/// As many as a GIS program, or a page with several browsers behind one address, asks for at a time.
constexpr std::size_t mostOfClient = 96;
/// ms of a reference core: to find out what a map needs, and to make it of its picture, or of nothing, for each pixel.
constexpr double forMap = 1, forMapPixel = 20e-6;

/// What a projected map depends on, and a cloud's revision does not.
std::string placeOnEarth(const CloudFacts& cloud) {
    return fmt::format("\n{}\n{}", cloud.crsWkt, cloud.crsEpsg.value_or(0));
}
/// Of a net and what it is held against, of the most that there may be.
constexpr std::uint64_t bytesOfNet = std::uint64_t(8) << 20;

bool saysWord(const WordValues& words, std::string_view name) {
    return std::ranges::any_of(words, [name](const auto& word) { return word.first == name; });
}

std::optional<Rgb8> backgroundOf(const View& view) {
    if (view.style.background.kind == Background::Kind::Transparent) return std::nullopt;
    return view.style.background.top;
}

/// Everything that decides its pixels beside the view.
std::string printedMap(const MapRequest& map) {
    return fmt::format("map {} {} {} {} {} {} {}x{}", map.crs, map.axesOfCrs, map.box[0], map.box[1],
                       map.box[2], map.box[3], map.width, map.height);
}

const WordValues& wordsOfMap(const MapRequest& map) {
    return map.words;
}
const WordValues& wordsOfMap(const FeatureRequest& request) {
    return request.map.words;
}
const WordValues& wordsOfMap(const LegendRequest& request) {
    return request.words;
}
const WordValues& wordsOfMap(const CapabilitiesRequest& request) {
    return request.words;
}

MapService serviceOf(Route route) {
    switch (route) {
        case Route::Wms:
            return MapService::Wms;
        case Route::Wmts:
        case Route::WmtsCapabilities:
            return MapService::Wmts;
        default:
            return MapService::Plain;
    }
}

}  // namespace

Expected<View> asMap(const Cloud& cloud, View view, const MapRequest& map) {
    view.width = map.width;
    view.height = map.height;
    view.camera = cameraAbove(cloud, (glm::dvec2(cloud.bounds[0]) + glm::dvec2(cloud.bounds[1])) * 0.5, 1);
    Background& background = view.style.background;
    if (!saysWord(map.words, "background")) {
        background = {map.transparent ? Background::Kind::Transparent : Background::Kind::Color,
                      map.background, map.background};
    }
    if (background.kind == Background::Kind::Gradient)
        return fail(ErrorCode::InvalidArgument, "background: a map has one colour, or is transparent",
                    "background");
    if (background.kind == Background::Kind::Transparent && map.format != PictureFormat::Png)
        background = {Background::Kind::Color, map.background, map.background};
    return view;
}

/// A map's picture, before anybody knows what has to be drawn for it.
struct MapAnswers::Ordered {
    MapRequest map;
    View view;
    int margin = 0;  ///< px that its screen passes look at
    DeviceInfo device;
    std::string tag;

    HttpResponse head(const Asked& asked) const {
        HttpResponse response;
        response.set("Content-Type", std::string(mediaType(map.format)))
            .set("ETag", tag)
            .set("Cache-Control", asked.live ? "no-store" : "no-cache");
        return response;
    }
};

MapAnswers::MapAnswers(MapOptions options, const Admission& admission, const SharedPictures& pictures,
                       const Picker& picker, const Scheduler& scheduler, Metrics& metrics,
                       TransientMemory memory)
    : options_(std::move(options)),
      admission_(admission),
      pictures_(pictures),
      picker_(picker),
      scheduler_(scheduler),
      metrics_(metrics),
      memory_(std::move(memory)),
      projections_(projectionsVersion()),
      places_({.all = mostWaitingMaps, .client = mostOfClient, .what = "maps"}),
      references_(std::make_unique<References>()),
      worker_(mostWaitingMaps) {}

MapAnswers::~MapAnswers() = default;

void MapAnswers::answer(const HttpRequest& request, const Routed& routed, const VisibleClouds& clouds,
                        Respond respond, const std::stop_token& gone) const {
    const auto asked = std::make_shared<Asked>(clouds);
    asked->service = wantsProblems(routed.query) ? MapService::Plain : serviceOf(routed.route);
    asked->request = request;
    asked->id = routed.id;
    asked->path = routed.path;
    asked->respond = std::move(respond);
    asked->gone = gone;
    auto cloud = clouds.cloud(routed.id);
    if (!cloud) return asked->refuse(std::move(cloud.error()));
    asked->own = asked->cloud = std::move(*cloud);
    auto place = places_.take(request.client);
    if (!place) return asked->refuse(std::move(place.error()));
    asked->place = std::move(*place);
    switch (routed.route) {
        case Route::Wms:
            return wms(asked, routed.query);
        case Route::Wmts:
            return wmts(asked, routed.query);
        case Route::WmtsCapabilities: {
            const auto words = parseMapWords(routed.query);
            if (!words) return asked->refuse(words.error());
            if (const auto view = look(asked, *words)) capabilities(asked, {*words}, *view, true);
            return;
        }
        case Route::MapTile: {
            const auto& [set, z, x, y] = routed.tile;
            const auto parsed = parseTileRequest(set, z, x, y, routed.query);
            if (!parsed) return asked->refuse(parsed.error());
            return tile(asked, *parsed);
        }
        default:
            return lonLat(asked, request.body);
    }
}

std::optional<View> MapAnswers::look(const Shared& asked, const WordValues& words) const {
    auto viewed = viewOfWords(asked->clouds, asked->id, words, options_.maxPixels);
    if (!viewed) {
        asked->refuse(viewed.error());
        return std::nullopt;
    }
    asked->cloud = std::move(viewed->cloud);
    asked->live = asked->clouds.isLive(asked->id, viewed->planned->view.with);
    return viewed->planned->view;
}

void MapAnswers::wms(const Shared& asked, std::string_view query) const {
    const auto parsed = parseWmsRequest(query, asked->id);
    if (!parsed) return asked->refuse(parsed.error());
    const auto view =
        look(asked,
             std::visit([](const auto& wanted) -> const WordValues& { return wordsOfMap(wanted); }, *parsed));
    if (!view) return;
    if (const auto* wanted = std::get_if<MapRequest>(&*parsed)) return map(asked, *wanted, *view);
    if (const auto* wanted = std::get_if<FeatureRequest>(&*parsed)) return feature(asked, *wanted, *view);
    if (const auto* wanted = std::get_if<LegendRequest>(&*parsed)) return legend(asked, *wanted, *view);
    capabilities(asked, std::get<CapabilitiesRequest>(*parsed), *view, false);
}

void MapAnswers::wmts(const Shared& asked, std::string_view query) const {
    const auto parsed = parseWmtsRequest(query, asked->id);
    if (!parsed) return asked->refuse(parsed.error());
    if (const auto* wanted = std::get_if<TileRequest>(&*parsed)) return tile(asked, *wanted);
    const auto& wanted = std::get<CapabilitiesRequest>(*parsed);
    if (const auto view = look(asked, wanted.words)) capabilities(asked, wanted, *view, true);
}

void MapAnswers::tile(const Shared& asked, const TileRequest& tile) const {
    const auto view = look(asked, tile.words);
    if (!view) return;
    const bool isFile = tile.set == fileCrs;
    const TileSet set = isFile ? fileTiles(*asked->own) : mercatorTiles();
    const MapExtent extent = set.extentOf(tile.z, tile.x, tile.y);
    MapRequest wanted;
    wanted.crs = isFile ? std::string(fileCrs) : "EPSG:3857";
    wanted.box = {extent.low.x, extent.low.y, extent.high.x, extent.high.y};
    wanted.width = extent.width;
    wanted.height = extent.height;
    wanted.format = tile.format;
    wanted.transparent = true;
    wanted.words = tile.words;
    map(asked, wanted, *view);
}

void MapAnswers::post(const Shared& asked, std::function<void()> work) const {
    const bool posted = worker_.post([asked, work = std::move(work)](const std::stop_token& stop) {
        if (stop.stop_requested() || asked->gone.stop_requested()) return;
        if (auto done = contained("Making a map", work); !done) asked->refuse(done.error());
    });
    if (!posted) asked->refuse(problemOf(503, "Too many maps are waiting; ask again in a moment."));
}

void MapAnswers::map(const Shared& asked, const MapRequest& map, const View& looked) const {
    const Cloud& cloud = *asked->cloud;
    if (std::uint64_t(map.width) * std::uint64_t(map.height) > options_.maxPixels) {
        return asked->refuse(
            {ErrorCode::ResourceLimit,
             fmt::format("A map of {} x {} pixels is larger than this server draws; the limit is {} pixels.",
                         map.width, map.height, options_.maxPixels),
             "WIDTH"});
    }
    auto view = asMap(cloud, looked, map);
    if (!view) return asked->refuse(view.error());
    const auto planned = plan(cloud, *view);
    if (!planned) return asked->refuse(planned.error());
    const DeviceStatus device = scheduler_.device();
    if (device.state != DeviceStatus::State::Ready)
        return asked->refuse(problemOf(503, "The rendering device is not available."));
    const bool isProjected = needsReference(map);
    if (isProjected && !crsMeaning(cloud.crsWkt, cloud.crsEpsg))
        return asked->refuse({ErrorCode::Unsupported,
                              "Where this cloud lies in the world is not known: the scan says nothing of its "
                              "coordinate reference system. Ask for it in the cloud's own coordinates: file.",
                              "CRS"});
    Ordered ordered{map, std::move(*view), (*planned)->margin, device.info, {}};
    ordered.tag = contentTag(
        pictureTag(cloud, ordered.view, ordered.map.format, device.info, options_.version) +
        printedMap(ordered.map) + (isProjected ? projections_ + placeOnEarth(cloud) : std::string()));
    HttpResponse head = ordered.head(*asked);
    if (matchesAny(asked->request.header("if-none-match"), ordered.tag)) {
        head.status = 304;
        return asked->respond(std::move(head));
    }
    if (asked->request.method == "HEAD") {
        head.bodyUnknown = true;
        return asked->respond(std::move(head));
    }
    const double pixels = double(ordered.map.width) * ordered.map.height;
    auto work = admission_.take(asked->request.client, forMap + pixels * forMapPixel);
    if (!work) return asked->refuse(work.error());
    asked->work = std::move(*work);
    post(asked, [this, asked, ordered = std::move(ordered)] { draw(asked, ordered); });
}

void MapAnswers::draw(const Shared& asked, const Ordered& ordered) const {
    const Cloud& cloud = *asked->cloud;
    TransientMemory::Hold net = memory_.hold(MemoryUse::Answers, bytesOfNet);
    static const Expected<GeoReference> notNeeded = fail(ErrorCode::Internal, "no reference is needed");
    const auto& geo = needsReference(ordered.map) ? references_->of(cloud) : notNeeded;
    const auto placement = placementOf(ordered.map, geo);
    if (!placement) return asked->refuse(placement.error());
    const auto background = backgroundOf(ordered.view);
    const auto picture = mapPicture(cloud, placement->extent, placement->projection, background,
                                    {.margin = ordered.margin, .mostPixels = options_.maxPixels});
    if (!picture) return asked->refuse(picture.error());
    if (!*picture) return answerEmpty(asked, ordered);
    View view = ordered.view;
    view.camera = (*picture)->camera;
    view.width = (*picture)->width;
    view.height = (*picture)->height;
    const auto planned = plan(cloud, view);
    if (!planned) return asked->refuse(planned.error());
    const auto refuseCostly = [this, &asked](const Problem& problem) {
        metrics_.pictureRefused(problem.status == 413   ? CostRefusal::Picture
                                : problem.status == 429 ? CostRefusal::Client
                                                        : CostRefusal::Total);
        asked->refuse(problem);
    };
    const PictureFormat format = ordered.map.format;
    const auto price = admission_.price(cloud, **planned, format);
    if (!price) return refuseCostly(price.error());
    auto work = admission_.take(asked->request.client, *price);
    if (!work) return refuseCostly(work.error());
    auto kept = admission_.keep(asked->request.client, bytesToKeep(ordered.view, format));
    if (!kept) return refuseCostly(kept.error());
    PictureOrder order{asked->cloud, view, format, false};
    order.planned = *planned;
    order.price = *price;
    order.client = asked->request.client;
    order.kept = std::move(*kept);
    if (const auto warp = (*picture)->warp) {
        order.remade = [warp, memory = memory_](const Frame& frame, const std::stop_token& stop) {
            const auto bytes = std::uint64_t(warp->width) * std::uint64_t(warp->height) * 4;
            const TransientMemory::Hold hold = memory.hold(MemoryUse::Frames, bytes);
            return warp->apply(frame, stop);
        };
    }
    const auto ticket = std::make_shared<WorkBudget::Ticket>(std::move(*work));
    PictureDone done = [asked, ordered, ticket, price = *price, planned = *planned,
                        most = mostSamples(cloud)](const Expected<EncodedPicture>& drawn) {
        ticket->reset();
        if (!drawn) return asked->refuse(drawn.error());
        HttpResponse response = ordered.head(*asked);
        // Ranks that came or went meanwhile, or another device.
        if (mostSamples(*asked->cloud) != most || drawn->device.identity != ordered.device.identity)
            forbidKeeping(response);
        if (drawn->stats.nodesDamaged > 0) sayDamaged(response, drawn->stats.nodesDamaged);
        response.set("Scancast-Method", planned->method);
        response.set("Server-Timing", serverTiming(*drawn));
        response.set("Scancast-Price", fmt::format("{:.0f}", price));
        response.price = price / 1000;
        response.bytes = drawn->bytes;
        asked->respond(std::move(response));
    };
    metrics_.pictureAdmitted(*price / 1000);
    if (auto queued = pictures_.order(ordered.tag, std::move(order), std::move(done), asked->gone); !queued)
        asked->refuse(problemOf(503, queued.error().message));
}

void MapAnswers::answerEmpty(const Shared& asked, const Ordered& ordered) const {
    const MapRequest& map = ordered.map;
    const double pixels = double(map.width) * map.height;
    auto kept = admission_.keep(asked->request.client, std::uint64_t(pixels));
    if (!kept) return asked->refuse(kept.error());
    const TransientMemory::Hold hold = memory_.hold(MemoryUse::Frames, std::uint64_t(pixels) * 8);
    auto bytes = encodePicture(emptyMap(map.width, map.height, backgroundOf(ordered.view)), ordered.view,
                               map.format, asked->gone);
    if (!bytes) return asked->refuse(bytes.error());
    HttpResponse response = ordered.head(*asked);
    response.bytes = memory_.shared(MemoryUse::Answers, std::move(*bytes), std::move(*kept));
    asked->respond(std::move(response));
}

}  // namespace scancast
