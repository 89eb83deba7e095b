#include "server/net/points/points_answers.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "renderer/cloud/columns/pictured_file.hpp"
#include "renderer/image/encode.hpp"
#include "renderer/profile/profile_picture.hpp"
#include "renderer/residency/file_of.hpp"
#include "renderer/style.hpp"
#include "server/base/faults.hpp"
#include "server/net/api/negotiate.hpp"
#include "server/net/points/low_arena.hpp"
#include "server/net/points/points_job.hpp"

namespace scancast {
namespace {

/// Parts have at least so many bytes, but for the last one; there are two of each answer at most.
constexpr std::size_t leastPart = std::size_t(256) << 10;
/// Leaves, a batch and its bytes, of one answer in the making.
constexpr std::uint64_t workingBytes = std::uint64_t(24) << 20;
/// Of the thread that makes them: whoever is drawn for goes first.
constexpr int politeness = 10;
constexpr std::string_view pngType = "image/png";

/// Sentences as a header has them: a list of strings (RFC 8941), in ASCII.
std::string headerList(const std::vector<std::string>& sentences) {
    std::string list;
    for (const std::string& sentence : sentences) {
        list += list.empty() ? "\"" : ", \"";
        for (const char c : sentence) {
            if (c == '"' || c == '\\') list += '\\';
            list += c >= ' ' && c <= '~' ? c : '?';
        }
        list += '"';
    }
    return list;
}

/// Where a file lies, and what is wrong with it, is for who runs this server.
Problem problemOfPoints(const Error& error, const std::string& path) {
    const bool isOfFile = error.code == ErrorCode::Io || error.code == ErrorCode::Malformed ||
                          error.code == ErrorCode::Truncated;
    if (!isOfFile) return problemOf(error, path);
    reportFault(error);
    return problemOf(
        500,
        "The points cannot be read: what they are kept in is damaged, or out of reach. The server's "
        "log says more.",
        path);
}

HttpResponse secret(HttpResponse response) {
    response.set("Cache-Control", "no-store");
    return response;
}

}  // namespace

/// What an answer of either kind needs.
struct PointsAnswers::Asked {
    std::shared_ptr<const Cloud> cloud;
    std::shared_ptr<const CloudFile> file;
    std::string path, id;
    WorkPlaces::Place place;
    TransientMemory::Hold working;
    Respond respond{};
    std::stop_token gone{};

    void refuse(const Error& error) const { respond(problemResponse(problemOfPoints(error, path))); }
    /// Takes of the file what the region's filter leaves, coloured by a column where the picture is.
    Expected<void> picture(const PointsRegion& region, const Style& style = {}) {
        auto pictured = picturedLeaves(file, region.filter, style);
        if (!pictured) {
            Error error = pictured.error();
            error.field = (error.field == "color" ? "picture." : "region.") + error.field;
            return tl::unexpected(std::move(error));
        }
        file = std::move(*pictured);
        return {};
    }
    /// Nobody waits for it any more.
    bool isOver() const { return gone.stop_requested(); }
};

struct PointsAnswers::Export {
    Asked asked;
    PointsJob job;
    HttpResponse head;
};

struct PointsAnswers::Drawing {
    Asked asked;
    std::unique_ptr<ProfileDrawing> drawing;
};

class PointsAnswers::Body final : public BodySource {
  public:
    Body(const PointsAnswers& maker, std::shared_ptr<Export> work) : maker_(maker), work_(std::move(work)) {}
    void next(Given given) override { maker_.produce(work_, std::move(given)); }

