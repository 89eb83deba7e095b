#include "protocol/measure/measure_request.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "protocol/json_fields.hpp"
#include "protocol/json_text.hpp"

namespace scancast {
namespace {

using nlohmann::json;

constexpr double farthestCoordinate = 1e12;

std::string listed(std::span<const std::string_view> names) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + std::string(names[i]);
    return text;
}

/// Which of the names; what is none of them is an error. `before`: what else there may be.
template <std::size_t N>
std::optional<std::size_t> oneOf(FieldReader& fields, const char* key,
                                 const std::array<std::string_view, N>& names,
                                 const std::string& before = {}) {
    std::string word;
    if (!fields.text(key, word)) return std::nullopt;
    const auto at = std::ranges::find(names, word);
    if (at != names.end()) return std::size_t(at - names.begin());
    fields.error(key, "must be " + before + listed(names));
    return std::nullopt;
}

/// [x, y, z]; [x, y] where heights have no part in it.
bool readPoint(const json& value, bool mayBeFlat, glm::dvec3& point) {
    if (!value.is_array() || value.size() > 3 || value.size() < (mayBeFlat ? 2U : 3U)) return false;
    for (std::size_t a = 0; a < value.size(); ++a) {
        if (!value[a].is_number()) return false;
        const double number = value[a].get<double>();
        if (!std::isfinite(number) || std::abs(number) > farthestCoordinate) return false;
        point[int(a)] = number;
    }
    return true;
}

void readPoints(FieldReader& fields, MeasureRequest& request) {
    const json* list = fields.require("points");
    if (list == nullptr) return;
    if (!list->is_array() || list->empty() || list->size() > mostMeasuredPoints)
        return fields.error("points",
                            "must be a list of 1 to " + std::to_string(mostMeasuredPoints) + " points");
    const bool isVolume = request.kind == MeasureKind::Volume;
    const bool mayBeFlat = isVolume && request.base == VolumeBase::Height;
    for (std::size_t i = 0; i < list->size(); ++i) {
        glm::dvec3 point(0);
        if (!readPoint((*list)[i], mayBeFlat, point))
            return fields.error("points[" + std::to_string(i) + "]",
                                std::string("must be three numbers, a place in file coordinates") +
                                    (mayBeFlat  ? ", or two"
                                     : isVolume ? "; two are enough over a base that is a height"
                                                : ""));
        request.points.push_back(point);
    }
}

void readBase(FieldReader& fields, MeasureRequest& request) {
    const json* base = fields.find("base");
    if (base == nullptr) return;
    if (base->is_number()) {
        request.base = VolumeBase::Height;
        request.height = base->get<double>();
        if (!(std::abs(request.height) <= farthestCoordinate)) fields.error("base", "is out of range");
        return;
    }
    if (!base->is_string()) return fields.error("base", "must be a height, or " + listed(volumeBaseNames));
    if (const auto which = oneOf(fields, "base", volumeBaseNames, "a height, or "))
        request.base = VolumeBase(*which);
}

void readLength(FieldReader& fields, const char* key, std::optional<double>& out) {
    fields.number(key, out);
    if (out && !(*out > 0 && *out <= farthestCoordinate)) fields.error(key, "must be a length above 0");
}

/// How many points each needs, and what else.
void checkCount(FieldReader& fields, const MeasureRequest& request) {
    const std::size_t count = request.points.size();
    const auto need = [&](std::size_t least, const char* what) {
        if (count < least) fields.error("points", what);
    };
    switch (request.kind) {
        case MeasureKind::Distance:
            return need(2, "a distance needs two vertices at least");
        case MeasureKind::Angle:
            return need(3, "an angle needs three vertices at least");
        case MeasureKind::Area:
        case MeasureKind::Volume:
            return need(3, "a polygon has three corners at least");
        case MeasureKind::Plane:
            if (!request.within) need(3, "a plane goes through three points at least; or say within");
            return;
        case MeasureKind::Circle:
            if (!request.within && count != 3)
                fields.error("points", "a circle goes through three points; or say within");
            return;
        case MeasureKind::Sphere:
        case MeasureKind::Cylinder:
            if (!request.within)
                fields.error("within", "is needed: how near to these points the scan's points are fitted");
    }
}

}  // namespace

Expected<MeasureRequest> parseMeasureRequest(std::string_view text) {
    const auto value = parseJson(text);
    if (!value) return passOn(value);
    MeasureRequest request;
    FieldReader fields(*value);
    if (fields.require("measure")) {
        if (const auto kind = oneOf(fields, "measure", measureNames)) request.kind = MeasureKind(*kind);
    }
    if (!request.isArithmetic()) {
        if (const auto* view = fields.findValue("view")) {
            if (view->is_object())
                request.view = *view;
            else
                fields.error("view", "expected an object");
        }
    }
    if (request.kind == MeasureKind::Volume) {
        readBase(fields, request);
        if (fields.findValue("surface"))
            if (const auto which = oneOf(fields, "surface", volumeSurfaceNames))
                request.surface = VolumeSurface(*which);
        readLength(fields, "cell", request.cell);
    }
    if (request.kind >= MeasureKind::Plane) readLength(fields, "within", request.within);
    if (request.kind == MeasureKind::Circle && fields.findValue("axis")) {
        glm::dvec3 axis(0);
        fields.vector("axis", axis);
        const double size = std::max({std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)});
        if (size > 0 && size <= farthestCoordinate)
            request.axis = axis / size;
        else
            fields.error("axis", "must be a direction, three numbers, not all 0");
    }
    readPoints(fields, request);
    if (!fields.failed()) checkCount(fields, request);
    if (auto ok = fields.finishStrict(); !ok) return passOn(ok);
    return request;
}

json toJson(const MeasureRequest& request) {
    json points = json::array();
    for (const glm::dvec3& point : request.points) points.push_back(jsonArray(point));
    json value{{"measure", name(request.kind)}, {"points", std::move(points)}};
    if (!request.isArithmetic() && !request.view.empty()) value["view"] = request.view;
    if (request.kind == MeasureKind::Volume) {
        if (request.base == VolumeBase::Height)
            value["base"] = request.height;
        else
            value["base"] = volumeBaseNames[std::size_t(request.base)];
        value["surface"] = volumeSurfaceNames[std::size_t(request.surface)];
        if (request.cell) value["cell"] = *request.cell;
    }
    if (request.within) value["within"] = *request.within;
    if (request.axis) value["axis"] = jsonArray(*request.axis);
    return value;
}

}  // namespace scancast
