// Answers what is asked of a cloud's maps: pictures by WMS, WMTS and as tiles, what lies at a place of a map, capabilities, and places as
// longitudes and latitudes. Requests are judged at once, as are those whose tag tells that nothing has changed; where projections are
// asked, on a thread of its own: PROJ's objects belong to one thread, and may take milliseconds. Pictures then go the way of snapshots:
// they have a price, are drawn by the scheduler, and become maps beside the render thread.
//
// Owned by the API. *Thread safety*: any thread. Pipeline: api → **map answers** → renderer/map → scheduler, picker.
#pragma once

#include <memory>
#include <stop_token>
#include <string>

#include "protocol/view/query.hpp"
#include "server/base/metrics.hpp"
#include "server/base/transient_memory.hpp"
#include "server/catalog/visible_clouds.hpp"
#include "server/net/api/http_message.hpp"
#include "server/net/api/picker.hpp"
#include "server/net/api/router.hpp"
#include "server/net/api/shared_pictures.hpp"
#include "server/net/points/work_places.hpp"
#include "server/net/worker.hpp"
#include "server/price/admission.hpp"

namespace scancast {

struct CapabilitiesRequest;
struct FeatureRequest;
struct LegendRequest;
struct MapRequest;
struct TileRequest;

struct MapOptions {
    std::uint64_t maxPixels = 0;  ///< of a map, and of the picture that is drawn for it
    std::string version;
};

class MapAnswers {
  public:
    /// What is referred to outlives this.
    MapAnswers(MapOptions options, const Admission& admission, const SharedPictures& pictures,
               const Picker& picker, const Scheduler& scheduler, Metrics& metrics, TransientMemory memory);
    ~MapAnswers();

    /// A request to one of the routes of maps. Once `gone` is requested nobody waits for the answer, and it may never come. Problems: 400;
    /// 404; 413 where a map costs too much; 422 where a projection is wanted and the world does not know the cloud's coordinates; 429 and
    /// 503 where too much waits; in the words of the service that was asked.
    void answer(const HttpRequest& request, const Routed& routed, const VisibleClouds& clouds,
                Respond respond, const std::stop_token& gone) const;
    /// Nothing is answered afterwards. The scheduler must have ended.
    void stop() { worker_.stop(); }

  private:
    struct Asked;
    struct Ordered;
    class References;
    using Shared = std::shared_ptr<Asked>;  // changed by look() alone

    void wms(const Shared& asked, std::string_view query) const;
    void wmts(const Shared& asked, std::string_view query) const;
    /// What words of a view mean here; nullopt: it has been answered why not.
    std::optional<View> look(const Shared& asked, const WordValues& words) const;
    void map(const Shared& asked, const MapRequest& map, const View& looked) const;
    void tile(const Shared& asked, const TileRequest& tile) const;
    void feature(const Shared& asked, const FeatureRequest& request, const View& looked) const;
    void capabilities(const Shared& asked, const CapabilitiesRequest& request, const View& looked,
                      bool isWmts) const;
    void legend(const Shared& asked, const LegendRequest& request, const View& looked) const;
    void lonLat(const Shared& asked, const std::string& body) const;

    void post(const Shared& asked, std::function<void()> work) const;
    void draw(const Shared& asked, const Ordered& ordered) const;
    void answerEmpty(const Shared& asked, const Ordered& ordered) const;
    void pick(const Shared& asked, const FeatureRequest& request, View view) const;

    const MapOptions options_;
    const Admission& admission_;
    const SharedPictures& pictures_;
    const Picker& picker_;
    const Scheduler& scheduler_;
    Metrics& metrics_;
    const TransientMemory memory_;
    const std::string projections_;  ///< whose they are: part of tags
    const WorkPlaces places_;
    const std::unique_ptr<References> references_;  // the worker's own
    mutable Worker worker_;                         // last: ends before the rest
};

}  // namespace scancast
