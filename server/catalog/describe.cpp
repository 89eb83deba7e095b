#include "server/catalog/describe.hpp"

#include <fmt/format.h>

#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "protocol/classification.hpp"
#include "protocol/view/view_json.hpp"
#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/image/colormap.hpp"
#include "renderer/render.hpp"
#include "renderer/residency/pictured_octree.hpp"
#include "renderer/station_view.hpp"
#include "server/catalog/describe_point.hpp"

namespace scancast {
namespace {

std::vector<AttributeInfo> attributesOf(const Cloud& cloud) {
    std::vector<AttributeInfo> list;
    if (cloud.attributes.color) list.push_back({"rgb", std::nullopt});
    if (hasNearInfrared(cloud)) list.push_back({"cir", std::nullopt});
    if (cloud.attributes.intensity) {
        list.push_back({"intensity", std::array<double, 2>{double(cloud.intensityRange[0]),
                                                           double(cloud.intensityRange[1])}});
    }
    if (cloud.attributes.classification) list.push_back({"classification", std::nullopt});
    if (cloud.attributes.normal) list.push_back({"normal", std::nullopt});
    if (hasCurvature(cloud)) list.push_back({"curvature", std::nullopt});
    return list;
}

/// {"rgb": [0, 0, 0], "intensity": 65535}: what all points have alike.
nlohmann::json constantJson(const ConstantValues& constant) {
    nlohmann::json json = nlohmann::json::object();
    if (constant.color) json["rgb"] = *constant.color;
    if (constant.intensity) json["intensity"] = *constant.intensity;
    return json;
}

std::string_view name(Parameter::Type type) {
    switch (type) {
        case Parameter::Type::Number:
            return "number";
        case Parameter::Type::Boolean:
            return "boolean";
        case Parameter::Type::Choice:
            return "choice";
    }
    return "number";
}

nlohmann::json liveJson(const LiveStatus& live) {
    nlohmann::json json{{"state", name(live.state)},
                        {"shown", live.shown},
                        {"skipped", live.skipped},
                        {"failed", live.failed}};
    if (!live.error.empty()) json["error"] = live.error;
    return json;
}

nlohmann::json pendingJson(const CatalogEntry& entry) {
    nlohmann::json json{{"id", entry.id}, {"title", entry.title}, {"state", name(entry.state)}};
    if (!entry.stage.empty()) json["stage"] = entry.stage;
    if (entry.progress) json["progress"] = *entry.progress;
    if (!entry.error.empty()) json["error"] = entry.error;
    if (entry.live) json["live"] = liveJson(*entry.live);
    return json;
}

std::string hexText(const Rgb8& color) {
    return fmt::format("#{:02x}{:02x}{:02x}", color[0], color[1], color[2]);
}

/// Of the classes that occur: {"2": "ground", …}, and in the same way how many points they have, and in which colour
/// they are drawn.
void tellClasses(const Cloud& cloud, nlohmann::json& json) {
    for (const char* key : {"classNames", "classCounts", "classColors"}) json[key] = nlohmann::json::object();
    if (!cloud.attributes.classification) return;
    for (std::size_t c = 0; c < cloud.classCounts.size(); ++c) {
        if (cloud.classCounts[c] == 0) continue;
        const std::string number = std::to_string(c);
        json["classNames"][number] = className(std::uint8_t(c));
        json["classCounts"][number] = cloud.classCounts[c];
        json["classColors"][number] = hexText(classificationColors()[c]);
    }
}

/// Colours at even steps along a ramp, the first and the last among them.
nlohmann::json rampJson(const Ramp& ramp) {
    constexpr std::size_t step = 15;  // 18 of 256: no eye sees more of them in a legend
    nlohmann::json colors = nlohmann::json::array();
    for (std::size_t i = 0; i < ramp.size(); i += step) colors.push_back(hexText(ramp[i]));
    return colors;
}

/// {"viridis": ["#440154", …], …}: of every colour map, and of what has its own; of lod, by level.
nlohmann::json rampsJson() {
    nlohmann::json ramps = nlohmann::json::object();
    for (const std::string_view map : colormapNames) ramps[std::string(map)] = rampJson(*colormap(map));
    ramps["curvature"] = rampJson(curvatureColors());
    for (std::size_t level = 0; level < levelCycle; ++level)
        ramps["lod"].push_back(hexText(levelColors()[level]));
    return ramps;
}

ColumnInfo columnInfo(const KeptColumn& kept, bool isDrawn) {
    ColumnInfo info{kept.column.name,
                    std::string(name(kept.column.type)),
                    kept.column.description,
                    kept.range,
                    isDrawn,
                    kept.usual,
                    {}};
    if (const auto& h = kept.histogram) info.histogram = HistogramInfo{h->low, h->high, h->counts};
    return info;
}

/// What is kept of the points, and intensity, which is asked for in the same way.
std::vector<ColumnInfo> columnsOf(const Cloud& cloud) {
    std::vector<ColumnInfo> list;
    const auto choosable = choosableColumns(cloud);
    bool hasIntensity = false;
    for (std::size_t c = 0; c < cloud.columns.size(); ++c) {
        const Column& column = cloud.columns[c].column;
        const bool isChoosable = std::ranges::find(choosable, c) != choosable.end();
        list.push_back(
            columnInfo(cloud.columns[c], isChoosable && isDrawn(cloud, column, hasInnerNodes(cloud.octree))));
        hasIntensity = hasIntensity || column.name == intensityName;
    }
    if (!cloud.attributes.intensity || hasIntensity) return list;
    KeptColumn intensity;
    intensity.column.name = intensityName;
    intensity.column.type = ColumnType::Uint16;
    intensity.range = {double(cloud.intensityRange[0]), double(cloud.intensityRange[1])};
    if (cloud.usual) intensity.usual = cloud.usual->intensity;
    intensity.histogram = cloud.intensityHistogram;
    list.push_back(columnInfo(intensity, true));
    return list;
}

nlohmann::json numbers(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

/// The index of the station that a photo was taken at, where there is that one in the list.
std::optional<std::uint32_t> stationOf(const Cloud& cloud, const Photo& photo) {
    return photo.station && *photo.station < cloud.stations.size() ? photo.station : std::nullopt;
}

}  // namespace

CloudInfo describe(const std::string& id, const Cloud& cloud) {
    CloudInfo info;
    info.id = id;
    info.title = cloud.title;
    info.attribution = cloud.attribution;
    info.recorded = cloud.recorded;
    info.format = cloud.format;
    info.revision = pictureRevision(cloud);
    info.points = cloud.points;
    info.droppedPoints = cloud.droppedPoints;
    info.bounds = cloud.bounds;
    info.origin = cloud.origin;
    info.spacing = cloud.spacing;
    info.surfels = cloud.surfels;
    info.attributes = attributesOf(cloud);
    if (cloud.attributes.classification) {
        for (std::size_t c = 0; c < cloud.classCounts.size(); ++c) {
            if (cloud.classCounts[c] > 0) info.classes.push_back(std::uint8_t(c));
        }
    }
    info.crsWkt = cloud.crsWkt;
    info.crsEpsg = cloud.crsEpsg;
    for (const Mirror& mirror : cloud.mirrors) {
        info.mirrors.push_back(
            {mirror.center, mirror.normal, mirror.up, mirror.width, mirror.height, mirror.tint});
    }
    info.columns = columnsOf(cloud);
    info.bytesResident = cloud.octree.bytesResident();
    info.view = defaultView(cloud);
    info.look = cloud.look;
    return info;
}

MethodInfo describe(const Method& method) {
    MethodInfo info;
    info.name = method.name;
    info.title = method.title;
    info.summary = method.summary;
    info.source = method.source;
    if (method.needs == Needs::Surfels) info.needs.push_back("surfels");
    info.defaultDetail = method.defaultDetail;
    info.defaultShading = method.defaultShading;
    for (const Parameter& parameter : method.parameters) {
        info.parameters.push_back({parameter.name, std::string(name(parameter.type)), parameter.defaultValue,
                                   parameter.min, parameter.max, parameter.choices, parameter.unit,
                                   parameter.meaning});
    }
    return info;
}

nlohmann::json cloudJson(const CatalogEntry& entry) {
    if (!entry.cloud) return pendingJson(entry);
    nlohmann::json json = toJson(describe(entry.id, *entry.cloud));
    json.update(pendingJson(entry));
    if (!entry.titled) json["title"] = entry.cloud->title;
    json["constant"] = constantJson(entry.cloud->constant);
    json["notes"] = entry.cloud->notes;
    json["stations"] = entry.cloud->stations.size();
    json["photos"] = entry.cloud->photos.size();
    tellClasses(*entry.cloud, json);
    json["crsName"] = crsName(entry.cloud->crsWkt, entry.cloud->crsEpsg);
    json["crs"] = crsJson(*entry.cloud);
    json["crsUnit"] = crsUnit(entry.cloud->crsWkt, entry.cloud->crsEpsg);
    return json;
}

nlohmann::json cloudListJson(const std::vector<CatalogEntry>& entries) {
    nlohmann::json ready = nlohmann::json::array();
    nlohmann::json pending = nlohmann::json::array();
    for (const CatalogEntry& entry : entries) (entry.cloud ? ready : pending).push_back(cloudJson(entry));
    return {{"clouds", std::move(ready)}, {"pending", std::move(pending)}};
}

nlohmann::json viewsJson(const Cloud& cloud, View base) {
    nlohmann::json list = nlohmann::json::array();
    for (const LookView& named : viewsOf(cloud, double(base.width) / base.height)) {
        base.camera = named.camera;
        list.push_back({{"name", named.name}, {"inside", named.inside}, {"view", toJson(base)}});
    }
    return {{"views", std::move(list)}};
}

nlohmann::json stationsJson(const Cloud& cloud, View base) {
    nlohmann::json list = nlohmann::json::array();
    for (std::size_t i = 0; i < cloud.stations.size(); ++i) {
        const Station& station = cloud.stations[i];
        base.camera = stationCamera(cloud, station);
        list.push_back({{"name", titleOf(station, i)},
                        {"position", numbers(station.position)},
                        {"points", station.points},
                        {"photos", nlohmann::json::array()},
                        {"view", toJson(base)}});
        if (station.forwards) list.back()["forwards"] = numbers(*station.forwards);
    }
    for (std::size_t i = 0; i < cloud.photos.size(); ++i)
        if (const auto at = stationOf(cloud, cloud.photos[i])) list[*at]["photos"].push_back(i);
    return {{"stations", std::move(list)}};
}

nlohmann::json photosJson(const std::string& id, const Cloud& cloud, const View& base) {
    nlohmann::json list = nlohmann::json::array();
    for (std::size_t i = 0; i < cloud.photos.size(); ++i) {
        const Photo& photo = cloud.photos[i];
        nlohmann::json json{{"index", i},
                            {"name", titleOf(photo, i)},
                            {"mediaType", mediaType(photo.format)},
                            {"projection", name(photo.projection)},
                            {"bytes", photo.bytes},
                            {"href", "/api/v1/clouds/" + id + "/photos/" + std::to_string(i)}};
        if (photo.width > 0 && photo.height > 0)
            json.update({{"width", photo.width}, {"height", photo.height}});
        if (photo.angles[0] > 0) json["angles"]["across"] = glm::degrees(photo.angles[0]);
        if (photo.angles[1] > 0) json["angles"]["down"] = glm::degrees(photo.angles[1]);
        if (const auto at = stationOf(cloud, photo))
            json["station"] = {{"index", *at}, {"name", titleOf(cloud.stations[*at], *at)}};
        if (photo.pose)
            json["pose"] = {{"position", numbers(photo.pose->position)},
                            {"forwards", numbers(photo.pose->forwards)},
                            {"up", numbers(photo.pose->up)}};
        if (const auto camera = photoCamera(cloud, photo, double(base.width) / base.height)) {
            View from = base;
            from.camera = *camera;
            json["view"] = toJson(from);
        }
        list.push_back(std::move(json));
    }
    return {{"photos", std::move(list)}};
}

/// All that `color` may say but one colour for everything, as menus have it: auto, products, sources.
nlohmann::json colorNames() {
    std::vector<std::string> names(colorSourceNames.begin(), colorSourceNames.end());
    auto at = names.begin() + 1;
    for (std::size_t i = 0; i < colorSourceNames.size(); ++i) {
        Style style;
        style.color = static_cast<ColorSource>(i);
        style.byIntensity = true;
        if (takesIntensity(style.color)) at = names.insert(at, colorWord(style)) + 1;
    }
    return names;
}

nlohmann::json methodListJson() {
    std::vector<MethodInfo> list;
    for (const Method& method : methods()) list.push_back(describe(method));
    nlohmann::json json = toJson(list);
    // Colour sources and maps belong to no method; clients build their menus from one answer.
    json["colors"] = colorNames();
    json["colormaps"] = colormapNames;
    json["shadings"] = shadingNames;
    json["ramps"] = rampsJson();
    return json;
}

}  // namespace scancast
