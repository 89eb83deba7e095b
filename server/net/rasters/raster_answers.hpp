// Answers with rasters of a cloud in plan, as GeoTIFF: elevations (GET …/dem.tif) and orthophotos (GET …/ortho.tif), of any size: made block
// by block on a thread of their own, all that are under way in turn, and sent while they are made, or, packed, when the last block is
// there. Elevations come after everything that is drawn; an orthophoto's blocks are pictures that its client asks for, one at a time.
//
// Owned by the API. *Thread safety*: any thread. Pipeline: api → **raster answers** → renderer/raster, scheduler.
#pragma once

#include <memory>
#include <stop_token>
#include <string>

#include "renderer/raster/raster_grid.hpp"
#include "renderer/raster/raster_tiff.hpp"
#include "server/base/transient_memory.hpp"
#include "server/catalog/visible_clouds.hpp"
#include "server/net/api/http_message.hpp"
#include "server/net/api/router.hpp"
#include "server/net/points/work_places.hpp"
#include "server/net/worker.hpp"
#include "server/price/admission.hpp"
#include "server/scheduler/scheduler.hpp"

namespace scancast {

struct RasterOptions {
    WorkPlaces::Limits places{4, 2, "rasters"};
    bool guestsMayExport = false;  ///< elevations, too; orthophotos they may always see
    std::uint64_t mostCells = 1'000'000'000;
    std::uint64_t mostPixels = 16'000'000;               ///< of a picture
    std::uint64_t mostScratch = std::uint64_t(8) << 30;  ///< bytes of all that wait packed
};

struct LowArena;

class RasterAnswers {
  public:
    /// Admission and scheduler outlive this.
    RasterAnswers(const Admission& admission, TransientMemory memory, Scheduler& scheduler,
                  const RasterOptions& options, std::string version);
    ~RasterAnswers();

    /// Answers when the first block is there, or all of them where they are packed; never once `gone` is requested. Problems: 400;
    /// 403 for guests; 404; 406; 413 for more cells than there are, or pictures that cost too much; 422 for a cloud of which there are no
    /// rasters; 429 and 503 where too many are under way, while the cloud is being read or there is no device; 500 where it is damaged.
    /// What fails later breaks the connection off, before the last chunk.
    void answer(const HttpRequest& request, const Routed& routed, const VisibleClouds& clouds,
                Respond respond, std::stop_token gone) const;
    /// Nothing is answered afterwards.
    void stop() { worker_.stop(); }

  private:
    struct Work;
    class Body;

    tl::expected<std::shared_ptr<Work>, HttpResponse> admit(const HttpRequest& request, const Routed& routed,
                                                            const VisibleClouds& clouds) const;
    void go(std::shared_ptr<Work> work) const;
    void advance(const std::shared_ptr<Work>& work) const;
    Expected<void> begin(const std::shared_ptr<Work>& work) const;
    void deliver(const std::shared_ptr<Work>& work) const;
    void giveUp(const std::shared_ptr<Work>& work, const Error& error) const;
    void makeElevations(const std::shared_ptr<Work>& work) const;
    void orderPicture(const std::shared_ptr<Work>& work) const;
    void takePicture(const std::shared_ptr<Work>& work, const Expected<EncodedPicture>& picture) const;
    void orderAgain(const std::shared_ptr<Work>& work, const Error& error) const;

    const Admission& admission_;
    const TransientMemory memory_;
    Scheduler& scheduler_;
    const RasterOptions options_;
    const std::string version_;  ///< of the program and of PROJ, which may put a system's name into a file
    const WorkPlaces places_;
    const std::unique_ptr<LowArena> arena_;
    mutable Worker worker_;  // last: ends before the rest
};

}  // namespace scancast