  private:
    const PointsAnswers& maker_;
    const std::shared_ptr<Export> work_;
};

PointsAnswers::PointsAnswers(TransientMemory memory, const PointsOptions& options)
    : memory_(std::move(memory)),
      options_(options),
      places_(options.places),
      arena_(std::make_unique<LowArena>()),
      worker_(options.places.all + 1) {
    worker_.post(
        [](const std::stop_token&) { std::ignore = setpriority(PRIO_PROCESS, id_t(gettid()), politeness); });
}

PointsAnswers::~PointsAnswers() = default;

tl::expected<PointsAnswers::Asked, Problem> PointsAnswers::admit(const HttpRequest& request,
                                                                 const Routed& routed,
                                                                 const VisibleClouds& clouds,
                                                                 const PicturePixels& picturePixels) const {
    const bool isPicture = picturePixels != nullptr;
    auto cloud = clouds.cloud(routed.id);
    if (!cloud) return tl::unexpected(std::move(cloud.error()));
    if (routed.grant.identity.kind == IdentityKind::Guest && !isPicture && !options_.guestsMayExport)
        return tl::unexpected(
            problemOf(403,
                      "Guests of this server see pictures, and do not get points; whoever runs it can allow "
                      "that (--guests-may-export)."));
    if (const auto entry = clouds.find(routed.id); entry && entry->state == CloudState::Loading)
        return tl::unexpected(problemOf(
            503,
            "This cloud is still being read, and not all of its points are there; ask again in a moment."));
    auto file = fileOf(*cloud);
    if (!file) return tl::unexpected(problemOf(file.error()));
    auto place = places_.take(request.client);
    if (!place) return tl::unexpected(std::move(place.error()));
    Asked asked{.cloud = *cloud,
                .file = std::move(*file),
                .path = routed.path,
                .id = routed.id,
                .place = std::move(*place),
                .working = memory_.hold(MemoryUse::Answers)};
    const bool isAlone = memory_.bytes(MemoryUse::Answers) == 0;
    // What lies nearest in each, its colours, and these as PNG.
    constexpr std::uint64_t bytesPerPixel = 8 + 4 + 4;
    const std::uint64_t needed = workingBytes + (isPicture ? picturePixels(**cloud) * bytesPerPixel : 0);
    if (!isAlone && memory_.bytes(MemoryUse::Answers) + needed > memory_.forAnswers())
        return tl::unexpected(problemOf(
            503, "There is no memory for another export: others have not been read yet. Ask again later."));
    asked.working.resize(needed);
    return asked;
}

bool PointsAnswers::post(Worker::Task task) const {
    return worker_.post(std::move(task));
}

void PointsAnswers::points(const HttpRequest& request, const Routed& routed, const VisibleClouds& clouds,
                           Respond respond, std::stop_token gone) const {
    const auto refuse = [&](Problem problem) {
        problem.instance = routed.path;
        respond(problemResponse(problem));
    };
    const auto wanted = parsePointsRequest(request.body);
    if (!wanted) return refuse(problemOf(wanted.error()));
    if (!accepts(request.header("accept"),
                 mediaType(wanted->format).substr(0, mediaType(wanted->format).find(';'))))
        return refuse(problemOf(406, fmt::format("Points as {} are {}, which the Accept header rules out.",
                                                 name(wanted->format), mediaType(wanted->format))));
    auto asked = admit(request, routed, clouds, nullptr);
    if (!asked) return refuse(std::move(asked.error()));
    asked->respond = std::move(respond);
    asked->gone = std::move(gone);
    if (auto ok = asked->picture(wanted->region); !ok) return asked->refuse(ok.error());
    ExportOptions options{.output = {},
                          .format = wanted->format,
                          .region = wanted->region,
                          .estimatedNormals = wanted->estimatedNormals};
    PointsJob job(asked->file, std::move(options), asked->gone);
    HttpResponse head;
    head.set("Content-Type", std::string(mediaType(wanted->format)))
        .set("Content-Disposition",
             fmt::format("attachment; filename=\"{}{}.{}\"", asked->id,
                         wanted->region.isEverything() ? "" : "-part", name(wanted->format)));
    begin(std::make_shared<Export>(Export{std::move(*asked), std::move(job), secret(std::move(head))}));
}

void PointsAnswers::profile(const HttpRequest& request, const Routed& routed, const VisibleClouds& clouds,
                            Respond respond, std::stop_token gone) const {
    const auto refuse = [&](Problem problem) {
        problem.instance = routed.path;
        respond(problemResponse(problem));
    };
    const std::string accept = request.header("accept");
    const bool likesPictures = preference(accept, pngType) > preference(accept, "text/csv");
    const auto wanted = parseProfileRequest(request.body, likesPictures);
    if (!wanted) return refuse(problemOf(wanted.error()));
    const std::string type(wanted->format ? mediaType(*wanted->format) : pngType);
    if (!accepts(accept, type.substr(0, type.find(';'))))
        return refuse(
            problemOf(406, fmt::format("This profile is {}, which the Accept header rules out.", type)));
    auto corridor = Corridor::create(wanted->line, wanted->width);
    if (!corridor) return refuse(problemOf(corridor.error()));
    const auto& picture = wanted->picture;
    const PicturePixels pixels = [&](const Cloud& cloud) {
        const std::array heights{cloud.bounds[0].z, cloud.bounds[1].z};
        return mostProfilePixels(picture, corridor->length(), heights, options_.mostPixels);
    };
    auto asked = admit(request, routed, clouds, wanted->format ? nullptr : pixels);
    if (!asked) return refuse(std::move(asked.error()));
    asked->respond = respond;
    asked->gone = std::move(gone);
    const Style shown = wanted->format ? Style() : decidedStyle(*asked->cloud, picture.style);
    if (auto ok = asked->picture(wanted->region, shown); !ok) return refuse(problemOf(ok.error()));
    if (!wanted->format) {
        auto drawing =
            ProfileDrawing::create(*asked->cloud, asked->file, *wanted, options_.mostPixels, asked->gone);
        if (!drawing) return refuse(problemOf(drawing.error()));
        return draw(std::make_shared<Drawing>(Drawing{std::move(*asked), std::move(*drawing)}));
    }
    HttpResponse head;
    head.set("Content-Type", type)
        .set("Content-Disposition",
             fmt::format("attachment; filename=\"{}-profile.{}\"", asked->id, name(*wanted->format)))
        .set("Scancast-Profile",
             nlohmann::json{{"length", corridor->length()}, {"width", corridor->width()}}.dump());
    ExportOptions options{.output = {},
                          .format = *wanted->format,
                          .region = wanted->region,
                          .estimatedNormals = wanted->estimatedNormals,
                          .corridor = std::make_shared<const Corridor>(std::move(*corridor))};
    PointsJob job(asked->file, std::move(options), asked->gone);
    begin(std::make_shared<Export>(Export{std::move(*asked), std::move(job), secret(std::move(head))}));
}

// A step at a time, so that all that are under way take turns.
void PointsAnswers::begin(std::shared_ptr<Export> work) const {
    const bool posted = post([this, work](const std::stop_token&) {
        if (work->asked.isOver()) return;
        if (auto done = arena_->run("Giving points away", [&] { return work->job.step(); }); !done)
            return work->asked.refuse(done.error());
        if (!work->job.hasBegun()) return begin(work);
        HttpResponse response = std::move(work->head);
        if (const auto points = work->job.points()) response.set("Scancast-Points", std::to_string(*points));
        if (const auto losses = headerList(work->job.losses()); !losses.empty())
            response.set("Scancast-Losses", losses);
        response.set("Trailer", "Scancast-Losses").set("X-Accel-Buffering", "no");
        response.source = std::make_shared<Body>(*this, work);
        work->asked.respond(std::move(response));
        work->asked.respond = {};  // which holds the connection, and that the response
    });
    if (!posted)
        work->asked.respond(
            problemResponse(problemOf(503, "The server is shutting down.", work->asked.path)));
}

void PointsAnswers::produce(std::shared_ptr<Export> work, BodySource::Given given) const {
    post([this, work = std::move(work), given = std::move(given)](const std::stop_token&) {
        if (work->asked.isOver()) return;
        PointsJob& job = work->job;
        if (job.waiting() < leastPart && !job.isDone())
            if (auto done = arena_->run("Giving points away", [&] { return job.step(); }); !done)
                return given(passOn(done));
        if (job.waiting() < leastPart && !job.isDone()) return produce(work, given);
        auto part = contained("Giving points away", [&]() -> Expected<std::shared_ptr<const BodyPart>> {
            auto made = std::make_shared<BodyPart>();
            made->bytes = job.take();
            made->hold = memory_.hold(MemoryUse::Answers, made->bytes.capacity());
            made->last = job.isDone();
            if (!made->last) return made;
            if (const auto losses = headerList(job.lateLosses()); !losses.empty())
                made->trailers.emplace_back("Scancast-Losses", losses);
            return made;
        });
        given(std::move(part));
    });
}

void PointsAnswers::draw(std::shared_ptr<Drawing> work) const {
    const bool posted = post([this, work](const std::stop_token&) {
        if (work->asked.isOver()) return;
        ProfileDrawing& drawing = *work->drawing;
        const auto more = arena_->run("Giving points away", [&] { return drawing.step(); });
        if (!more) return work->asked.refuse(more.error());
        if (*more) return draw(work);
        auto answer = contained("Drawing a profile", [&]() -> Expected<HttpResponse> {
            auto png = encodePng(drawing.frame(), drawing.isTransparent(), work->asked.gone);
            if (!png) return passOn(png);
            const ProfileScale& scale = drawing.scale();
            const nlohmann::json facts{{"length", drawing.length()},   {"points", drawing.points()},
                                       {"heights", drawing.heights()}, {"left", 0},
                                       {"right", scale.lastStation()}, {"bottom", scale.low},
                                       {"top", scale.high()}};
            HttpResponse response;
            response.set("Content-Type", std::string(pngType)).set("Scancast-Profile", facts.dump());
            response.bytes = memory_.shared(MemoryUse::Answers, std::move(*png), work->asked.place);
            return secret(std::move(response));
        });
        if (!answer) return work->asked.refuse(answer.error());
        // Before its reader has it: he may ask for another at once.
        work->drawing.reset();
        work->asked.working.resize(0);
        work->asked.respond(std::move(*answer));
    });
    if (!posted)
        work->asked.respond(
            problemResponse(problemOf(503, "The server is shutting down.", work->asked.path)));
}

}  // namespace scancast
