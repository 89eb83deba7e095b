// What each route answers. Knows requests and responses, but no sockets.
//
// Owned by the server, which outlives every connection. *Thread safety*: every function may be called from
// any thread. Pipeline: http session → router → **api** → catalog, scheduler.
#pragma once

#include <atomic>
#include <cstdint>
#include <stop_token>
#include <string>

#include "server/access/failed_logins.hpp"
#include "server/base/metrics.hpp"
#include "server/catalog/catalog.hpp"
#include "server/catalog/cloud_admin.hpp"
#include "server/catalog/kept_clouds.hpp"
#include "server/net/access.hpp"
#include "server/net/api/http_message.hpp"
#include "server/net/api/measurer.hpp"
#include "server/net/api/photo_answers.hpp"
#include "server/net/api/picker.hpp"
#include "server/net/api/router.hpp"
#include "server/net/api/shared_pictures.hpp"
#include "server/net/maps/map_answers.hpp"
#include "server/net/origin_check.hpp"
#include "server/net/points/points_answers.hpp"
#include "server/net/rasters/raster_answers.hpp"
#include "server/price/admission.hpp"
#include "server/scheduler/scheduler.hpp"
#include "server/stream/session_register.hpp"

namespace scancast {

/// The addresses that the server listens on.
enum class Entrance : std::uint8_t {
    Public,
    Probes,  ///< of --admin-listen: /healthz, /readyz and /metrics
};

struct ApiOptions {
    std::string version;
    std::uint64_t maxPixels = 0;  ///< of a picture
    OriginRules origins;
    std::shared_ptr<BlockCache> cache{};    ///< for /metrics; may be empty
    std::shared_ptr<KeptClouds> kept{};     ///< the same
    std::shared_ptr<RemoteFiles> remote{};  ///< the same
    AccessTokens tokens{};
    Rates rates = shippedRates();
    CostLimits costs{};
    TransientMemory memory{};
    std::string probesHost{};             ///< of --admin-listen; a Host there may name it
    std::string strictTransport{};        ///< of answers that go through TLS; empty = none
    std::function<RanksStats()> ranks{};  ///< for /metrics; may be empty
    PointsOptions points{};
    RasterOptions rasters{};  ///< but for what guests may, and for pictures' pixels
};

class Api {
  public:
    /// All but the options outlive the API.
    Api(ApiOptions options, const Catalog& catalog, CloudAdmin& admin, const SessionRegister& sessions,
        Scheduler& scheduler, Metrics& metrics);

    /// Everything that can be refused before anything is done: Host, Origin, path, token, method; and, at an entrance
    /// for probes, what is none. What is admitted says by whose token.
    tl::expected<Routed, HttpResponse> admit(const HttpRequest& request,
                                             Entrance entrance = Entrance::Public) const;
    /// Answers an admitted request, at once or when its picture is done. Not for a WebSocket's upgrade or a
    /// GET of an MJPEG stream.
    /// Once `gone` is requested nobody waits for the answer, and work for it ends; it may never come.
    void answer(const HttpRequest& request, const Routed& routed, Respond respond,
                const std::stop_token& gone = {}) const;
    /// Counts a response and puts the headers on it that all of them carry. Goes over every response,
    /// refusals too.
    void complete(const HttpRequest& request, std::string_view routePattern, HttpResponse& response,
                  Entrance entrance = Entrance::Public) const;
    /// For answers that have no HttpResponse.
    const std::string& strictTransport() const { return options_.strictTransport; }
    /// What lies under a pixel; for streams, too.
    const Picker& picker() const { return picker_; }
    /// Who may do what; its tokens may be replaced.
    Access& access() { return access_; }
    /// What pictures may cost; for streams, too.
    const Admission& admission() const { return admission_; }
    /// From now on /readyz says that nobody should come any more; all else is answered.
    void leave() { leaving_ = true; }
    /// The server is about to end: there are no new streams.
    bool leaving() const { return leaving_ || scheduler_.draining(); }
    /// After the scheduler has ended: nothing is answered any more.
    void stop() {
        picker_.stop();
        photos_.stop();
        points_.stop();
        measurer_.stop();
        rasters_.stop();
        maps_.stop();
    }

  private:
    struct Answers;  ///< what each route answers, in api.cpp

    /// Counts a token that let nobody in, and says so in the log. The answer to it: that one, or 429 to who tries too often.
    HttpResponse loginFailed(const HttpRequest& request, LoginFailure why, HttpResponse answer) const;

    const ApiOptions options_;
    const OriginRules probeRules_;
    const std::string frameAncestors_;  ///< as a policy names them
    Access access_;
    mutable FailedLogins failedLogins_;
    const Catalog& catalog_;
    CloudAdmin& admin_;
    const SessionRegister& sessions_;
    Scheduler& scheduler_;
    Metrics& metrics_;
    const Admission admission_;
    const SharedPictures pictures_;
    std::atomic<bool> leaving_{false};
    Picker picker_;
    PhotoAnswers photos_;
    PointsAnswers points_;
    Measurer measurer_;
    RasterAnswers rasters_;
    MapAnswers maps_;
};

}  // namespace scancast
