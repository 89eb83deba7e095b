// What is at places of maps, and where: picks, capabilities, longitudes and latitudes.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "protocol/points/lonlat_request.hpp"
#include "renderer/plan.hpp"
#include "server/catalog/describe_point.hpp"
#include "server/net/api/negotiate.hpp"
#include "server/net/maps/capabilities.hpp"
#include "server/net/maps/feature_text.hpp"
#include "server/net/maps/map_asked.hpp"
#include "server/net/maps/map_place.hpp"

namespace scancast {
namespace {

/// px: of the picture in whose middle a place is looked at.
constexpr int lookedAtSide = 33;

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

void MapAnswers::capabilities(const Shared& asked, const CapabilitiesRequest& request, bool isWmts) const {
    post(asked, [this, asked, request, isWmts] {
        const Cloud& cloud = *asked->cloud;
        const auto& geo = references_->of(cloud);
        MapFacts facts = mapFacts(cloud, geo ? &*geo : nullptr);
        facts.layer = asked->id;
        facts.address = asked->request.base + "/api/v1/clouds/" + asked->id;
        facts.words = request.words;
        facts.widest = int(std::min(std::sqrt(double(options_.maxPixels)), double(maxPictureSide)));
        HttpResponse response;
        response.text = isWmts ? wmtsCapabilities(facts, *asked->own) : wmsCapabilities(facts);
        const std::string tag = contentTag(response.text);
        response.set("Content-Type", isWmts ? "application/xml; charset=utf-8" : "text/xml; charset=utf-8")
            .set("ETag", tag)
            .set("Cache-Control", asked->live ? "no-store" : "no-cache");
        if (matchesAny(asked->request.header("if-none-match"), tag)) {
            response.status = 304;
            response.text.clear();
        }
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
