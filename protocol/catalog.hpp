// What a server says about its clouds and methods: the bodies of GET /clouds, /clouds/{id} and /methods.
//
// Plain values; the server fills them in and prints them, clients parse them. Any thread.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "protocol/look.hpp"
#include "protocol/view/view.hpp"

namespace scancast {

struct AttributeInfo {
    std::string name;  ///< "rgb", "cir", "intensity", "elevation", "classification", "normal"
    std::optional<std::array<double, 2>> range;  ///< smallest and largest value, where that means something
    bool operator==(const AttributeInfo&) const = default;
};

/// How many points have values in each of equal parts from `low` to `high`; those beyond are in none.
struct HistogramInfo {
    double low = 0, high = 1;
    std::vector<std::uint64_t> counts;
    bool operator==(const HistogramInfo&) const = default;
};

/// A kept column, or intensity (PROTOCOL.md, "Columns").
struct ColumnInfo {
    std::string name, type;  ///< "gps_time", "float64"
    std::string description;
    std::array<double, 2> range{0, 0};             ///< least and greatest value
    bool drawn = false;                            ///< views may be coloured and filtered by it
    std::optional<std::array<double, 2>> usual{};  ///< 1st and 99th percentile
    std::optional<HistogramInfo> histogram{};
    bool operator==(const ColumnInfo&) const = default;
};

struct MirrorInfo {
    glm::dvec3 center{0}, normal{0, 0, 1}, up{0, 1, 0};  ///< file coordinates; unit vectors
    double width = 0, height = 0;                        ///< cloud units
    Rgb8 tint{255, 255, 255};                            ///< colour of its glass; in JSON "#rrggbb"
    bool operator==(const MirrorInfo&) const = default;
};

struct CloudInfo {
    std::string id;  ///< names the cloud in URLs and messages
    std::string title;
    std::string attribution;  ///< whom to name beside its pictures; empty = nobody said
    std::string recorded;     ///< when it was scanned: "2024-05-13", or less of it; empty = nobody said
    std::string format;       ///< "LAS 1.2, point format 3"
    std::string revision;     ///< changes whenever a picture of it could
    std::uint64_t points = 0;
    std::uint64_t droppedPoints = 0;     ///< not in the picture: NaN or infinite coordinates
    std::array<glm::dvec3, 2> bounds{};  ///< min, max in file coordinates
    glm::dvec3 origin{0};
    double spacing = 0;    ///< typical distance of neighbouring points, cloud units
    bool surfels = false;  ///< samples carry radius, ellipse and normal, which some methods need
    std::vector<AttributeInfo> attributes;
    std::vector<std::uint8_t> classes;  ///< classifications that occur
    std::string crsWkt;                 ///< empty = unknown
    std::optional<int> crsEpsg;
    std::vector<MirrorInfo> mirrors;
    std::vector<ColumnInfo> columns;
    std::uint64_t bytesResident = 0;
    View view;                 ///< a good first view of it
    std::optional<Look> look;  ///< how that was found; without outline; nullopt: not decided yet
    bool operator==(const CloudInfo&) const = default;
};

struct ParameterInfo {
    std::string name;  ///< as in `param.NAME=VALUE`
    std::string type;  ///< "number", "boolean" or "choice"
    ParameterValue defaultValue = 0.0;
    double min = 0, max = 0;           ///< number: inclusive
    std::vector<std::string> choices;  ///< choice
    std::string unit;                  ///< "px"; may be empty
    std::string meaning;
    bool operator==(const ParameterInfo&) const = default;
};

struct MethodInfo {
    std::string name;
    std::string title;
    std::string summary;
    std::string source;              ///< the paper
    std::vector<std::string> needs;  ///< what a cloud must have: "surfels"; often nothing
    double defaultDetail = 1;        ///< τ, px
    Shading defaultShading = Shading::Unlit;
    std::vector<ParameterInfo> parameters;
    bool operator==(const MethodInfo&) const = default;
};

nlohmann::json toJson(const CloudInfo& info);
nlohmann::json toJson(const MethodInfo& info);
/// `{"clouds": […]}` and `{"methods": […]}`: the bodies of the two lists.
nlohmann::json toJson(const std::vector<CloudInfo>& clouds);
nlohmann::json toJson(const std::vector<MethodInfo>& methods);

/// Lenient, for clients: unknown members are skipped. Malformed, with the JSON path as field, for missing or
/// mistyped members and for views that are none.
Expected<CloudInfo> cloudInfoFromJson(const nlohmann::json& value);
Expected<MethodInfo> methodInfoFromJson(const nlohmann::json& value);
Expected<std::vector<CloudInfo>> cloudListFromJson(const nlohmann::json& value);
Expected<std::vector<MethodInfo>> methodListFromJson(const nlohmann::json& value);

}  // namespace scancast
