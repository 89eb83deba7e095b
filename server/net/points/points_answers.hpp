// Answers with the points of a cloud: those of a region (POST …/points) and those of a corridor along a line (POST …/profile), in a
// format that other programs read, or the corridor's picture. Made while they are sent, a batch at a time, on a thread of their
// own: all that are under way take turns on it, and who reads slowly keeps his own and nobody else's waiting. On the machine's cores
// they come after everything that is drawn.
//
// Owned by the API. *Thread safety*: any thread. Pipeline: api → **points answers** → points job, profile drawing.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>

#include "protocol/points/points_request.hpp"
#include "server/base/transient_memory.hpp"
#include "server/catalog/visible_clouds.hpp"
#include "server/net/api/http_message.hpp"
#include "server/net/api/router.hpp"
#include "server/net/points/work_places.hpp"
#include "server/net/worker.hpp"

namespace scancast {

struct PointsOptions {
    WorkPlaces::Limits places{};
    bool guestsMayExport = false;           ///< points, too; pictures they may always see
    std::uint64_t mostPixels = 16'000'000;  ///< of a profile's picture
};

struct LowArena;

class PointsAnswers {
  public:
    PointsAnswers(TransientMemory memory, const PointsOptions& options);
    ~PointsAnswers();

    /// Answers when the first points are there, or it is known that there are none; never once `gone` is requested. Problems:
    /// 400; 403 for guests; 404; 406; 422 for a region without points and a cloud whose points cannot be had; 429 and 503 where
    /// too many are under way; 503 while the cloud is being read; 500 where its file is damaged. What fails later breaks the
    /// connection off, before the last chunk.
    void points(const HttpRequest& request, const Routed& routed, const VisibleClouds& clouds,
                Respond respond, std::stop_token gone) const;
    /// The same; of a picture all of it is answered at once.
    void profile(const HttpRequest& request, const Routed& routed, const VisibleClouds& clouds,
                 Respond respond, std::stop_token gone) const;
    /// Nothing is answered afterwards.
    void stop() { worker_.stop(); }

  private:
    struct Asked;
    struct Export;
    struct Drawing;
    class Body;

    /// At most, of a cloud's picture.
    using PicturePixels = std::function<std::uint64_t(const Cloud&)>;
    /// `picturePixels`: nullptr where points are wanted.
    tl::expected<Asked, Problem> admit(const HttpRequest& request, const Routed& routed,
                                       const VisibleClouds& clouds, const PicturePixels& picturePixels) const;
    void begin(std::shared_ptr<Export> work) const;
    void produce(std::shared_ptr<Export> work, BodySource::Given given) const;
    void draw(std::shared_ptr<Drawing> work) const;
    bool post(Worker::Task task) const;

    const TransientMemory memory_;
    const PointsOptions options_;
    const WorkPlaces places_;
    const std::unique_ptr<LowArena> arena_;
    mutable Worker worker_;  // last: ends before the rest
};

}  // namespace scancast
