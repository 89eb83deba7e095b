// What the sessions of a bench saw, put together: as JSON for programs, as lines for people. Pure functions.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "client/cpp/program/bench_session.hpp"

namespace scancast::client {

/// The smallest of the values that so many per cent of them do not exceed (nearest rank); 0 for none.
double percentile(std::vector<double> values, double percent);

/// `{"sessions": …, "seconds": …, "width": …, "height": …, "method": …, "groups": [one for each behaviour]}`.
nlohmann::json benchReport(const BenchOptions& options, const std::vector<BenchResult>& results);

/// The same in a few lines for each behaviour.
std::string benchText(const nlohmann::json& report);

}  // namespace scancast::client
