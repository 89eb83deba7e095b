#include "server/price/admission.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

namespace scancast {
namespace {

/// Less than what snapshots have until their deadline.
constexpr double secondsAhead = 25;

double seconds(double milliseconds) {
    return milliseconds / 1000;
}

std::string sentence(const std::map<std::string, double>& nearest) {
    std::string words;
    for (const auto& [word, value] : nearest)
        words += fmt::format("{}{}={:g}", words.empty() ? "" : "&", word, value);
    return words.empty() ? "Ask for a smaller one." : "With " + words + " it would be drawn.";
}

}  // namespace

CostLimits completed(CostLimits limits) {
    const double cores = std::max(1u, std::thread::hardware_concurrency());
    if (limits.total <= 0) limits.total = std::max(limits.picture, secondsAhead * 1000 * cores);
    if (limits.client <= 0) limits.client = std::max(limits.picture, limits.total / 2);
    return limits;
}

Admission::Admission(Rates rates, const CostLimits& limits)
    : rates_(std::move(rates)), limits_(completed(limits)), budget_({limits_.client, limits_.total}) {}

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
    if (price <= limits_.picture) return price;
    return tl::unexpected(tooCostly(price, cloud, planned.view, format));
}

Expected<void> Admission::mayBeDrawn(const Cloud& cloud, const PlannedView& planned) const {
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

}  // namespace scancast
