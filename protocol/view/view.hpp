// A view: everything that decides a picture of a cloud, and nothing else. The same words are a URL query, a
// JSON object and command-line flags (PROTOCOL.md, "One vocabulary for a view"): each member here is a word,
// with its row in view_table.cpp.
//
// Plain values without I/O. Coordinates are the file's own: right-handed, Z up, doubles, the file's unit.
// Angles are degrees here, as on the wire; the renderer works in radians.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "protocol/error.hpp"
#include "protocol/view/clip_shapes.hpp"
#include "protocol/view/viewed_clouds.hpp"

namespace scancast {

enum class Projection : std::uint8_t { Perspective, Orthographic };
inline constexpr std::array<std::string_view, 2> projectionNames{"perspective", "orthographic"};

struct Camera {
    Projection projection = Projection::Perspective;
    glm::dvec3 eye{0, -1, 0};
    glm::dvec3 target{0, 0, 0};
    glm::dvec3 up{0, 0, 1};
    double fov = 60;             ///< full vertical field of view in degrees, in (0, 180); perspective only
    double viewHeight = 1;       ///< height of the picture in cloud units; orthographic only
    std::optional<double> near;  ///< cloud units along the view direction; nullopt = automatic
    std::optional<double> far;
    /// World → view, column-major, OpenGL convention (looks down -z); replaces eye, target and up.
    std::optional<std::array<double, 16>> viewMatrix;
    bool operator==(const Camera&) const = default;
};

enum class ColorSource : std::uint8_t {
    Auto,  ///< the cloud's best (renderer/style.hpp)
    Rgb,
    Infrared,  ///< `cir`, colour infrared: near infrared, red and green as red, green and blue
    Intensity,
    Elevation,
    Classification,
    Normal,
    Curvature,
    Depth,
    Lod,
    Visibility,  ///< what hidden point removal finds; docs/spec/pyramid.md section 4.5
    Cloud,       ///< each cloud of a view of several by a colour of its own (viewed_clouds.hpp)
    Flat,
    Column,  ///< a kept column, by its name (Style::column)
};
/// Of all but Flat, which is #rrggbb on the wire, and Column, which is column:NAME.
inline constexpr std::array<std::string_view, 12> colorSourceNames{
    "auto",   "rgb",       "cir",   "intensity", "elevation",  "classification",
    "normal", "curvature", "depth", "lod",       "visibility", "cloud"};
/// Whether its brightness may follow intensity (`rgb*intensity`).
constexpr bool takesIntensity(ColorSource source) {
    using enum ColorSource;
    return source == Rgb || source == Elevation || source == Classification || source == Cloud || source == Flat;
}
inline constexpr std::array<std::string_view, 3> colormapNames{"viridis", "turbo", "grey"};
enum class Shading : std::uint8_t { Unlit, Phong, EyeDome };
inline constexpr std::array<std::string_view, 3> shadingNames{"unlit", "phong", "eyedome"};

/// What stands alone or in a small group, far from everything else (docs/spec/surfels.md section 8).
enum class Outliers : std::uint8_t { Hide, Show };
inline constexpr std::array<std::string_view, 2> outlierNames{"hide", "show"};

struct Background {
    enum class Kind : std::uint8_t { Color, Gradient, Transparent };
    Kind kind = Kind::Gradient;
    Rgb8 top{58, 66, 78};     ///< the only colour of Kind::Color
    Rgb8 bottom{22, 25, 30};  ///< Gradient only
    bool operator==(const Background&) const = default;
};

/// A method's own parameter (`param.NAME=VALUE`); what is legal is the method's to say
/// (renderer/method/method.hpp).
using ParameterValue = std::variant<bool, double, std::string>;
using ParameterValues = std::map<std::string, ParameterValue>;

/// The light that `phong` falls on a scene with (docs/spec/shading.md §2). `ambient`, `headlight` and `sunlight` are
/// shares: only how they compare matters, because light as a whole keeps colours as bright as they are.
struct LightRig {
    double ambient = 0.5;    ///< from everywhere
    double headlight = 0.5;  ///< a soft lamp over the viewer's left shoulder
    std::optional<std::array<double, 2>>
        sun;                ///< azimuth from north (+Y) by east, elevation; degrees. nullopt = none
    double sunlight = 0.5;  ///< from the sun, where there is one
    double shine = 0.08;    ///< how bright the headlight's reflections are
    /// With any shading: how dark hollows are, 0 - 1 (docs/spec/shading.md §9). nullopt = what the cloud's look says,
    /// where method and shading are the look's to say, too; else 0.
    std::optional<double> occlusion{};
    double shadow = 0;  ///< with any shading: how dark the sun's shadows are, 0 - 1
    bool operator==(const LightRig&) const = default;
};

/// An axis-aligned box in file coordinates.
struct ClipBox {
    glm::dvec3 min, max;
    bool operator==(const ClipBox&) const = default;
};

/// Of a kept column - or of `intensity`, `classification` -, the values that are drawn: inclusive, one end at least.
struct ColumnRange {
    std::string column;
    std::optional<double> low, high;  ///< nullopt: as far as there is anything

