#include "server/price/admission.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "files/machine.hpp"
#include "server/catalog/memory_room.hpp"
#include "server/scheduler/picture_bytes.hpp"

namespace scancast {
namespace {

/// Less than what snapshots have until their deadline.
constexpr double secondsAhead = 25;

double seconds(double milliseconds) {
    return milliseconds / 1000;
}

double megabytes(double bytes) {
    return bytes / 1e6;
}

std::string sentence(const std::map<std::string, double>& nearest) {
    std::string words;
    for (const auto& [word, value] : nearest)
        words += fmt::format("{}{}={:g}", words.empty() ? "" : "&", word, value);
    return words.empty() ? "Ask for a smaller one." : "With " + words + " it would be drawn.";
}

}  // namespace

CostLimits completed(CostLimits limits) {
    const double cores = machineCores();
    if (limits.total <= 0) limits.total = std::max(limits.picture, secondsAhead * 1000 * cores);
    if (limits.client <= 0) limits.client = std::max(limits.picture, limits.total / 2);
    return limits;
}

Admission::Admission(Rates rates, const CostLimits& limits, const TransientMemory& memory)
    : rates_(std::move(rates)),
      limits_(completed(limits)),
      memory_(memory),
      budget_({limits_.client, limits_.total}),
      unread_({double(memory.forAnswers()) / 2, double(memory.forAnswers())}) {}

/// The nearest size that there is memory for, where the view's own is too much; screenfuls always are drawn.
std::optional<Admission::Size> Admission::nearestInMemory(const View& view, PictureFormat format) const {
    const auto needed = double(bytesToDraw(view, format)), most = double(memory_.forFrames());
    const double pixels = double(view.width) * view.height;
    if (needed <= most || pixels <= double(smallPicturePixels)) return std::nullopt;
    const double side = std::sqrt(std::max(most / needed, double(smallPicturePixels) / pixels));
    return Size{std::max(1, int(view.width * side)), std::max(1, int(view.height * side))};
}

Error Admission::tooLarge(const View& view, PictureFormat format, const Size& nearest) const {
    return {
        ErrorCode::ResourceLimit,
        fmt::format(
            "A picture of {} x {} pixels takes {:.0f} MB of memory while it is drawn, and this server has "
            "{:.0f} MB for one. With width={}&height={} it would be drawn.",
            view.width, view.height, megabytes(double(bytesToDraw(view, format))),
            megabytes(double(memory_.forFrames())), nearest.width, nearest.height),
        "width"};
}

Problem Admission::tooCostly(double price, const Cloud& cloud, const View& view, PictureFormat format) const {
    Problem::Cost cost{price, limits_.picture, nearestWithin(limits_.picture, rates_, cloud, view, format)};
    Problem problem = problemOf(
        Error{ErrorCode::ResourceLimit,
              fmt::format("This picture would take {:.1f} s of a core; the limit here is {:.1f} s. {}",
                          seconds(price), seconds(limits_.picture), sentence(cost.nearest)),
              cost.nearest.empty() ? "" : cost.nearest.begin()->first});
    problem.cost = std::move(cost);
    return problem;
}

tl::expected<double, Problem> Admission::price(const Cloud& cloud, const PlannedView& planned,
                                               PictureFormat format) const {
    const double price = priceOf(rates_, cloud, planned, format);
    if (const auto nearest = nearestInMemory(planned.view, format)) {
        Problem problem = problemOf(tooLarge(planned.view, format, *nearest));
        problem.cost =
            Problem::Cost{price, limits_.picture, {{"width", nearest->width}, {"height", nearest->height}}};
        return tl::unexpected(std::move(problem));
    }
    if (price <= limits_.picture) return price;
    return tl::unexpected(tooCostly(price, cloud, planned.view, format));
}

Expected<void> Admission::mayBeDrawn(const Cloud& cloud, const PlannedView& planned) const {
    if (const auto nearest = nearestInMemory(planned.view, PictureFormat::Jpeg))
        return tl::unexpected(tooLarge(planned.view, PictureFormat::Jpeg, *nearest));
    if (mostPriceOf(rates_, cloud, planned, PictureFormat::Jpeg) <= limits_.picture) return {};
    if (auto known = price(cloud, planned, PictureFormat::Jpeg); !known) {
        const Problem& problem = known.error();
        return fail(ErrorCode::ResourceLimit, problem.detail,
                    problem.errors.empty() ? "" : problem.errors.front().parameter);
    }
    return {};
}

tl::expected<WorkBudget::Ticket, Problem> Admission::take(const std::string& client, double price) const {
    auto ticket = budget_.take(client, price);
    if (ticket) return std::move(*ticket);
    const WorkBudget::Refusal& why = ticket.error();
    Problem problem = problemOf(
        why.ofClient ? 429 : 503,
        fmt::format(
            "{} pictures that would take {:.1f} s of a core, and the limit is {:.1f} s; this one would take "
            "another {:.1f} s. Ask again when some of them have come.",
            why.ofClient ? "You are waiting for" : "Others are waiting for", seconds(why.used),
            seconds(why.limit), seconds(price)));
    problem.cost = Problem::Cost{price, why.limit, {}};
    return tl::unexpected(std::move(problem));
}

tl::expected<WorkBudget::Ticket, Problem> Admission::keep(const std::string& client,
                                                          std::uint64_t bytes) const {
    auto ticket = unread_.take(client, double(bytes));
    if (ticket) return std::move(*ticket);
    const WorkBudget::Refusal& why = ticket.error();
    return tl::unexpected(problemOf(
        why.ofClient ? 429 : 503,
        fmt::format(
            "{} pictures of about {:.0f} MB that have not been read to their end, and this server keeps "
            "{:.0f} MB{}. Read them, or ask again later.",
            why.ofClient ? "You have" : "Others have", megabytes(why.used), megabytes(why.limit),
            why.ofClient ? " for one client" : "")));
}

}  // namespace scancast
