#include "server/catalog/describe_measure.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "protocol/json_fields.hpp"
#include "protocol/measure/vertices.hpp"
#include "renderer/cloud/import/crs_text.hpp"

namespace scancast {
namespace {

using nlohmann::json;

constexpr double inDegrees = 180 / std::numbers::pi;

json named(const std::string& unit) {
    return unit.empty() ? json() : json(unit);
}

json headOf(MeasureKind kind, const CrsUnits& units) {
    return {{"measure", name(kind)},
            {"unit", named(units.unit)},
            {"verticalUnit", named(units.verticalUnit.empty() ? units.unit : units.verticalUnit)}};
}

json optionalNumber(const std::optional<double>& value) {
    return value ? json(*value) : json();
}

json distanceJson(json json, const PolylineMeasure& line) {
    json.update({{"length", line.length},
                 {"horizontal", line.horizontal},
                 {"vertical", line.vertical},
                 {"climb", line.climb},
                 {"descent", line.descent},
                 {"legs", json::array()}});
    for (const auto& leg : line.legs)
        json["legs"].push_back(
            {{"length", leg.length}, {"horizontal", leg.horizontal}, {"vertical", leg.vertical}});
    return json;
}

json angleJson(json json, const std::vector<VertexAngle>& angles) {
    json["angles"] = json::array();
    for (std::size_t i = 0; i < angles.size(); ++i)
        json["angles"].push_back({{"vertex", i + 1},
                                  {"degrees", optionalNumber(angles[i].space)},
                                  {"plan", optionalNumber(angles[i].plan)}});
    return json;
}

json areaJson(json json, const AreaMeasure& area) {
    json.update(
        {{"area", area.plane},
         {"planArea", area.plan},
         {"perimeter", area.perimeter},
         {"planPerimeter", area.planPerimeter},
         {"plane",
          {{"center", jsonArray(area.center)}, {"normal", jsonArray(area.normal)}, {"off", area.off}}}});
    return json;
}

/// How steep a plane is, and where it falls to.
json slopeJson(const glm::dvec3& normal) {
    const double flat = std::hypot(normal.x, normal.y);
    const double steep = std::atan2(flat, normal.z) * inDegrees;
    double towards = std::atan2(normal.x, normal.y) * inDegrees;
    if (towards < 0) towards += 360;
    return {{"slope", steep}, {"falls", flat > 1e-12 ? json(towards) : json()}};
}

}  // namespace

Expected<CrsUnits> unitsToMeasureIn(const CloudFacts& cloud, MeasureKind kind) {
    CrsUnits units = crsUnits(cloud.crsWkt, cloud.crsEpsg);
    const std::string name = crsName(cloud.crsWkt, cloud.crsEpsg);
    const std::string of = name.empty() ? std::string() : " of " + name;
    if (units.kind == CrsUnits::Kind::Geographic)
        return fail(
            ErrorCode::Unsupported,
            "The coordinates of this cloud are degrees" + of +
                ", in which lengths, areas and volumes mean nothing (unit: degree); bring the scan into a "
                "projected system, such as its UTM zone, and measure there.");
    if (units.kind == CrsUnits::Kind::Geocentric && kind <= MeasureKind::Volume)
        return fail(
            ErrorCode::Unsupported,
            "The coordinates of this cloud" + (name.empty() ? std::string() : ", those of " + name + ",") +
                " count from the middle of the earth, so that z is not up; bring the scan into a projected "
                "system, such as its UTM zone, and measure there.");
    return units;
}

Expected<json> arithmeticJson(const MeasureRequest& request, const CrsUnits& units) {
    json head = headOf(request.kind, units);
    const double scale = units.heightScale();
    if (request.kind == MeasureKind::Distance)
        return distanceJson(std::move(head), measurePolyline(request.points, scale));
    if (request.kind == MeasureKind::Angle)
        return angleJson(std::move(head), measureAngles(request.points, scale));
    const AreaMeasure area = measureArea(request.points, scale);
    if (area.crossing)
        return fail(
            ErrorCode::InvalidArgument,
            fmt::format("points: the edges from corner {} and from corner {} meet; an area needs a polygon "
                        "whose edges do not",
                        (*area.crossing)[0], (*area.crossing)[1]),
            "points");
    return areaJson(std::move(head), area);
}

json volumeJson(const MeasureRequest& request, const VolumeMeasure& volume, const CrsUnits& units) {
    json value = headOf(MeasureKind::Volume, units);
    const bool any = volume.holes < volume.cells;
    value.update({{"above", volume.above},
                  {"below", volume.below},
                  {"net", volume.above - volume.below},
                  {"area", volume.area},
                  {"covered", volume.covered},
                  {"uncovered", volume.area - volume.covered},
                  {"surface", volumeSurfaceNames[std::size_t(request.surface)]},
                  {"cell", volume.cell},
                  {"cells", volume.cells},
                  {"holes", volume.holes},
                  {"points", volume.points},
                  {"lowest", any ? json(volume.lowest) : json()},
                  {"highest", any ? json(volume.highest) : json()}});
    const BasePlane& base = volume.base;
    value["base"] = {{"at", {base.middle.x, base.middle.y, base.height}},
                     {"slope", {base.slope.x, base.slope.y}}};
    return value;
}

json shapeJson(const ShapeMeasure& shape, const CrsUnits& units) {
    json value = headOf(shape.kind, units);
    value.update({{"center", jsonArray(shape.center)},
                  {"rms", shape.rms},
                  {"points", shape.points},
                  {"fitted", shape.fitted},
                  {"used", shape.used}});
    if (shape.kind == MeasureKind::Plane) {
        value["normal"] = jsonArray(shape.axis);
        value.update(slopeJson(shape.axis));
        return value;
    }
    value["radius"] = shape.radius;
    value["diameter"] = 2 * shape.radius;
    if (shape.kind == MeasureKind::Sphere) return value;
    value["axis"] = jsonArray(shape.axis);
    value["arc"] = shape.arc;
    if (shape.kind == MeasureKind::Cylinder) value["length"] = shape.length;
    return value;
}

}  // namespace scancast
