// What the files of map answers share: who asked, and where clouds are in the world. Not for others.
// Pipeline: map answers → **asked** → map_answers.cpp, place_answers.cpp.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "renderer/geo/geo_reference.hpp"
#include "server/net/maps/map_answers.hpp"
#include "server/net/maps/map_request.hpp"
#include "server/net/maps/service_exception.hpp"

namespace scancast {

/// Who asked, for what cloud. Shared by all who work for it.
struct MapAnswers::Asked {
    explicit Asked(const VisibleClouds& visible) : clouds(visible) {}

    std::shared_ptr<const Cloud> own;  ///< of the address: tiles stay where they are, whatever else is shown
    std::shared_ptr<const Cloud> cloud;  ///< what the words of a view show
    VisibleClouds clouds;
    bool live = false;
    MapService service = MapService::Plain;
    HttpRequest request;
    std::string id, path;
    Respond respond;
    std::stop_token gone;
    WorkPlaces::Place place;  ///< among those that wait
    WorkBudget::Ticket work;  ///< of what is done before its picture has a price

    void refuse(Problem problem, std::string_view field = {}) const {
        problem.instance = path;
        const int status = problem.status;
        HttpResponse response = exceptionResponse(service, problem, field);
        if (status == 429 || status == 503) response.set("Retry-After", "1");
        respond(std::move(response));
    }
    void refuse(const Error& error) const { refuse(problemOf(error), error.field); }
};

/// Where clouds are, remembered: PROJ needs milliseconds to find out.
class MapAnswers::References {
  public:
    static constexpr std::size_t most = 16;

    const Expected<GeoReference>& of(const Cloud& cloud) {
        for (auto at = known_.begin(); at != known_.end(); ++at) {
            if (at->wkt != cloud.crsWkt || at->epsg != cloud.crsEpsg) continue;
            if (at != known_.begin()) std::rotate(known_.begin(), at, at + 1);
            Expected<GeoReference>& known = known_.front().reference;
            // What is wrong with this machine passes.
            if (!known && known.error().code == ErrorCode::Internal) known = GeoReference::create(cloud);
            return known;
        }
        known_.push_front({cloud.crsWkt, cloud.crsEpsg, GeoReference::create(cloud)});
        if (known_.size() > most) known_.pop_back();
        return known_.front().reference;
    }

  private:
    struct Known {
        std::string wkt;
        std::optional<int> epsg;
        Expected<GeoReference> reference;
    };
    std::deque<Known> known_;
};

/// A map's view of what words of a view have made: it has one background, and its camera looks straight down, on all of the cloud until
/// there is an extent. InvalidArgument (background).
Expected<View> asMap(const Cloud& cloud, View view, const MapRequest& map);

}  // namespace scancast
