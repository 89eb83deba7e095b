#include "server/net/api/measurer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "protocol/text/grouped.hpp"
#include "renderer/residency/pictured_octree.hpp"
#include "renderer/style.hpp"
#include "server/base/faults.hpp"
#include "server/catalog/describe_measure.hpp"
#include "server/net/api/negotiate.hpp"
#include "server/net/api/picture_request.hpp"

namespace scancast {
namespace {

constexpr std::size_t mostMeasuresWaiting = 16;

// ns of a reference core: to decode a point and see where it lies, and for each place or corner that it is held against.
constexpr double forPoint = 60, forCorner = 2;

/// Where points can be that have a part in it; all heights of a volume.
MeasuredBox boxOf(const MeasureRequest& request, double heightScale) {
    MeasuredBox box{request.points.front(), request.points.front()};
    const double within = request.within.value_or(0);
    const glm::dvec3 margin(within, within, within / heightScale);
    for (const glm::dvec3& p : request.points) {
        box.low = glm::min(box.low, p - margin);
        box.high = glm::max(box.high, p + margin);
    }
    if (request.kind == MeasureKind::Volume)
        box.low.z = std::numeric_limits<double>::lowest(), box.high.z = std::numeric_limits<double>::max();
    return box;
}

bool needsPoints(const MeasureRequest& request) {
    return request.kind == MeasureKind::Volume || request.within.has_value();
}

}  // namespace

struct Measurer::Asked {
    std::shared_ptr<const Cloud> cloud;
    MeasureRequest request;
    SampleFilter filter;
    CrsUnits units;
    VolumeLimits limits;
    std::uint64_t bytes = 0;
    double price = 0;  ///< ms
    std::string path;
    WorkBudget::Ticket work, kept;
    Respond respond;
};

Measurer::Measurer(const Admission& admission, TransientMemory memory, std::uint64_t maxPixels)
    : admission_(admission),
      memory_(std::move(memory)),
      maxPixels_(maxPixels),
      worker_(mostMeasuresWaiting) {}

void Measurer::answer(const HttpRequest& request, const Routed& routed,
                      const std::shared_ptr<const Cloud>& cloud, Respond respond,
                      std::stop_token gone) const {
    const auto refuse = [&](Problem problem) {
        problem.instance = routed.path;
        HttpResponse response = problemResponse(problem);
        if (problem.status == 429 || problem.status == 503) response.set("Retry-After", "1");
        respond(std::move(response));
    };
    auto parsed = parseMeasureRequest(request.body);
    if (!parsed) return refuse(problemOf(parsed.error()));
    auto units = unitsToMeasureIn(*cloud, parsed->kind);
    if (!units) return refuse(problemOf(units.error()));
    if (parsed->isArithmetic()) {
        const auto measured = arithmeticJson(*parsed, *units);
        if (!measured) return refuse(problemOf(measured.error()));
        return respond(jsonResponse(*measured));
    }
    const auto planned = viewOfCloudAlone(*cloud, parsed->view, maxPixels_);
    if (!planned) {
        Error error = planned.error();
        if (!error.field.empty()) error.field = "view." + error.field;
        return refuse(problemOf(error));
    }
    auto filtered = filteredCloud(cloud, (*planned)->view.style);
    if (!filtered) return refuse(problemOf(filtered.error()));
    Asked asked{std::move(*filtered),
                std::move(*parsed),
                sampleFilter(*cloud, (*planned)->view.style),
                std::move(*units),
                {},
                0,
                0,
                routed.path,
                {},
                {},
                respond};
    asked.limits.heightScale = asked.units.heightScale();
    asked.limits.mostCells = std::clamp<std::uint64_t>(memory_.forAnswers() / 4 / bytesPerVolumeCell, 1000,
                                                       asked.limits.mostCells);
    if (asked.request.kind == MeasureKind::Volume) {
        // What is wrong with it is known before anybody waits.
        const auto cell = cellSide(*cloud, asked.request, asked.limits);
        if (!cell) return refuse(problemOf(cell.error()));
        asked.bytes = asked.limits.mostCells * bytesPerVolumeCell;
    } else {
        asked.bytes = 3 * mostFittedPoints * sizeof(glm::dvec3);
    }
    if (needsPoints(asked.request)) {
        const std::uint64_t points = pointsNear(*cloud, boxOf(asked.request, asked.limits.heightScale));
        const double passes = asked.request.kind == MeasureKind::Volume ? 2 : 1;
        asked.price =
            double(points) * passes * (forPoint + forCorner * double(asked.request.points.size())) * 1e-6;
        if (asked.price > admission_.limits().picture) {
            return refuse(problemOf(Error{
                ErrorCode::ResourceLimit,
                fmt::format(
                    "{} points lie in the bounds of this; going over them would take {:.1f} s of a core, and "
                    "the limit here is {:.1f} s. Measure a smaller part.",
                    grouped(points), asked.price / 1000, admission_.limits().picture / 1000),
                {}}));
        }
    }
    auto work = admission_.take(request.client, asked.price);
    if (!work) return refuse(std::move(work.error()));
    auto kept = admission_.keep(request.client, asked.bytes);
    if (!kept) return refuse(std::move(kept.error()));
    asked.work = std::move(*work);
    asked.kept = std::move(*kept);
    const bool posted = worker_.post(
        [this, asked = std::make_shared<Asked>(std::move(asked)), gone](const std::stop_token& stop) {
            std::stop_source both;
            const auto end = [&both] { both.request_stop(); };
            const std::stop_callback byWorker(stop, end), byClient(gone, end);
            if (!both.stop_requested()) measure(*asked, both.get_token());
        });
    if (!posted) refuse(problemOf(503, "Too many measurements are waiting; ask again in a moment."));
}

void Measurer::measure(const Asked& asked, const std::stop_token& stop) const {
    const auto measured = contained("Measuring", [&]() -> Expected<nlohmann::json> {
        const TransientMemory::Hold hold = memory_.hold(MemoryUse::Answers, asked.bytes);
        if (asked.request.kind == MeasureKind::Volume) {
            const auto volume = measureVolume(*asked.cloud, asked.filter, asked.request, asked.limits, stop);
            if (!volume) return passOn(volume);
            return volumeJson(asked.request, *volume, asked.units);
        }
        const auto shape =
            measureShape(*asked.cloud, asked.filter, asked.request, asked.limits.heightScale, stop);
        if (!shape) return passOn(shape);
        return shapeJson(*shape, asked.units);
    });
    if (stop.stop_requested()) return;
    if (measured) {
        HttpResponse response = jsonResponse(*measured);
        response.price = asked.price / 1000;
        return asked.respond(std::move(response));
    }
    const Error& error = measured.error();
    const bool isOfFile = error.code == ErrorCode::Io || error.code == ErrorCode::Malformed ||
                          error.code == ErrorCode::Truncated;
    if (!isOfFile) return asked.respond(problemResponse(problemOf(error, asked.path)));
    // It is not the request that is malformed; and where the file lies is for who runs this server.
    reportFault(error);
    asked.respond(problemResponse(problemOf(
        500, "Points there cannot be read: the cloud's file is damaged. The server's log says more.",
        asked.path)));
}

}  // namespace scancast
