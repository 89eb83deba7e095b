#include "server/commands/info_print.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "protocol/classification.hpp"
#include "protocol/text/grouped.hpp"
#include "renderer/cloud/import/crs_text.hpp"
#include "server/base/byte_size.hpp"

namespace scancast {

namespace {

using Json = nlohmann::ordered_json;

/// So many digits behind the point that a thousandth of the cloud's size is seen, at least millimetres of
/// metres.
int decimals(const glm::dvec3& size) {
    const double largest = std::max({size.x, size.y, size.z});
    return largest > 0 ? std::clamp(4 - int(std::floor(std::log10(largest))), 2, 9) : 3;
}

std::string number(double value, int digits) {
    std::string text = fmt::format("{:.{}f}", value, digits);
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
    return text == "-0" ? "0" : text;
}

std::string vector(const glm::dvec3& v, int digits, const char* between) {
    return fmt::format("{}{}{}{}{}", number(v.x, digits), between, number(v.y, digits), between,
                       number(v.z, digits));
}

class Lines {
  public:
    void add(std::string_view label, std::string_view text) {
        text_ += fmt::format("  {:<11} {}\n", label, text);
    }
    std::string text_;
};

void tellSize(const FileInfo& info, Lines& lines) {
    std::string points = info.points ? grouped(*info.points) : "not known until they are read (--check)";
    if (!info.octree && !info.checked && info.points) points += ", as the file declares";
    if (info.facts.droppedPoints > 0)
        points += fmt::format("; {} left out, without coordinates or marked as none",
                              grouped(info.facts.droppedPoints));
    lines.add("points", points);
    std::string size = byteSizeText(info.bytes);
    if (info.points && *info.points > 0 && info.bytes > 0)
        size += fmt::format(", {:.1f} bytes a point", double(info.bytes) / double(*info.points));
    // Of many objects in object storage, nobody says how large they are.
    if (info.bytes > 0) lines.add("size", size);
}

void tellPlace(const FileInfo& info, Lines& lines) {
    const CloudFacts& f = info.facts;
    const std::string unit = crsUnit(f.crsWkt, f.crsEpsg), crs = crsName(f.crsWkt, f.crsEpsg);
    if (info.boundsKnown) {
        const glm::dvec3 size = f.bounds[1] - f.bounds[0];
        const int digits = decimals(size);
        lines.add("extent", vector(size, digits, " x ") + (unit.empty() ? "" : ", unit of x and y: " + unit));
        lines.add("from", vector(f.bounds[0], digits, ", "));
        lines.add("to", vector(f.bounds[1], digits, ", "));
    }
    lines.add("CRS", crs.empty() ? "not known" : crs);
    if (info.gridStep.x > 0)
        lines.add("grid", "coordinates are multiples of " + vector(info.gridStep, 9, ", "));
    if (info.scannerOrigin && info.facts.stations.empty())
        lines.add("scanner", "stood at " + vector(*info.scannerOrigin, 4, ", "));
}

constexpr std::size_t stationsTold = 20, photosTold = 20;

void tellStations(const FileInfo& info, Lines& lines) {
    const auto& stations = info.facts.stations;
    std::string_view label = "scanner";
    for (std::size_t i = 0; i < std::min(stations.size(), stationsTold); ++i) {
        const Station& station = stations[i];
        const std::string points =
            info.octree || info.checked ? fmt::format(", {} points", grouped(station.points)) : "";
        lines.add(label, fmt::format("{}: stood at {}{}", titleOf(station, i),
                                     vector(station.position, 4, ", "), points));
        label = "";
    }
    if (stations.size() > stationsTold)
        lines.add("",
                  fmt::format("… and at {} places more; --json lists them", stations.size() - stationsTold));
}

/// Where a photo was taken, if that is one of the places that are listed.
const Station* stationOf(const CloudFacts& f, const Photo& photo) {
    return photo.station && *photo.station < f.stations.size() ? &f.stations[*photo.station] : nullptr;
}

void tellPhotos(const CloudFacts& f, Lines& lines) {
    std::string_view label = "photos";
    for (std::size_t i = 0; i < std::min(f.photos.size(), photosTold); ++i) {
        const Photo& photo = f.photos[i];
        std::string text =
            fmt::format("{}: {} {}", titleOf(photo, i), name(photo.projection), name(photo.format));
        if (photo.width > 0 && photo.height > 0)
            text += fmt::format(", {} x {} pixels", photo.width, photo.height);
        text += ", " + byteSizeText(photo.bytes);
        if (const Station* station = stationOf(f, photo)) text += ", at " + titleOf(*station, *photo.station);
        lines.add(label, text);
        label = "";
    }
    if (f.photos.size() > photosTold)
        lines.add("", fmt::format("… and {} photos more; --json lists them", f.photos.size() - photosTold));
}

std::string sidesOf(const CloudFacts& f) {
    if (f.sides) switch (f.sides->by) {
            case KnownSides::By::File:
                return "normals are the scan's own";
            case KnownSides::By::Scanner:
                return "normals point to the scanner";
            case KnownSides::By::Up:
                return "normals point upwards, as was asked for";
            case KnownSides::By::Neighbours:
                return fmt::format(
                    "{:.1f} % of the normals point to the side that was scanned, by their neighbours; the "
                    "rest to "
                    "either side",
                    100 * f.sides->sure);
        }
    return f.oriented ? "normals point to the side that was scanned" : "normals point to either side";
}

std::string usualCurvature(const CloudFacts& f) {
    if (!f.usual) return "yes";
    return fmt::format("yes, mean mostly {:.3g} to {:.3g}, 1 / unit", f.usual->curvature[0],
                       f.usual->curvature[1]);
}

void tellOctree(const FileInfo& info, Lines& lines) {
    if (!info.octree) return;
    const OctreeInfo& o = *info.octree;
    lines.add("octree", fmt::format("{} levels, {} nodes, {}{} samples ({:.2f} a point)", o.levels,
                                    grouped(o.nodes), info.writtenBy.empty() ? "about " : "",
                                    grouped(o.samples), double(o.samples) / double(*info.points)));
    lines.add("spacing", fmt::format("{:.3g} between neighbouring points", info.facts.spacing));
    if (info.facts.exact)
        lines.add("exact", "what samples round is kept beside them; \"scancast export\" gives it back");
    lines.add("surfels", info.facts.surfels ? "yes, " + sidesOf(info.facts) : "no");
    lines.add("curvature", hasCurvature(info.facts) ? usualCurvature(info.facts) : "no");
}

void tellLook(const CloudFacts& f, Lines& lines) {
    if (!f.look) return;
    lines.add("look", fmt::format("{}, first seen {}; \"scancast look\" tells all", name(f.look->kind),
                                  f.look->views.front().name));
    lines.add("", f.look->reason);
}

void tellStrange(const CloudFacts& f, Lines& lines) {
    CloudFacts strange;
    strange.constant = f.constant;
    strange.notes = f.notes;
    std::string_view label = "note";
    for (const std::string& remark : remarksOn(strange)) {
        lines.add(label, remark);
        label = "";
    }
}

void tellAttributes(const FileInfo& info, Lines& lines) {
    const CloudFacts& f = info.facts;
    std::vector<std::string> has;
    if (f.attributes.color) has.emplace_back("colour");
    if (f.attributes.intensity)
        has.push_back(info.octree || info.checked
                          ? fmt::format("intensity ({} to {})", f.intensityRange[0], f.intensityRange[1])
                          : "intensity");
    if (f.attributes.classification) has.emplace_back("classification");
    if (f.attributes.normal) has.emplace_back("normals");
    if (f.attributes.nearInfrared) has.emplace_back("near infrared");
    std::string list;
    for (const std::string& attribute : has) list += (list.empty() ? "" : ", ") + attribute;
    lines.add("attributes", has.empty() ? "none" : list);
    tellStrange(f, lines);
    if (f.attributes.classification && (info.octree || info.checked)) {
        std::string_view label = "classes";
        for (std::size_t c = 0; c < f.classCounts.size(); ++c) {
            if (f.classCounts[c] == 0) continue;
            lines.add(label, fmt::format("{:>3} {:<24} {:>15}  {:5.1f} %", c, className(std::uint8_t(c)),
                                         grouped(f.classCounts[c]),
                                         100.0 * double(f.classCounts[c]) / double(f.points)));
            label = "";
        }
    }
}

void tellColumns(const FileInfo& info, Lines& lines) {
    std::string_view label = info.octree ? "columns" : "also there";
    for (const KeptColumn& kept : info.facts.columns) {
        const Column& c = kept.column;
        std::string text = fmt::format("{}, {}", c.name, name(c.type));
        if (info.octree) text += fmt::format(", {} to {}", kept.range[0], kept.range[1]);
        if (!c.description.empty()) text += ": " + c.description;
        lines.add(label, text);
        label = "";
    }
    label = "mirrors";
    for (const Mirror& m : info.facts.mirrors) {
        lines.add(label, fmt::format("{:g} x {:g} at {}, facing {}", m.width, m.height,
                                     vector(m.center, 3, ", "), vector(m.normal, 3, ", ")));
        label = "";
    }
}

void tellCheck(const FileInfo& info, Lines& lines) {
    if (!info.checked) return;
    if (!info.octree) return lines.add("checked", "read to its end, sound");
    if (info.damaged.empty()) return lines.add("checked", "every block is sound");
    lines.add("checked", fmt::format("{} damaged {}; the rest can be looked at", grouped(info.damaged.size()),
                                     info.damaged.size() == 1 ? "block" : "blocks"));
    for (const DamagedBlock& block : info.damaged) lines.add("", block.message);
}

Json vectorJson(const glm::dvec3& v) {
    return Json::array({v.x, v.y, v.z});
}

Json textOrNull(const std::string& text) {
    return text.empty() ? Json() : Json(text);
}

Json crsJson(const CloudFacts& f) {
    const std::string crs = crsName(f.crsWkt, f.crsEpsg);
    if (crs.empty() && f.crsWkt.empty()) return {};
    return {{"name", textOrNull(crs)},
            {"epsg", f.crsEpsg ? Json(*f.crsEpsg) : Json()},
            {"unit", textOrNull(crsUnit(f.crsWkt, f.crsEpsg))},
            {"wkt", textOrNull(f.crsWkt)}};
}

Json classesJson(const CloudFacts& f) {
    Json classes = Json::array();
    for (std::size_t c = 0; c < f.classCounts.size(); ++c)
        if (f.classCounts[c] > 0)
            classes.push_back(
                {{"class", c}, {"name", className(std::uint8_t(c))}, {"points", f.classCounts[c]}});
    return classes;
}

Json columnsJson(const FileInfo& info) {
    Json columns = Json::array();
    for (const KeptColumn& kept : info.facts.columns) {
        const Column& c = kept.column;
        Json column{{"name", c.name},
                    {"type", name(c.type)},
                    {"scale", c.scale},
                    {"offset", c.offset},
                    {"description", c.description}};
        column["range"] = info.octree ? Json(kept.range) : Json();
        columns.push_back(std::move(column));
    }
    return columns;
}

Json stationsJson(const CloudFacts& f) {
    Json list = Json::array();
    for (std::size_t i = 0; i < f.stations.size(); ++i) {
        const Station& station = f.stations[i];
        list.push_back({{"name", titleOf(station, i)},
                        {"position", vectorJson(station.position)},
                        {"points", station.points},
                        {"forwards", station.forwards ? vectorJson(*station.forwards) : Json()}});
    }
    return list;
}

Json photosJson(const CloudFacts& f) {
    const auto orNull = [](auto number) { return number > 0 ? Json(number) : Json(); };
    Json list = Json::array();
    for (std::size_t i = 0; i < f.photos.size(); ++i) {
        const Photo& photo = f.photos[i];
        const Station* const station = stationOf(f, photo);
        Json json{{"name", titleOf(photo, i)},
                  {"format", name(photo.format)},
                  {"projection", name(photo.projection)},
                  {"width", orNull(photo.width)},
                  {"height", orNull(photo.height)},
                  {"bytes", photo.bytes},
                  {"anglesAcrossAndDown", Json::array({orNull(glm::degrees(photo.angles[0])),
                                                       orNull(glm::degrees(photo.angles[1]))})},
                  {"station", station != nullptr ? Json(*photo.station) : Json()},
                  {"stationName", station != nullptr ? Json(titleOf(*station, *photo.station)) : Json()},
                  {"pose", Json()}};
        if (photo.pose)
            json["pose"] = {{"position", vectorJson(photo.pose->position)},
                            {"forwards", vectorJson(photo.pose->forwards)},
                            {"up", vectorJson(photo.pose->up)}};
        list.push_back(std::move(json));
    }
    return list;
}

Json mirrorsJson(const CloudFacts& f) {
    Json mirrors = Json::array();
    for (const Mirror& m : f.mirrors)
        mirrors.push_back({{"center", vectorJson(m.center)},
                           {"normal", vectorJson(m.normal)},
                           {"up", vectorJson(m.up)},
                           {"width", m.width},
                           {"height", m.height},
                           {"tint", m.tint}});
    return mirrors;
}

Json infoOfConstants(const ConstantValues& constant) {
    return {{"color", constant.color ? Json(*constant.color) : Json()},
            {"intensity", constant.intensity ? Json(*constant.intensity) : Json()}};
}

Json octreeJson(const FileInfo& info) {
    if (!info.octree) return {};
    const OctreeInfo& o = *info.octree;
    return {{"levels", o.levels},
            {"nodes", o.nodes},
            {"leaves", o.leaves},
            {"samples", o.samples},
            {"spacing", info.facts.spacing},
            {"surfels", info.facts.surfels},
            {"curvature", hasCurvature(info.facts)},
            {"oriented", info.facts.oriented},
            {"sureOfSides", info.facts.sides      ? info.facts.sides->sure
                            : info.facts.oriented ? 1.0
                                                  : 0.0},
            {"exact", info.facts.exact},
            {"revision", info.facts.revision},
            {"writtenBy", info.writtenBy}};
}

Json checkJson(const FileInfo& info) {
    if (!info.checked) return {};
    Json damaged = Json::array();
    for (const DamagedBlock& block : info.damaged)
        damaged.push_back({{"node", block.node ? Json(*block.node) : Json()},
                           {"photo", block.photo ? Json(*block.photo) : Json()},
                           {"offset", block.offset},
                           {"message", block.message}});
    return {{"sound", info.damaged.empty()}, {"damaged", damaged}};
}

}  // namespace

std::string infoText(const FileInfo& info) {
    Lines lines;
    lines.text_ = info.file.string() + "\n";
    if (info.octree) {
        lines.add("what",
                  info.writtenBy.empty() ? "scan that is shown as it is" : "cloud file by " + info.writtenBy);
        lines.add("title", info.facts.title);
        if (!info.facts.attribution.empty()) lines.add("attribution", info.facts.attribution);
        if (!info.facts.recorded.empty()) lines.add("recorded", info.facts.recorded);
        lines.add("made of", info.facts.format);
    } else {
        lines.add("what", "scan, " + info.facts.format);
    }
    tellSize(info, lines);
    tellPlace(info, lines);
    tellStations(info, lines);
    tellPhotos(info.facts, lines);
    tellOctree(info, lines);
    tellAttributes(info, lines);
    tellColumns(info, lines);
    tellLook(info.facts, lines);
    tellCheck(info, lines);
    return lines.text_;
}

Json infoJson(const FileInfo& info) {
    const CloudFacts& f = info.facts;
    const bool counted = info.octree || info.checked;
    Json json{{"file", info.file.string()}, {"kind", info.octree ? "cloud" : "scan"}, {"bytes", info.bytes}};
    json["title"] = f.title;
    if (!f.attribution.empty()) json["attribution"] = f.attribution;
    if (!f.recorded.empty()) json["recorded"] = f.recorded;
    json["format"] = f.format;
    json["points"] = info.points ? Json(*info.points) : Json();
    json["droppedPoints"] = counted ? Json(f.droppedPoints) : Json();
    json["bounds"] =
        info.boundsKnown ? Json::array({vectorJson(f.bounds[0]), vectorJson(f.bounds[1])}) : Json();
    json["crs"] = crsJson(f);
    json["attributes"] = {{"color", f.attributes.color},
                          {"intensity", f.attributes.intensity},
                          {"classification", f.attributes.classification},
                          {"normal", f.attributes.normal},
                          {"nearInfrared", f.attributes.nearInfrared}};
    json["constant"] = infoOfConstants(f.constant);
    json["notes"] = f.notes;
    json["intensityRange"] = f.attributes.intensity && counted ? Json(f.intensityRange) : Json();
    json["classes"] = f.attributes.classification && counted ? classesJson(f) : Json();
    json["columns"] = columnsJson(info);
    json["mirrors"] = mirrorsJson(f);
    json["gridStep"] = info.gridStep.x > 0 ? vectorJson(info.gridStep) : Json();
    json["scannerOrigin"] = info.scannerOrigin ? vectorJson(*info.scannerOrigin) : Json();
    json["stations"] = stationsJson(f);
    json["photos"] = photosJson(f);
    json["octree"] = octreeJson(info);
    json["look"] = f.look ? Json(toJson(*f.look)) : Json();
    json["check"] = checkJson(info);
    return json;
}

}  // namespace scancast
