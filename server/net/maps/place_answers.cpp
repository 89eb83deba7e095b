// What is at places of maps, where, and what its colours mean: picks, capabilities, legends, longitudes and latitudes.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "protocol/points/lonlat_request.hpp"
#include "renderer/map/map_legend.hpp"
#include "renderer/plan.hpp"
#include "server/catalog/describe_point.hpp"
#include "server/net/api/negotiate.hpp"
#include "server/net/api/picture_request.hpp"
#include "server/net/maps/capabilities.hpp"
#include "server/net/maps/feature_text.hpp"
#include "server/net/maps/map_asked.hpp"
#include "server/net/maps/map_place.hpp"
#include "server/scheduler/picture_bytes.hpp"

namespace scancast {
namespace {

/// px: of the picture in whose middle a place is looked at.
constexpr int lookedAtSide = 33;
/// ms of a reference core: to draw a legend and encode it.
constexpr double forLegend = 3;

/// For who asks for no map, but for what stands beside one.
MapRequest smallMap(const WordValues& words) {
    MapRequest map;
    map.crs = fileCrs;
    map.width = map.height = tileSide;
    map.words = words;
    return map;
}

}  // namespace

void MapAnswers::feature(const Shared& asked, const FeatureRequest& request, const View& looked) const {
    const auto view = asMap(*asked->cloud, looked, request.map);
    if (!view) return asked->refuse(view.error());
    post(asked, [this, asked, request, view = *view] { pick(asked, request, view); });
}

void MapAnswers::pick(const Shared& asked, const FeatureRequest& request, View view) const {
    static const Expected<GeoReference> notNeeded = fail(ErrorCode::Internal, "no reference is needed");
    const auto& geo = needsReference(request.map) ? references_->of(*asked->cloud) : notNeeded;
    const auto placement = placementOf(request.map, geo);
    if (!placement) return asked->refuse(placement.error());
    const glm::dvec2 pixel(request.i + 0.5, request.j + 0.5);
    const glm::dvec2 there = placement->extent.placeAt(pixel);
    const auto place = placeUnder(placement->extent, placement->projection, pixel);
    if (!place) return asked->respond(featureResponse(request.format, nullptr, there));
    view.width = view.height = lookedAtSide;
    view.camera = cameraAbove(*asked->cloud, place->place, lookedAtSide * place->unitsPerPixel);
    const auto planned = plan(*asked->cloud, view);
    if (!planned) return asked->refuse(planned.error());
    const auto price = admission_.price(*asked->cloud, **planned, PictureFormat::Depth);
    if (!price) return asked->refuse(price.error());
    auto work = admission_.take(asked->request.client, *price);
    if (!work) return asked->refuse(work.error());
    auto done = [asked, format = request.format, there, price = *price,
                 ticket = std::make_shared<WorkBudget::Ticket>(std::move(*work))](
                    const Expected<std::optional<Picked>>& picked) {
        ticket->reset();
        if (!picked) return asked->refuse(picked.error());
        HttpResponse response =
            featureResponse(format, *picked ? pickedJson(*asked->cloud, **picked) : nlohmann::json(), there);
        response.price = price / 1000;
        asked->respond(std::move(response));
    };
    const double middle = lookedAtSide * 0.5;
    if (auto queued = picker_.pick(asked->cloud, *planned, middle, middle, std::move(done),
                                   {asked->request.client, *price, asked->gone});
        !queued)
        asked->refuse(queued.error());
}

void MapAnswers::capabilities(const Shared& asked, const CapabilitiesRequest& request, const View& looked,
                              bool isWmts) const {
    const auto view = asMap(*asked->cloud, looked, smallMap(request.words));
    if (!view) return asked->refuse(view.error());
    post(asked, [this, asked, request, isWmts, view = *view] {
        const Cloud& cloud = *asked->cloud;
        const auto& geo = references_->of(cloud);
        MapFacts facts = mapFacts(cloud, view, geo ? &*geo : nullptr);
        facts.layer = asked->id;
        facts.address = asked->request.base + "/api/v1/clouds/" + asked->id;
        facts.words = request.words;
        facts.widest = int(std::min(std::sqrt(double(options_.maxPixels)), double(maxPictureSide)));
        HttpResponse response;
        response.text = isWmts ? wmtsCapabilities(facts, *asked->own) : wmsCapabilities(facts, request.isOld);
        const std::string tag = contentTag(response.text);
        const char* type = isWmts          ? "application/xml; charset=utf-8"
                           : request.isOld ? "application/vnd.ogc.wms_xml; charset=utf-8"
                                           : "text/xml; charset=utf-8";
        response.set("Content-Type", type)
            .set("ETag", tag)
            .set("Cache-Control", asked->live ? "no-store" : "no-cache");
        if (matchesAny(asked->request.header("if-none-match"), tag)) {
            response.status = 304;
            response.text.clear();
        }
        asked->respond(std::move(response));
    });
}

void MapAnswers::legend(const Shared& asked, const LegendRequest& request, const View& looked) const {
    MapRequest map = smallMap(request.words);
    map.format = request.format;
    map.transparent = request.transparent;
    map.background = request.background;
    const auto view = asMap(*asked->cloud, looked, map);
    if (!view) return asked->refuse(view.error());
    auto work = admission_.take(asked->request.client, forLegend);
    if (!work) return asked->refuse(work.error());
    asked->work = std::move(*work);
    post(asked, [this, asked, request, view = *view] {
        const auto planned = plan(*asked->cloud, view);
        if (!planned) return asked->refuse(planned.error());
        const MapLegend legend = mapLegend(*asked->cloud, **planned);
        const LegendSize size = legendSize(legend);
        const auto pixels = std::uint64_t(size.width) * std::uint64_t(size.height);
        auto kept = admission_.keep(asked->request.client, pixels);
        if (!kept) return asked->refuse(kept.error());
        const TransientMemory::Hold hold = memory_.hold(MemoryUse::Frames, pixels * 8);
        const Background& background = view.style.background;
        const bool isTransparent = background.kind == Background::Kind::Transparent;
        auto bytes =
            encodePicture(drawLegend(legend, isTransparent ? std::nullopt : std::optional(background.top)),
                          view, request.format, asked->gone);
        if (!bytes) return asked->refuse(bytes.error());
        const std::string tag = contentTag({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
        HttpResponse response;
        response.set("Content-Type", std::string(mediaType(request.format)))
            .set("ETag", tag)
            .set("Cache-Control", asked->live ? "no-store" : "no-cache");
        if (matchesAny(asked->request.header("if-none-match"), tag))
            response.status = 304;
        else
            response.bytes = memory_.shared(MemoryUse::Answers, std::move(*bytes), std::move(*kept));
        asked->respond(std::move(response));
    });
}

void MapAnswers::lonLat(const Shared& asked, const std::string& body) const {
    auto parsed = parseLonLatRequest(body);
    if (!parsed) return asked->refuse(parsed.error());
    post(asked, [this, asked, request = std::move(*parsed)]() mutable {
        const auto& geo = references_->of(*asked->cloud);
        if (!geo) return asked->refuse(geo.error());
        auto& places = request.points;
        if (request.toFile)
            geo->toFile(WorldCrs::LonLat, places);
        else
            geo->fromFile(WorldCrs::LonLat, places);
        LonLatPoints points;
        for (const glm::dvec2& place : places)
            points.push_back(std::isfinite(place.x) ? std::optional(place) : std::nullopt);
        asked->respond(jsonResponse({{"points", toJson(points)}, {"crs", crsJson(*asked->cloud)}}));
    });
}

}  // namespace scancast