    /// NaN is in no range.
    bool has(double value) const {
        return (!low || value >= *low) && (!high || value <= *high) && value == value;
    }
    bool operator==(const ColumnRange&) const = default;
};
/// A point is drawn whose values lie in all of them.
using ColumnRanges = std::vector<ColumnRange>;
inline constexpr std::size_t mostColumnRanges = 4, longestColumnName = 256;

struct Style {
    std::string method = "auto";
    ParameterValues parameters;
    ColorSource color = ColorSource::Auto;
    Rgb8 flatColor{255, 255, 255};               ///< for ColorSource::Flat (`color=#rrggbb`)
    std::string column;                          ///< for ColorSource::Column (`color=column:NAME`)
    bool byIntensity = false;                    ///< brighter where intensity is (`color=rgb*intensity`)
    std::optional<double> exposure;              ///< of rgb: stops, -3 … 3; nullopt = the cloud's
    std::string colormap = "viridis";            ///< of colormapNames
    std::optional<std::array<double, 2>> range;  ///< values at the colour map's ends; nullopt = the cloud's
    std::optional<std::vector<std::uint8_t>> classes;  ///< draw these classifications only
    ColumnRanges filter;                               ///< draw what lies in these ranges only; none: everything
    std::optional<ClipBox> clip;                       ///< draw inside this box only
    ClipShapes clips;                                  ///< and what these leave; none: everything
    std::optional<Shading> shading;                    ///< nullopt = the method's default
    LightRig light;                                    ///< how its light falls
    bool mirrors = true;                               ///< the cloud's mirrors show what stands before them
    bool behindMirrors = false;  ///< draw what the scanner recorded behind mirrors, where nothing is
    Outliers outliers = Outliers::Hide;
    Background background;
    bool operator==(const Style&) const = default;
};

enum class Subsampling : std::uint8_t { S444, S422, S420 };
inline constexpr std::array<std::string_view, 3> subsamplingNames{"4:4:4", "4:2:2", "4:2:0"};

struct Quality {
    std::optional<double> detail;  ///< τ, projected sample spacing in px; nullopt = the method's own; ≥ 0
    std::optional<std::uint64_t> budget;  ///< samples drawn at most; nullopt = no budget
    std::optional<int> samples;  ///< anti-aliasing frames averaged, 1–64; nullopt = 4 (1 while moving)
    int jpegQuality = 90;        ///< 1–100 (`quality`)
    Subsampling subsampling = Subsampling::S420;
    bool operator==(const Quality&) const = default;
};

struct View {
    Camera camera;
    int width = 1280;  ///< px, 1–16384
    int height = 720;
    Style style;
    ViewedClouds with;  ///< what is shown together with the cloud
    Quality quality;
    bool operator==(const View&) const = default;
};

inline constexpr int maxPictureSide = 16384;
inline constexpr int defaultSamples = 4;

/// Whether a picture can be made of it. InvalidArgument for values outside their range (field names the
/// word), ImpossibleView for eye = target, NaN, up parallel to the view direction, near ≥ far, fov outside
/// (0, 180).
Expected<void> validate(const View& view);

/// What the word `color` says: "rgb*intensity".
std::string colorWord(const Style& style);

constexpr std::string_view name(Projection projection) {
    return projectionNames[std::size_t(projection)];
}
constexpr std::string_view name(ColorSource source) {
    if (source == ColorSource::Column) return "column";
    return source == ColorSource::Flat ? "flat" : colorSourceNames[std::size_t(source)];
}
constexpr std::string_view name(Shading shading) {
    return shadingNames[std::size_t(shading)];
}
constexpr std::string_view name(Outliers outliers) {
    return outlierNames[std::size_t(outliers)];
}
constexpr std::string_view name(Subsampling subsampling) {
    return subsamplingNames[std::size_t(subsampling)];
}

}  // namespace scancast
