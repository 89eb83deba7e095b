#include "server/net/rasters/raster_answers.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <tuple>
#include <utility>

#include "protocol/view/view_words.hpp"
#include "renderer/geo/geo_reference.hpp"
#include "renderer/raster/raster_plan.hpp"
#include "server/base/faults.hpp"
#include "server/net/api/negotiate.hpp"
#include "server/net/points/low_arena.hpp"

namespace scancast {
namespace {

constexpr std::string_view tiffType = "image/tiff";
/// Parts have at least so many bytes, but for the last one, and at most so many.
constexpr std::size_t leastRasterPart = std::size_t(256) << 10, mostRasterPart = std::size_t(1) << 20;
/// Leaves that are decoded at a time, and what of a block is on its way.
constexpr std::uint64_t leavesBytes = std::uint64_t(16) << 20;
constexpr int mostLeavesAtOnce = 8;
/// Of the thread that makes them: whoever is drawn for goes first.
constexpr int rasterPoliteness = 10;
/// An orthophoto waits for its turn among the pictures: so often, this long each time.
constexpr int mostOrders = 100;
constexpr std::chrono::milliseconds untilNextOrder{100}, breath{5};

std::uint64_t workingBytesOf(const PlannedRaster& raster) {
    const auto side = std::uint64_t(raster.layout.grid.block) + 2 * std::uint64_t(raster.elevation.fill);
    const std::uint64_t block = side * side;
    const std::uint64_t part = block * bytesPerCell;  // that waits to be sent, or to be cut into tiles
    return raster.ortho ? 3 * part : block * bytesPerElevationCell + 2 * part + leavesBytes;
}

std::string factsOf(const RasterGrid& grid) {
    return nlohmann::json{{"columns", grid.columns}, {"rows", grid.rows}, {"cell", grid.cell},
                          {"left", grid.left},       {"top", grid.top},   {"right", grid.right()},
                          {"bottom", grid.bottom()}, {"tile", grid.tile}}
        .dump();
}

/// Where a file lies, and what is wrong with it, is for who runs this server.
Problem problemOfRaster(const Error& error, const std::string& path) {
    const bool isOfFile = error.code == ErrorCode::Io || error.code == ErrorCode::Malformed ||
                          error.code == ErrorCode::Truncated;
    if (!isOfFile) return problemOf(error, path);
    reportFault(error);
    return problemOf(
        500,
        "The raster cannot be made: what the points are kept in is damaged, or out of reach, or there is no "
        "room for temporary files. The server's log says more.",
        path);
}

}  // namespace

/// An answer in the making: touched by the worker alone, once it has been admitted.
struct RasterAnswers::Work {
    std::shared_ptr<const Cloud> cloud;
    PlannedRaster raster;
    std::string path, client;
    WorkPlaces::Place place;
    TransientMemory::Hold working;
    std::unique_ptr<RasterTiff> tiff;
    HttpResponse head;
    std::int64_t blocks = 0;                            ///< that are in
    std::string drawnBy{};                              ///< the device that the tag names
    std::optional<std::uint64_t> samples{};             ///< likewise, of a picture, at most
    std::chrono::steady_clock::time_point notBefore{};  ///< the next order
    int orders = 0;                                     ///< of the current block, that came to nothing
    Respond respond{};                                  ///< until it is answered
    BodySource::Given given{};                          ///< afterwards, while the next part is waited for
    std::stop_token gone{};
    std::unique_ptr<std::stop_callback<std::function<void()>>>
        leaves{};  ///< gives the picture up that is drawn

    /// Nobody waits for it any more.
    bool isOver() const { return gone.stop_requested(); }
    /// There is something to send, and with it everything that can be said before.
    bool canDeliver() const {
        if (tiff->isDone() || !tiff->nextBlock()) return true;
        return blocks > 0 && tiff->ready() >= (respond ? 1 : leastRasterPart);
    }
};

class RasterAnswers::Body final : public BodySource {
  public:
    Body(const RasterAnswers& maker, std::shared_ptr<Work> work) : maker_(maker), work_(std::move(work)) {}
    void next(Given given) override {
        maker_.worker_.post(
            [&maker = maker_, work = work_, given = std::move(given)](const std::stop_token&) {
                work->given = given;
                maker.advance(work);
            });
    }

