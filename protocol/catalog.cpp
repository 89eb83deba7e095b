#include "protocol/catalog.hpp"

#include <nlohmann/json.hpp>

#include "protocol/json_fields.hpp"
#include "protocol/view/view_json.hpp"
#include "protocol/view/view_values.hpp"

namespace scancast {
namespace {

using nlohmann::json;

constexpr std::size_t longestText = 64 * 1024;  // a CRS in well-known text can be long
constexpr std::size_t mostEntries = 100'000;

json toJson(const AttributeInfo& attribute) {
    json object = {{"name", attribute.name}};
    if (attribute.range) object["range"] = *attribute.range;
    return object;
}

json toJson(const ColumnInfo& column) {
    json object{
        {"name", column.name}, {"type", column.type}, {"range", column.range}, {"drawn", column.drawn}};
    if (!column.description.empty()) object["description"] = column.description;
    if (column.usual) object["usual"] = *column.usual;
    if (const auto& h = column.histogram)
        object["histogram"] = {{"low", h->low}, {"high", h->high}, {"counts", h->counts}};
    return object;
}

json toJson(const MirrorInfo& mirror) {
    return {{"center", jsonArray(mirror.center)},
            {"normal", jsonArray(mirror.normal)},
            {"up", jsonArray(mirror.up)},
            {"width", mirror.width},
            {"height", mirror.height},
            {"tint", values::print(mirror.tint)}};
}

json toJson(const ParameterInfo& parameter) {
    json object = {{"name", parameter.name}, {"type", parameter.type}, {"meaning", parameter.meaning}};
    std::visit([&](const auto& value) { object["default"] = value; }, parameter.defaultValue);
    if (parameter.type == "number") object["min"] = parameter.min, object["max"] = parameter.max;
    if (!parameter.choices.empty()) object["choices"] = parameter.choices;
    if (!parameter.unit.empty()) object["unit"] = parameter.unit;
    return object;
}

template <class T>
json listToJson(const std::vector<T>& entries) {
    json list = json::array();
    for (const auto& entry : entries) list.push_back(toJson(entry));
    return list;
}

/// Calls `use(reader, out)` for each object of an array field.
template <class T, class Use>
void readList(FieldReader& fields, std::string_view key, std::vector<T>& out, Use use) {
    const auto* list = fields.findValue(key);
    if (!list) return;
    if (!list->is_array() || list->size() > mostEntries) return fields.error(key, "expected an array");
    for (std::size_t i = 0; i < list->size(); ++i) {
        FieldReader entry((*list)[i], fields.path(key) + "[" + std::to_string(i) + "]", ErrorCode::Malformed);
        use(entry, out.emplace_back());
        if (auto sound = entry.finishLenient(); !sound) fields.error(sound.error());
    }
}

void readTexts(FieldReader& fields, std::string_view key, std::vector<std::string>& out) {
    const auto* list = fields.findValue(key);
    if (!list) return;
    if (!list->is_array() || list->size() > mostEntries)
        return fields.error(key, "expected an array of strings");
    for (const auto& item : *list) {
        if (!item.is_string()) return fields.error(key, "expected an array of strings");
        out.push_back(item.get<std::string>());
    }
}

void readClasses(FieldReader& fields, std::vector<std::uint8_t>& out) {
    const auto* list = fields.findValue("classes");
    if (!list) return;
    if (!list->is_array() || list->size() > 256)
        return fields.error("classes", "expected an array of class numbers");
    for (const auto& item : *list) {
        if (!item.is_number_integer() || item < 0 || item > 255)
            return fields.error("classes", "expected whole numbers from 0 to 255");
        out.push_back(item.get<std::uint8_t>());
    }
}

void readView(FieldReader& fields, View& view) {
    const auto* object = fields.require("view");
    if (!object) return;
    if (const auto parsed = applyJson(View{}, *object))
        view = *parsed;
    else
        fields.error("view", parsed.error().message);
}

void readLook(FieldReader& fields, std::optional<Look>& look) {
    const auto* object = fields.findValue("look");
    if (!object) return;
    // A later server's may say what this program does not know; the view alone is enough to begin.
    if (auto parsed = applyLook(Look{}, *object)) look = std::move(*parsed);
}

void readHistogram(FieldReader& parent, std::optional<HistogramInfo>& out) {
    const auto* object = parent.findValue("histogram");
    if (!object) return;
    HistogramInfo histogram;
    FieldReader fields(*object, parent.path("histogram"), ErrorCode::Malformed);
    if (fields.require("low")) fields.number("low", histogram.low);
    if (fields.require("high")) fields.number("high", histogram.high);
    if (const auto* counts = fields.require("counts")) {
        if (!counts->is_array() || counts->size() > mostEntries)
            return parent.error("histogram", "expected an array of counts");
        for (const json& count : *counts) {
            if (!count.is_number_unsigned())
                return parent.error("histogram", "expected whole numbers as counts");
            histogram.counts.push_back(count.get<std::uint64_t>());
        }
    }
    if (auto sound = fields.finishLenient(); !sound) return parent.error(sound.error());
    out = std::move(histogram);
}

void readColumn(FieldReader& fields, ColumnInfo& column) {
    if (fields.require("name")) fields.text("name", column.name, longestText);
    fields.text("type", column.type);
    fields.text("description", column.description, longestText);
    fields.numbers("range", column.range);
    fields.flag("drawn", column.drawn);
    std::array<double, 2> usual{};
    if (fields.findValue("usual") && fields.numbers("usual", usual)) column.usual = usual;
    readHistogram(fields, column.histogram);
}

void readCloud(FieldReader& fields, CloudInfo& info) {
    if (fields.require("id")) fields.text("id", info.id);
    fields.text("title", info.title, longestText);
    fields.text("attribution", info.attribution, longestText);
    fields.text("recorded", info.recorded, longestText);
    fields.text("format", info.format, longestText);
    fields.text("revision", info.revision);
    if (fields.require("points")) fields.integer("points", info.points, 0, UINT64_MAX);
    fields.integer("droppedPoints", info.droppedPoints, 0, UINT64_MAX);
    if (const auto* bounds = fields.require("bounds")) {
        FieldReader box(*bounds, fields.path("bounds"), ErrorCode::Malformed);
        if (box.require("min")) box.vector("min", info.bounds[0]);
        if (box.require("max")) box.vector("max", info.bounds[1]);
        if (auto sound = box.finishLenient(); !sound) fields.error(sound.error());
    }
    fields.vector("origin", info.origin);
    fields.number("spacing", info.spacing);
    readList(fields, "attributes", info.attributes, [](FieldReader& entry, AttributeInfo& attribute) {
        if (entry.require("name")) entry.text("name", attribute.name);
        std::array<double, 2> range{};
        if (entry.findValue("range") && entry.numbers("range", range)) attribute.range = range;
    });
    readClasses(fields, info.classes);
    fields.text("crsWkt", info.crsWkt, longestText);
    fields.integer("crsEpsg", info.crsEpsg, 0, INT32_MAX);
    readList(fields, "mirrors", info.mirrors, [](FieldReader& entry, MirrorInfo& mirror) {
        entry.vector("center", mirror.center);
        entry.vector("normal", mirror.normal);
        entry.vector("up", mirror.up);
        entry.number("width", mirror.width);
        entry.number("height", mirror.height);
        std::string tint;
        if (!entry.text("tint", tint)) return;
        if (const auto color = values::parse<Rgb8>(tint))
            mirror.tint = *color;
        else
            entry.error("tint", "expected a colour as \"#rrggbb\"");
    });
    readList(fields, "columns", info.columns, readColumn);
    fields.flag("surfels", info.surfels);
    fields.integer("bytesResident", info.bytesResident, 0, UINT64_MAX);
    readView(fields, info.view);
    readLook(fields, info.look);
}

void readDefault(FieldReader& fields, ParameterValue& out) {
    const auto* value = fields.require("default");
    if (!value) return;
    if (value->is_boolean())
        out = value->get<bool>();
    else if (value->is_number())
        out = value->get<double>();
    else if (value->is_string())
        out = value->get<std::string>();
    else
        fields.error("default", "expected a number, a string, true or false");
}

void readMethod(FieldReader& fields, MethodInfo& info) {
    if (fields.require("name")) fields.text("name", info.name);
    fields.text("title", info.title, longestText);
    fields.text("summary", info.summary, longestText);
    fields.text("source", info.source, longestText);
    readTexts(fields, "needs", info.needs);
    fields.number("defaultDetail", info.defaultDetail);
    values::read(fields, "defaultShading", info.defaultShading);
    readList(fields, "parameters", info.parameters, [](FieldReader& entry, ParameterInfo& parameter) {
        if (entry.require("name")) entry.text("name", parameter.name);
        if (entry.require("type")) entry.text("type", parameter.type);
        readDefault(entry, parameter.defaultValue);
        entry.number("min", parameter.min);
        entry.number("max", parameter.max);
        readTexts(entry, "choices", parameter.choices);
        entry.text("unit", parameter.unit);
        entry.text("meaning", parameter.meaning, longestText);
    });
}

template <class T, class Read>
Expected<T> fromJson(const json& value, Read read) {
    T result;
    FieldReader fields(value, {}, ErrorCode::Malformed);
    read(fields, result);
    if (auto ok = fields.finishLenient(); !ok) return passOn(ok);
    return result;
}

template <class T, class Read>
Expected<std::vector<T>> listFromJson(const json& value, std::string_view key, Read read) {
    std::vector<T> result;
    FieldReader fields(value, {}, ErrorCode::Malformed);
    if (fields.require(key)) readList(fields, key, result, read);
    if (auto ok = fields.finishLenient(); !ok) return passOn(ok);
    return result;
}

}  // namespace

json toJson(const CloudInfo& info) {
    json object = {
        {"id", info.id},
        {"title", info.title},
        {"format", info.format},
        {"revision", info.revision},
        {"points", info.points},
        {"droppedPoints", info.droppedPoints},
        {"bounds", {{"min", jsonArray(info.bounds[0])}, {"max", jsonArray(info.bounds[1])}}},
        {"origin", jsonArray(info.origin)},
        {"spacing", info.spacing},
        {"surfels", info.surfels},
        {"attributes", listToJson(info.attributes)},
        {"classes", info.classes},
        {"mirrors", listToJson(info.mirrors)},
        {"columns", listToJson(info.columns)},
        {"bytesResident", info.bytesResident},
        {"view", toJson(info.view)},
    };
    if (info.look) {
        object["look"] = toJson(*info.look);
        object["look"].erase("outline");  // as long as all the rest; /views fits cameras to it
    }
    if (!info.attribution.empty()) object["attribution"] = info.attribution;
    if (!info.recorded.empty()) object["recorded"] = info.recorded;
    if (!info.crsWkt.empty()) object["crsWkt"] = info.crsWkt;
    if (info.crsEpsg) object["crsEpsg"] = *info.crsEpsg;
    return object;
}

json toJson(const MethodInfo& info) {
    return {
        {"name", info.name},
        {"title", info.title},
        {"summary", info.summary},
        {"source", info.source},
        {"needs", info.needs},
        {"defaultDetail", info.defaultDetail},
        {"defaultShading", name(info.defaultShading)},
        {"parameters", listToJson(info.parameters)},
    };
}

json toJson(const std::vector<CloudInfo>& clouds) {
    return {{"clouds", listToJson(clouds)}};
}
json toJson(const std::vector<MethodInfo>& methods) {
    return {{"methods", listToJson(methods)}};
}

Expected<CloudInfo> cloudInfoFromJson(const json& value) {
    return fromJson<CloudInfo>(value, readCloud);
}
Expected<MethodInfo> methodInfoFromJson(const json& value) {
    return fromJson<MethodInfo>(value, readMethod);
}

Expected<std::vector<CloudInfo>> cloudListFromJson(const json& value) {
    return listFromJson<CloudInfo>(value, "clouds", readCloud);
}

Expected<std::vector<MethodInfo>> methodListFromJson(const json& value) {
    return listFromJson<MethodInfo>(value, "methods", readMethod);
}

}  // namespace scancast
