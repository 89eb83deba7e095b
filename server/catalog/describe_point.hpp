// What the server says of one point, and of what its coordinates are in. Pure functions; any thread.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "renderer/pick/pick.hpp"

namespace scancast {

/// {"name", "epsg", "unit", "verticalName", "verticalEpsg", "verticalUnit"}: what is known of it; null: nothing is.
nlohmann::json crsJson(const CloudFacts& cloud);
/// A picked point: its coordinates, and of its attributes those that the cloud has or its file keeps.
nlohmann::json pickedJson(const Cloud& cloud, const Picked& picked);
/// {"gps_time": 303.1, …}: each column's value. Numbers that a double has not exactly are strings of their digits; what is not
/// finite is null.
nlohmann::json attributesJson(const KeptPoint& point);

}  // namespace scancast