  private:
    const RasterAnswers& maker_;
    const std::shared_ptr<Work> work_;
};

RasterAnswers::RasterAnswers(const Admission& admission, TransientMemory memory, Scheduler& scheduler,
                             const RasterOptions& options, std::string version)
    : admission_(admission),
      memory_(std::move(memory)),
      scheduler_(scheduler),
      options_(options),
      version_(std::move(version) + '\0' + projectionsVersion()),
      places_(options.places),
      arena_(std::make_unique<LowArena>()),
      worker_(2 * options.places.all + 2) {
    worker_.post([](const std::stop_token&) {
        std::ignore = setpriority(PRIO_PROCESS, id_t(gettid()), rasterPoliteness);
    });
}

RasterAnswers::~RasterAnswers() = default;

tl::expected<std::shared_ptr<RasterAnswers::Work>, HttpResponse> RasterAnswers::admit(
    const HttpRequest& request, const Routed& routed, const VisibleClouds& clouds) const {
    const auto refuse = [&](Problem problem) {
        problem.instance = routed.path;
        HttpResponse response = problemResponse(problem);
        if (problem.status == 429 || problem.status == 503) response.set("Retry-After", "1");
        return tl::unexpected(std::move(response));
    };
    const bool isElevation = routed.route == Route::Elevation;
    auto cloud = clouds.cloud(routed.id);
    if (!cloud) return refuse(cloud.error());
    if (!accepts(request.header("accept"), tiffType))
        return refuse(
            problemOf(406, "This address answers with image/tiff, which the Accept header rules out."));
    if (isElevation && routed.grant.identity.kind == IdentityKind::Guest && !options_.guestsMayExport)
        return refuse(problemOf(
            403,
            "Guests of this server see pictures, and do not get elevations; whoever runs it can allow "
            "that (--guests-may-export)."));
    const auto words = parseQuery(routed.query);
    if (!words) return refuse(problemOf(words.error()));
    const auto asked = rasterRequestOf(isElevation ? RasterKind::Elevation : RasterKind::Orthophoto, *words);
    if (!asked) return refuse(problemOf(asked.error()));
    if (const auto entry = clouds.find(routed.id); entry && entry->state == CloudState::Loading)
        return refuse(problemOf(
            503,
            "This cloud is still being read, and not all of its points are there; ask again in a moment."));
    // Of what an orthophoto shows: the cloud, or several together.
    View first;
    for (const auto& [word, text] : asked->view)
        if (word == "with" || word == "color")
            if (auto ok = applyWord(first, word, text); !ok) return refuse(problemOf(ok.error()));
    if (!first.with.empty()) {
        if (auto ok = validate(first); !ok) return refuse(problemOf(ok.error()));
        for (const auto& one : first.with)
            if (const auto entry = clouds.find(one.cloud); entry && entry->state == CloudState::Loading)
                return refuse(problemOf(
                    503, "with: the cloud " + one.cloud + " is still being read; ask again in a moment."));
        auto together = clouds.viewed(routed.id, first);
        if (!together) return refuse(problemOf(together.error()));
        *cloud = std::move(*together);
    }
    const int side = int(std::min(2048.0, std::sqrt(double(options_.mostPixels))));
    auto planned = planRaster(**cloud, *asked, {options_.mostCells, side});
    if (!planned) return refuse(problemOf(planned.error()));
    // A tag names bytes: what drew them, and with how much memory, has a part in an orthophoto's.
    std::string all = pictureRevision(**cloud) + '\0' + planned->identity + '\0' + version_;
    if (!isElevation) {
        const DeviceStatus device = scheduler_.device();
        if (device.state != DeviceStatus::State::Ready)
            return refuse(problemOf(503, "The rendering device is not available."));
        all += '\0' + device.info.identity;
        if (!(*cloud)->octree.store().whole())
            all += '\0' + std::to_string((*cloud)->octree.store().capacity());
    }
    const std::string tag = contentTag(all);
    HttpResponse head;
    head.set("Content-Type", std::string(tiffType))
        .set("ETag", tag)
        .set("Cache-Control", clouds.isLive(routed.id, first.with) ? "no-store" : "no-cache")
        .set("Scancast-Raster", factsOf(planned->layout.grid));
    if (matchesAny(request.header("if-none-match"), tag)) {
        head.status = 304;
        return tl::unexpected(std::move(head));
    }
    head.set("Content-Disposition",
             fmt::format("attachment; filename=\"{}-{}.tif\"", routed.id, isElevation ? "dem" : "ortho"))
        .set("X-Accel-Buffering", "no");
    if (request.method == "HEAD") {
        head.bodyUnknown = true;
        return tl::unexpected(std::move(head));
    }
    if (!isElevation) {
        const auto block =
            plan(**cloud, orthoView(**cloud, *planned->ortho, planned->layout.grid.blockAt(0)));
        if (!block) return refuse(problemOf(block.error()));
        const auto price = admission_.price(**cloud, **block, PictureFormat::Pixels);
        if (!price) return refuse(price.error());
    }
    auto place = places_.take(request.client);
    if (!place) return refuse(std::move(place.error()));
    auto working = memory_.hold(MemoryUse::Answers);
    const std::uint64_t needed = workingBytesOf(*planned), others = memory_.bytes(MemoryUse::Answers);
    // A last part that is on its way keeps nobody out.
    if (others > mostRasterPart && others + needed > memory_.forAnswers())
        return refuse(problemOf(
            503,
            "There is no memory for another raster: other answers have not been read yet. Ask again later."));
    working.resize(needed);
    planned->elevation.threads = std::clamp(arena_->cores.max_concurrency(), 1, mostLeavesAtOnce);
    auto work = std::make_shared<Work>();
    if (!isElevation) work->drawnBy = scheduler_.device().info.identity;
    work->samples = mostSamples(**cloud);
    work->cloud = *cloud;
    work->raster = std::move(*planned);
    work->path = routed.path;
    work->client = request.client;
    work->place = std::move(*place);
    work->working = std::move(working);
    work->head = std::move(head);
    return work;
}

void RasterAnswers::answer(const HttpRequest& request, const Routed& routed, const VisibleClouds& clouds,
                           Respond respond, std::stop_token gone) const {
    auto work = admit(request, routed, clouds);
    if (!work) return respond(std::move(work.error()));
    (*work)->respond = std::move(respond);
    (*work)->gone = std::move(gone);
    go(std::move(*work));
}

// A block at a time, so that all that are under way take turns.
void RasterAnswers::go(std::shared_ptr<Work> work) const {
    const bool posted = worker_.post([this, work](const std::stop_token&) { advance(work); });
    if (!posted) giveUp(work, Error{ErrorCode::Unavailable, "The server is shutting down.", {}});
}

void RasterAnswers::advance(const std::shared_ptr<Work>& work) const {
    if (work->isOver()) return;
    if (!work->tiff)
        if (auto ok = begin(work); !ok) return giveUp(work, ok.error());
    if (work->canDeliver()) return deliver(work);
    if (work->raster.ortho) return orderPicture(work);
    makeElevations(work);
}

void RasterAnswers::giveUp(const std::shared_ptr<Work>& work, const Error& error) const {
    if (work->respond)
        return std::exchange(work->respond, {})(problemResponse(problemOfRaster(error, work->path)));
    if (work->given) std::exchange(work->given, {})(tl::unexpected(error));
}

/// Where everything will stand, of a large one, takes a while, as does PROJ: not for a network thread.
Expected<void> RasterAnswers::begin(const std::shared_ptr<Work>& work) const {
    return contained("Making a raster", [&]() -> Expected<void> {
        std::error_code none;
        auto tiff = openTiff(*work->cloud, work->raster,
                             {std::filesystem::temp_directory_path(none), "TMPDIR",
                              options_.mostScratch / options_.places.all});
        if (!tiff) return passOn(tiff);
        work->tiff = std::move(*tiff);
        return {};
    });
}

void RasterAnswers::deliver(const std::shared_ptr<Work>& work) const {
    if (work->respond) {
        HttpResponse response = std::move(work->head);
        response.source = std::make_shared<Body>(*this, work);
        return std::exchange(work->respond, {})(std::move(response));
    }
    if (!work->given) return;
    auto part = contained("Giving a raster away", [&]() -> Expected<std::shared_ptr<const BodyPart>> {
        auto bytes = work->tiff->take(mostRasterPart);
        if (!bytes) return passOn(std::move(bytes));
        auto made = std::make_shared<BodyPart>();
        made->bytes = std::move(*bytes);
        made->hold = memory_.hold(MemoryUse::Answers, made->bytes.capacity());
        made->last = work->tiff->isDone();
        // Before its reader has the last byte: he may ask for another at once.
        if (made->last) {
            work->tiff.reset();
            work->working.resize(0);
        }
        return made;
    });
    std::exchange(work->given, {})(std::move(part));
}

void RasterAnswers::makeElevations(const std::shared_ptr<Work>& work) const {
    const auto made = arena_->run("Making a raster", [&]() -> Expected<void> {
        const auto cells = elevationCells(*work->cloud, work->raster, *work->tiff->nextBlock(), work->gone);
        if (!cells) return passOn(cells);
        return work->tiff->put(*cells);
    });
    if (work->isOver()) return;
    if (!made) return giveUp(work, made.error());
    ++work->blocks;
    go(work);
}

void RasterAnswers::orderPicture(const std::shared_ptr<Work>& work) const {
    if (std::chrono::steady_clock::now() < work->notBefore) {
        std::this_thread::sleep_for(breath);
        return go(work);  // others have their turn meanwhile
    }
    const View view = orthoView(*work->cloud, *work->raster.ortho, *work->tiff->nextBlock());
    const auto planned = plan(*work->cloud, view);
    if (!planned) return giveUp(work, planned.error());
    PictureOrder order{work->cloud, view, PictureFormat::Pixels, false};
    order.planned = *planned;
    order.price = admission_.price(*work->cloud, **planned, PictureFormat::Pixels)
                      .value_or(admission_.limits().picture);
    order.client = work->client;
    auto done = [this, work](Expected<EncodedPicture> picture) {
        auto drawn = std::make_shared<Expected<EncodedPicture>>(std::move(picture));
        worker_.post([this, work, drawn](const std::stop_token&) { takePicture(work, *drawn); });
    };
    const auto snapshot = scheduler_.snapshot(std::move(order), std::move(done));
    if (!snapshot) return orderAgain(work, snapshot.error());
    work->leaves = std::make_unique<std::stop_callback<std::function<void()>>>(
        work->gone, [this, id = *snapshot] { scheduler_.abandonSnapshot(id); });
}

void RasterAnswers::takePicture(const std::shared_ptr<Work>& work,
                                const Expected<EncodedPicture>& picture) const {
    work->leaves.reset();
    if (work->isOver()) return;
    if (!picture) return orderAgain(work, picture.error());
    // The tag has gone out, or will: what others drew is not of that file.
    if (picture->device.identity != work->drawnBy || mostSamples(*work->cloud) != work->samples)
        return giveUp(
            work,
            Error{ErrorCode::Unavailable, "The device that began to draw was replaced; ask again.", {}});
    if (picture->stats.nodesDamaged > 0)
        return giveUp(
            work,
            Error{ErrorCode::Malformed, "Blocks of the cloud that an orthophoto shows are damaged.", {}});
    const auto taken = contained("Making a raster", [&]() -> Expected<void> {
        const auto cells = cellsOf(*work->raster.ortho, *work->tiff->nextBlock(), *picture->bytes);
        if (!cells) return passOn(cells);
        return work->tiff->put(*cells);
    });
    if (!taken) return giveUp(work, taken.error());
    ++work->blocks;
    work->orders = 0;
    advance(work);
}

/// Where others have asked for too much, it waits: who has got a part of a file wants the rest.
void RasterAnswers::orderAgain(const std::shared_ptr<Work>& work, const Error& error) const {
    const bool isBusy = error.code == ErrorCode::ResourceLimit || error.code == ErrorCode::DeadlineExceeded;
    if (!isBusy || ++work->orders >= mostOrders || scheduler_.draining()) return giveUp(work, error);
    work->notBefore = std::chrono::steady_clock::now() + untilNextOrder;
    go(work);
}

}  // namespace scancast
