#include "server/catalog/describe_point.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "files/bytes.hpp"
#include "protocol/classification.hpp"
#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/cloud/import/crs_units.hpp"

namespace scancast {
namespace {

constexpr std::uint64_t wholeInDouble = (std::uint64_t(1) << 53) - 1;

/// Readers of JSON take numbers for doubles.
template <class T>
nlohmann::json exactWhole(T value) {
    const bool negative = value < 0;
    const std::uint64_t size = negative ? std::uint64_t(0) - std::uint64_t(value) : std::uint64_t(value);
    if (size > wholeInDouble) return std::to_string(value);
    return value;
}

nlohmann::json finiteNumber(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

nlohmann::json columnValue(const std::byte* at, const Column& column) {
    const auto whole = [&](auto stored) -> nlohmann::json {
        if (column.scale == 1 && column.offset == 0) return exactWhole(stored);
        return finiteNumber(column.offset + column.scale * double(stored));
    };
    const auto real = [&](double stored) { return finiteNumber(column.offset + column.scale * stored); };
    switch (column.type) {
        case ColumnType::Int8:
            return whole(loadLe<std::int8_t>(at));
        case ColumnType::Uint8:
            return whole(loadLe<std::uint8_t>(at));
        case ColumnType::Int16:
            return whole(loadLe<std::int16_t>(at));
        case ColumnType::Uint16:
            return whole(loadLe<std::uint16_t>(at));
        case ColumnType::Int32:
            return whole(loadLe<std::int32_t>(at));
        case ColumnType::Uint32:
            return whole(loadLe<std::uint32_t>(at));
        case ColumnType::Int64:
            return whole(loadLe<std::int64_t>(at));
        case ColumnType::Uint64:
            return whole(loadLe<std::uint64_t>(at));
        case ColumnType::Float32:
            return real(double(loadLe<float>(at)));
        case ColumnType::Float64:
            break;
    }
    return real(loadLe<double>(at));
}

}  // namespace

nlohmann::json crsJson(const CloudFacts& cloud) {
    const CrsUnits units = crsUnits(cloud.crsWkt, cloud.crsEpsg);
    nlohmann::json json;
    const auto say = [&](const char* key, const std::string& text) {
        if (!text.empty()) json[key] = text;
    };
    say("name", crsName(cloud.crsWkt, cloud.crsEpsg));
    if (cloud.crsEpsg) json["epsg"] = *cloud.crsEpsg;
    say("unit", units.unit);
    say("verticalName", units.verticalName);
    if (units.verticalEpsg) json["verticalEpsg"] = *units.verticalEpsg;
    say("verticalUnit", units.verticalUnit);
    return json;
}

nlohmann::json attributesJson(const KeptPoint& point) {
    nlohmann::json values = nlohmann::json::object();
    std::size_t at = 0;
    for (const Column& column : point.columns) {
        values[column.name] = columnValue(point.row.data() + at, column);
        at += bytesOf(column.type);
    }
    return values;
}

nlohmann::json pickedJson(const Cloud& shown, const Picked& picked) {
    const Cloud& cloud = picked.of ? *picked.of->cloud : shown;
    const auto numbers = [](const auto& v) { return nlohmann::json{v.x, v.y, v.z}; };
    const Sample& sample = picked.sample;
    nlohmann::json json{{"position", numbers(picked.point.position)},
                        {"precision", numbers(picked.point.precision)},
                        {"exact", picked.point.exact},
                        {"surface", numbers(picked.surface)},
                        {"crs", crsJson(cloud)},
                        {"attributes", attributesJson(picked.point)},
                        {"depth", picked.depth},
                        {"distance", picked.distance}};
    if (cloud.attributes.color) json["rgb"] = {sample.r, sample.g, sample.b};
    if (cloud.attributes.intensity) json["intensity"] = sample.intensity;
    if (cloud.attributes.classification) {
        json["classification"] = sample.classification;
        json["className"] = className(sample.classification);
    }
    if (picked.point.normal)
        json["normal"] = numbers(*picked.point.normal);
    else if (cloud.attributes.normal && sample.normal != noNormal)
        json["normal"] = numbers(decodeNormal(sample.normal));
    if (picked.radius > 0) json["radius"] = picked.radius;
    if (picked.of) {
        json["cloud"] = picked.of->name;
        json["shift"] = numbers(picked.of->shift);
    }
    return json;
}

}  // namespace scancast
