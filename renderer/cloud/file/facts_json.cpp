#include "renderer/cloud/file/facts_json.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "protocol/json_text.hpp"
#include "renderer/cloud/file/facts_fields.hpp"
#include "renderer/cloud/file/facts_stations.hpp"

namespace scancast {

namespace {

using Json = nlohmann::json;

constexpr std::size_t mostColumns = 1024, mostRowBytes = 65536, mostMirrors = 1024;
constexpr std::size_t mostCompanions = 64;
constexpr std::string_view ofPoints = "points", ofSamples = "samples";
constexpr std::size_t longestNote = 2048;
constexpr ColumnType lastColumnType = ColumnType::Float64;

/// A column without a single number has no range; that must not make hours of work unreadable.
Json rangeJson(const std::array<double, 2>& range) {
    if (std::isfinite(range[0]) && std::isfinite(range[1]) && range[0] <= range[1]) return range;
    return Json::array({0.0, 0.0});
}

Json histogramJson(const ValueHistogram& histogram) {
    return {{"low", histogram.low}, {"high", histogram.high}, {"counts", histogram.counts}};
}

Json columnJson(const KeptColumn& kept) {
    const Column& c = kept.column;
    Json json{{"name", c.name},     {"type", name(c.type)},         {"scale", c.scale},
              {"offset", c.offset}, {"description", c.description}, {"range", rangeJson(kept.range)}};
    if (kept.usual) json["usual"] = rangeJson(*kept.usual);
    if (kept.histogram) json["histogram"] = histogramJson(*kept.histogram);
    return json;
}

Json planeJson(const ValuePlane& plane) {
    return {{"name", plane.name},
            {"type", name(plane.type)},
            {"of", plane.of == ValuePlane::Of::Points ? ofPoints : ofSamples}};
}

Json mirrorJson(const Mirror& m) {
    return {{"center", vectorJson(m.center)},
            {"normal", vectorJson(m.normal)},
            {"up", vectorJson(m.up)},
            {"width", m.width},
            {"height", m.height},
            {"tint", m.tint}};
}

/// Only what is there: most clouds have neither constant attributes nor notes nor values beside the samples.
struct SidesName {
    KnownSides::By by;
    std::string_view name;
};
constexpr std::array sidesNames{
    SidesName{KnownSides::By::File, "file"}, SidesName{KnownSides::By::Scanner, "scanner"},
    SidesName{KnownSides::By::Up, "up"}, SidesName{KnownSides::By::Neighbours, "neighbours"}};

std::string_view nameOf(KnownSides::By by) {
    return sidesNames[std::size_t(by)].name;
}

void addRare(const CloudFacts& f, Json& json) {
    if (f.crsEpsg) json["crsEpsg"] = *f.crsEpsg;
    if (f.grid) json["grid"] = {{"origin", vectorJson(f.grid->origin)}, {"step", vectorJson(f.grid->step)}};
    if (f.exact) json["exact"] = true;
    if (f.constant.color) json["constant"]["color"] = *f.constant.color;
    if (f.constant.intensity) json["constant"]["intensity"] = *f.constant.intensity;
    if (!f.notes.empty()) json["notes"] = f.notes;
    if (f.usual)
        json["usual"] = {{"position", {vectorJson(f.usual->position[0]), vectorJson(f.usual->position[1])}},
                         {"intensity", f.usual->intensity},
                         {"brightness", f.usual->brightness}};
    if (f.usual && hasCurvature(f)) json["usual"]["curvature"] = f.usual->curvature;
    if (f.intensityHistogram) json["intensityHistogram"] = histogramJson(*f.intensityHistogram);
    if (f.scanner) json["scanner"] = vectorJson(*f.scanner);
    if (f.sides) json["sides"] = {{"by", std::string(nameOf(f.sides->by))}, {"sure", f.sides->sure}};
    if (f.look) json["look"] = toJson(*f.look);
    if (!f.attribution.empty()) json["attribution"] = f.attribution;
    if (!f.recorded.empty()) json["recorded"] = f.recorded;
    for (const ValuePlane& plane : planesOf(f)) json["planes"].push_back(planeJson(plane));
}

Json factsJson(const CloudFacts& f, std::string_view writtenBy, std::span<const BlockPlace> photos) {
    Json classes = Json::object();
    for (std::size_t c = 0; c < f.classCounts.size(); ++c)
        if (f.classCounts[c] > 0) classes[std::to_string(c)] = f.classCounts[c];
    Json columns = Json::array(), mirrors = Json::array();
    for (const KeptColumn& column : f.columns) columns.push_back(columnJson(column));
    for (const Mirror& mirror : f.mirrors) mirrors.push_back(mirrorJson(mirror));
    Json json{{"writtenBy", writtenBy},
              {"title", f.title},
              {"format", f.format},
              {"origin", vectorJson(f.origin)},
              {"bounds", {vectorJson(f.bounds[0]), vectorJson(f.bounds[1])}},
              {"points", f.points},
              {"droppedPoints", f.droppedPoints},
              {"attributes",
               {{"color", f.attributes.color},
                {"intensity", f.attributes.intensity},
                {"classification", f.attributes.classification},
                {"normal", f.attributes.normal}}},
              {"intensityRange", f.intensityRange},
              {"classCounts", classes},
              {"crsWkt", f.crsWkt},
              {"spacing", f.spacing},
              {"surfels", f.surfels},
              {"oriented", f.oriented},
              {"columns", columns},
              {"mirrors", mirrors},
              {"revision", f.revision}};
    addRare(f, json);
    addStations(f, photos, json);
    return json;
}

void takeType(FactsFields& fields, ColumnType& into) {
    std::string type;
    fields.text("type", type);
    for (int t = 0; t <= int(lastColumnType); ++t)
        if (name(ColumnType(t)) == type) return void(into = ColumnType(t));
    fields.blame("type", "is none that there is");
}

void takeHistogram(FactsFields fields, ValueHistogram& into) {
    fields.number("low", into.low);
    fields.number("high", into.high);
    if (!(into.low < into.high)) fields.blame("high", "is not above \"low\"");
    const Json* counts = fields.list("counts", FactsFields::noSize, ValueHistogram::mostBins);
    if (!counts) return;
    if (counts->empty()) fields.blame("counts", "are none");
    for (const Json& count : *counts)
        fields.whole(count, "counts", into.counts.emplace_back(), std::numeric_limits<std::uint64_t>::max());
}

void takeColumn(FactsFields fields, KeptColumn& into) {
    fields.text("name", into.column.name);
    takeType(fields, into.column.type);
    fields.number("scale", into.column.scale);
    fields.number("offset", into.column.offset);
    fields.text("description", into.column.description);
    fields.range("range", into.range);
    if (fields.has("usual")) fields.range("usual", into.usual.emplace());
    if (fields.has("histogram"))
        takeHistogram({*fields.find("histogram"), fields.member("histogram"), fields.fault()},
                      into.histogram.emplace());
}

void takePlane(FactsFields fields, ValuePlane& into) {
    std::string of;
    fields.text("name", into.name);
    takeType(fields, into.type);
    fields.text("of", of);
    into.of = of == ofSamples ? ValuePlane::Of::Samples : ValuePlane::Of::Points;
    if (of != ofPoints && of != ofSamples) fields.blame("of", "is neither \"points\" nor \"samples\"");
    if (into.name.empty()) fields.blame("name", "is empty");
}

void takeMirror(FactsFields fields, Mirror& into) {
    fields.vector("center", into.center);
    fields.unitVector("normal", into.normal);
    fields.unitVector("up", into.up);
    fields.number("width", into.width);
    fields.number("height", into.height);
    fields.wholes("tint", into.tint);
    if (!(into.width > 0 && into.height > 0)) fields.blame("width", "or \"height\" is not positive");
}

void takeClassCounts(FactsFields& fields, std::array<std::uint64_t, 256>& into) {
    const Json* classes = fields.find("classCounts");
    if (!classes) return;
    if (!classes->is_object()) return fields.blame("classCounts", "is not an object");
    for (const auto& [key, count] : classes->items()) {
        unsigned number = 0;
        const auto [end, problem] = std::from_chars(key.data(), key.data() + key.size(), number);
        if (problem != std::errc() || end != key.data() + key.size() || number >= into.size())
            return fields.blame("classCounts", "names a class that there is not");
        fields.whole(count, "classCounts", into[number], std::numeric_limits<std::uint64_t>::max());
    }
}

void takeAttributes(FactsFields fields, Attributes& into) {
    fields.flag("color", into.color);
    fields.flag("intensity", into.intensity);
    fields.flag("classification", into.classification);
    fields.flag("normal", into.normal);
}

void takeGrid(FactsFields fields, ScanGrid& into) {
    fields.vector("origin", into.origin);
    fields.vector("step", into.step);
    if (!(into.step.x > 0 && into.step.y > 0 && into.step.z > 0)) fields.blame("step", "is not positive");
}

void takeConstant(FactsFields fields, ConstantValues& into) {
    if (fields.has("color")) fields.wholes("color", into.color.emplace());
    if (fields.has("intensity")) fields.whole("intensity", into.intensity.emplace());
}

void takeNotes(FactsFields& fields, std::vector<std::string>& into) {
    const Json* notes = fields.list("notes", FactsFields::noSize, mostCloudNotes);
    if (!notes) return;
    for (const Json& note : *notes) {
        if (!note.is_string() || note.get_ref<const std::string&>().size() > longestNote)
            return fields.blame("notes", "has one that is not a text, or too long a one");
        into.push_back(note.get<std::string>());
    }
}

void takeUsual(FactsFields fields, UsualRanges& into) {
    fields.bounds("position", into.position);
    fields.range("intensity", into.intensity);
    if (const Json* brightness = fields.list("brightness", into.brightness.size()))
        for (std::size_t i = 0; i < into.brightness.size(); ++i)
            fields.number((*brightness)[i], "brightness", into.brightness[i]);
    if (fields.has("curvature")) fields.range("curvature", into.curvature);
}

void takeSidesFact(FactsFields fields, KnownSides& into) {
    std::string by;
    fields.text("by", by);
    const auto found =
        std::find_if(sidesNames.begin(), sidesNames.end(), [&](const SidesName& n) { return n.name == by; });
    if (found == sidesNames.end()) return fields.blame("by", "is not known");
    into.by = found->by;
    fields.number("sure", into.sure);
    if (!(into.sure >= 0 && into.sure <= 1)) fields.blame("sure", "is not in 0 to 1");
}

void takeLook(FactsFields& fields, std::optional<Look>& into) {
    auto look = applyLook(Look{}, *fields.find("look"));
    if (look)
        if (auto ok = validate(*look); !ok) look = passOn(ok);
    if (!look) return fields.blame("look", fmt::format("is none: {}", look.error().message));
    into = std::move(*look);
}

/// What few clouds have, and older files never.
void takeRare(FactsFields& fields, CloudFacts& facts) {
    if (fields.has("crsEpsg"))
        fields.whole("crsEpsg", facts.crsEpsg.emplace(), std::numeric_limits<int>::max());
    if (fields.has("grid"))
        takeGrid({*fields.find("grid"), fields.member("grid"), fields.fault()}, facts.grid.emplace());
    if (fields.has("exact")) fields.flag("exact", facts.exact);
    if (fields.has("constant"))
        takeConstant({*fields.find("constant"), fields.member("constant"), fields.fault()}, facts.constant);
    if (fields.has("notes")) takeNotes(fields, facts.notes);
    if (fields.has("attribution")) fields.text("attribution", facts.attribution, longestAttribution);
    if (fields.has("recorded")) fields.text("recorded", facts.recorded);
    if (const auto date = checkRecorded(facts.recorded); !date) fields.blame("recorded", "is no date");
    if (fields.has("usual"))
        takeUsual({*fields.find("usual"), fields.member("usual"), fields.fault()}, facts.usual.emplace());
    if (fields.has("intensityHistogram"))
        takeHistogram(
            {*fields.find("intensityHistogram"), fields.member("intensityHistogram"), fields.fault()},
            facts.intensityHistogram.emplace());
    if (fields.has("scanner")) fields.vector("scanner", facts.scanner.emplace());
    takeStations(fields, facts);
    if (fields.has("sides"))
        takeSidesFact({*fields.find("sides"), fields.member("sides"), fields.fault()}, facts.sides.emplace());
    if (fields.has("look")) takeLook(fields, facts.look);
}

void takeLists(FactsFields& fields, CloudFacts& facts) {
    if (const Json* columns = fields.list("columns", FactsFields::noSize, mostColumns)) {
        std::size_t bytes = 0;
        for (const Json& column : *columns) {
            takeColumn({column, fields.member("columns"), fields.fault()}, facts.columns.emplace_back());
            bytes += bytesOf(facts.columns.back().column.type);
        }
        if (bytes > mostRowBytes) fields.blame("columns", "are too many");
    }
    if (const Json* mirrors = fields.list("mirrors", FactsFields::noSize, mostMirrors))
        for (const Json& mirror : *mirrors)
            takeMirror({mirror, fields.member("mirrors"), fields.fault()}, facts.mirrors.emplace_back());
}

/// Behind the columns, each of which must be there again. A companion is found by its name.
void takePlanes(FactsFields& fields, CloudFacts& facts) {
    if (facts.columns.empty() && !fields.has("planes")) return;
    const Json* planes = fields.list("planes", FactsFields::noSize, facts.columns.size() + mostCompanions);
    if (!planes) return;
    std::vector<ValuePlane> all(planes->size());
    for (std::size_t i = 0; i < all.size(); ++i)
        takePlane({(*planes)[i], fields.member("planes"), fields.fault()}, all[i]);
    const std::vector<ValuePlane> columns = planesOf(facts);
    if (all.size() < columns.size() || !std::equal(columns.begin(), columns.end(), all.begin()))
        return fields.blame("planes", "do not begin with the columns");
    facts.companions.assign(all.begin() + std::ptrdiff_t(columns.size()), all.end());
    std::set<std::string_view> names;
    for (const ValuePlane& plane : facts.companions)
        if (!names.insert(plane.name).second) fields.blame("planes", "have a name twice");
}

void takeAll(FactsFields fields, StoredFacts& into, std::uint32_t version) {
    CloudFacts& f = into.facts;
    fields.text("writtenBy", into.writtenBy);
    fields.text("title", f.title);
    fields.text("format", f.format);
    fields.vector("origin", f.origin);
    fields.bounds("bounds", f.bounds);
    fields.whole("points", f.points);
    fields.whole("droppedPoints", f.droppedPoints);
    if (const Json* attributes = fields.find("attributes"))
        takeAttributes({*attributes, fields.member("attributes"), fields.fault()}, f.attributes);
    fields.wholes("intensityRange", f.intensityRange);
    takeClassCounts(fields, f.classCounts);
    fields.text("crsWkt", f.crsWkt, longestFacts);
    takeRare(fields, f);
    fields.number("spacing", f.spacing);
    if (!(f.spacing >= 0)) fields.blame("spacing", "is negative");
    fields.flag("surfels", f.surfels);
    fields.flag("oriented", f.oriented);
    takeLists(fields, f);
    if (version != 1) {
        takePlanes(fields, f);
        takePhotos(fields, f, into.photos);
    }
    f.attributes.nearInfrared = hasNearInfrared(f);
    fields.text("revision", f.revision);
}

}  // namespace

std::string_view programName() {
    return "scancast " SCANCAST_VERSION;
}

Expected<std::string> printFacts(const CloudFacts& facts, std::string_view writtenBy,
                                 std::span<const BlockPlace> photos) {
    if (photos.size() != facts.photos.size())
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("the cloud has {} photos, of which {} are somewhere", facts.photos.size(),
                                photos.size()));
    std::string json = printJson(factsJson(facts, writtenBy, photos));
    if (json.size() > longestFacts)
        return fail(ErrorCode::InvalidArgument, "the cloud's description is too long for a cloud file");
    if (const auto readable = parseFacts(json); !readable)
        return fail(ErrorCode::InvalidArgument, "the cloud cannot be described: " + readable.error().message);
    return json;
}

Expected<StoredFacts> parseFacts(std::string_view json, std::uint32_t version) {
    auto parsed = parseJson(json);
    if (!parsed) return passOn(parsed);
    struct Dismantled {
        nlohmann::json& value;
        ~Dismantled() { dismantle(value); }
    } const dismantled{*parsed};
    StoredFacts facts;
    std::string fault;
    takeAll({*parsed, "", fault}, facts, version);
    if (!fault.empty()) return fail(ErrorCode::Malformed, fault);
    return facts;
}

}  // namespace scancast
