// What the server says of a measurement: numbers, and the units that they are in. Pure functions; any thread.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "renderer/cloud/import/crs_units.hpp"
#include "renderer/measure/fit.hpp"
#include "renderer/measure/volume.hpp"

namespace scancast {

/// What the cloud's coordinates are in. Unsupported, with the way out, where they are no lengths: degrees; or where up is not z, for
/// what is measured in plan view.
Expected<CrsUnits> unitsToMeasureIn(const CloudFacts& cloud, MeasureKind kind);

/// Of a request for which isArithmetic(). InvalidArgument (`points`): a polygon whose edges cross each other.
Expected<nlohmann::json> arithmeticJson(const MeasureRequest& request, const CrsUnits& units);
nlohmann::json volumeJson(const MeasureRequest& request, const VolumeMeasure& volume, const CrsUnits& units);
nlohmann::json shapeJson(const ShapeMeasure& shape, const CrsUnits& units);

}  // namespace scancast
