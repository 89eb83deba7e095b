// The table of a view's words. A row says all that there is to say about a word: what it is called, how help
// describes it, the member of View that it sets, and what may stand there.
#include "protocol/view/view_checks.hpp"
#include "protocol/view/view_values.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast {
namespace {

using values::Parsed;
using Done = tl::expected<void, std::string>;

/// Below the least ones, sizes in pixels run out of every number format; nothing to see is lost.
constexpr ViewRange angles{1e-6, 180 - 0x1p-45, "lie between 0 and 180 degrees, both excluded",
                           ErrorCode::ImpossibleView};
constexpr ViewRange lengths{1e-9, checks::farthestCoordinate, "be above 0, in the cloud's unit",
                            ErrorCode::ImpossibleView};
constexpr ViewRange sides{1, maxPictureSide, "lie between 1 and 16384 px"};

constexpr ViewRange shares{0, 1, "lie between 0 and 1"};

constexpr auto anything = [](std::string_view, const auto&) { return Expected<void>(); };

template <class T>
struct Plain {
    using Type = T;
    static constexpr bool optional = false;
};
template <class T>
struct Plain<std::optional<T>> {
    using Type = T;
    static constexpr bool optional = true;
};
/// What `Member` leads to in a view.
template <class Member>
using MemberOf = Plain<std::remove_cvref_t<std::invoke_result_t<Member, View&>>>;

template <class T, class U>
Done set(T& out, Parsed<U> parsed) {
    if (!parsed) return passOn(parsed);
    out = static_cast<typename Plain<T>::Type>(std::move(*parsed));
    return {};
}

/// A word that sets one member: `parse` makes its value of text, `read` of a field. `auto` clears optional
/// ones.
template <class Member, class Parse, class Read, class Check>
ViewValue valueBy(Member member, Parse parse, Read read, Check check) {
    constexpr bool optional = MemberOf<Member>::optional;
    ViewValue value;
    value.parse = [=](View& view, std::string_view, std::string_view text) {
        if constexpr (optional)
            if (text == "auto") return member(view).reset(), Done();
        return set(member(view), parse(text));
    };
    value.read = [=](View& view, FieldReader& fields, std::string_view key) {
        return read(fields, key, member(view));
    };
    value.print = [=](const View& view) { return values::print(member(view)); };
    value.check = [=](const View& view, std::string_view word) {
        if constexpr (!optional)
            return check(word, member(view));
        else
            return member(view) ? check(word, *member(view)) : Expected<void>();
    };
    return value;
}

/// The usual word: its member's type says how it is written.
template <class Member, class Check = decltype(anything)>
ViewValue value(Member member, Check check = anything) {
    return valueBy(
        member, [](auto text) { return values::parse<typename MemberOf<Member>::Type>(text); },
        [](auto& fields, auto key, auto& out) { return values::read(fields, key, out); }, check);
}

auto within(const ViewRange& range) {
    return [=](auto word, auto number) { return checks::inRange(word, double(number), range); };
}

template <class Member>
ViewValue number(Member member, const ViewRange& range) {
    ViewValue made = value(member, within(range));
    made.range = range;
    return made;
}

template <class Member>
ViewValue whole(Member member, const ViewRange& range) {
    const auto least = std::uint64_t(range.least);
    const auto most = range.most < 0x1p64 ? std::uint64_t(range.most) : UINT64_MAX;
    ViewValue made = valueBy(
        member, [=](auto text) { return values::parseWhole(text, least, most); },
        [=](auto& fields, auto key, auto& out) { return fields.integer(key, out, least, most); },
        within(range));
    made.range = range;
    return made;
}

/// Setting the value changes something else, too.
ViewValue with(void (*effect)(View&), ViewValue value) {
    value.parse = [=, parse = value.parse](View& view, auto word, auto text) {
        return parse(view, word, text).map([&] { effect(view); });
    };
    value.read = [=, read = value.read](View& view, FieldReader& fields, auto key) {
        const bool done = read(view, fields, key);
        if (done) effect(view);
        return done;
    };
    return value;
}

ViewValue when(bool (*matters)(const View&), ViewValue value) {
    value.matters = matters;
    return value;
}

bool isPerspective(const View& view) {
    return view.camera.projection == Projection::Perspective;
}

bool isOrthographic(const View& view) {
    return view.camera.projection == Projection::Orthographic;
}

bool hasMatrix(const View& view) {
    return view.camera.viewMatrix.has_value();
}

template <class Member>
ViewValue lookAt(Member member) {
    return when([](const View& view) { return !hasMatrix(view); },
                with([](View& view) { view.camera.viewMatrix.reset(); }, value(member, checks::coordinates)));
}

// Its row follows those of the words beside which it may not stand; for text applyWords() sees to that.
ViewValue viewMatrix() {
    ViewValue made = value(
        [](auto& v) -> auto& { return v.camera.viewMatrix; }, checks::matrix);
    made.parse = [](View& view, auto, std::string_view text) {
        return set(view.camera.viewMatrix, values::parse<std::array<double, 16>>(text));
    };
    made.read = [read = made.read](View& view, FieldReader& fields, std::string_view key) {
        const bool done = read(view, fields, key);
        if (done && hasMatrix(view) && (fields.find("eye") || fields.find("target") || fields.find("up")))
            fields.error(key, "stands beside eye, target or up; give one or the other");
        return done;
    };
    return when(hasMatrix, made);
}

ViewValue method() {
    return with(
        [](View& view) { view.style.parameters.clear(); },
        valueBy(
            [](auto& v) -> auto& { return v.style.method; },
            [](auto text) { return Parsed<std::string>(text); },
            [](auto& fields, auto key, auto& out) { return fields.text(key, out, 64); }, checks::method));
}

ViewValue parameters() {
    ViewValue made;
    made.parse = [](View& view, std::string_view word, std::string_view text) {
        const auto name = word.substr(std::string_view("param.").size());
        return set(view.style.parameters[std::string(name)], values::parse<ParameterValue>(text));
    };
    made.read = [](View& view, FieldReader& fields, std::string_view key) {
        return values::read(fields, key, view.style.parameters);
    };
    made.print = [](const View& view) { return values::print(view.style.parameters); };
    made.check = [](const View& view, auto) { return checks::parameters(view.style.parameters); };
    return made;
}

ViewValue color() {
    const auto use = [](View& view, const values::Color& color) {
        view.style.color = color.source;
        view.style.flatColor = color.flat;
        view.style.byIntensity = color.byIntensity;
        view.style.column = color.column;
    };
    ViewValue made;
    made.parse = [=](View& view, auto, std::string_view text) {
        values::Color color;
        return set(color, values::parse<values::Color>(text)).map([&] { use(view, color); });
    };
    made.read = [=](View& view, FieldReader& fields, std::string_view key) {
        values::Color color;
        const bool done = values::read(fields, key, color);
        if (done) use(view, color);
        return done;
    };
    made.print = [](const View& view) { return colorWord(view.style); };
    made.check = [](const View& view, auto word) { return checks::color(word, view.style); };
    return made;
}

ViewValue colormap() {
    return valueBy(
        [](auto& v) -> auto& { return v.style.colormap; }, values::parseColormap,
        [](auto& fields, auto key, auto& out) {
            return values::read(fields, key, out, values::parseColormap);
        },
        checks::colormap);
}

const std::vector<ViewWord>& table() {
    static const std::vector<ViewWord> words{
        {"eye", "camera.eye", "X,Y,Z", "Where the viewer is, in the file's coordinates.", "12.5,-3,1.7",
         lookAt([](auto& v) -> auto& { return v.camera.eye; })},
        {"target", "camera.target", "X,Y,Z", "The point that is looked at, in the middle of the picture.",
         "0,0,1.5", lookAt([](auto& v) -> auto& { return v.camera.target; })},
        {"up", "camera.up", "X,Y,Z", "The direction that is up in the picture.", "0,0,1",
         lookAt([](auto& v) -> auto& { return v.camera.up; })},
        {"viewMatrix", "camera.viewMatrix", "M0,...,M15",
         "World to view, 16 numbers column by column as in OpenGL; replaces eye, target and up.",
         "1,0,0,0,0,0,-1,0,0,1,0,0,0,0,-10,1", viewMatrix()},
        {"projection", "camera.type", "perspective|orthographic", "How depth becomes size.", "orthographic",
         value([](auto& v) -> auto& { return v.camera.projection; })},
        {"fov", "camera.fov", "DEGREES", "Full vertical field of view; perspective only.", "60",
         when(isPerspective, number(
                                 [](auto& v) -> auto& { return v.camera.fov; }, angles))},
        {"viewHeight", "camera.viewHeight", "LENGTH", "Height of what the picture shows; orthographic only.",
         "25",
         when(isOrthographic, number(
                                  [](auto& v) -> auto& { return v.camera.viewHeight; }, lengths))},
        {"near", "camera.near", "LENGTH|auto", "Nothing nearer than this is drawn.", "0.5",
         number(
             [](auto& v) -> auto& { return v.camera.near; }, lengths)},
        {"far", "camera.far", "LENGTH|auto", "Nothing farther than this is drawn.", "500",
         number(
             [](auto& v) -> auto& { return v.camera.far; }, lengths)},
        {"width", "width", "PIXELS", "Width of the picture.", "1280",
         whole(
             [](auto& v) -> auto& { return v.width; }, sides)},
        {"height", "height", "PIXELS", "Height of the picture.", "720",
         whole(
             [](auto& v) -> auto& { return v.height; }, sides)},
        {"method", "method", "NAME",
         "How points are drawn, auto: by the method that suits the scan; one that is named starts with its "
         "own default parameters.",
         "paraboloid", method()},
        {"param.NAME", "param", "NAME=VALUE", "A parameter of the method; may be given once for each.",
         "sizePx=5", parameters()},
        {"color", "color",
         "auto|rgb|cir|intensity|elevation|classification|normal|curvature|depth|lod|visibility|cloud|column:NAME|"
         "#rrggbb|COLOR*intensity",
         "Where colours come from, or one colour for everything (the # may be left out); auto takes the "
         "cloud's best. rgb, elevation, classification, cloud and #rrggbb get brighter with intensity by "
         "*intensity. cir is colour infrared: near infrared as red, red as green, green as blue. visibility "
         "tells hidden points from visible ones, with method pyramid. cloud gives each cloud of several (with) "
         "a colour of its own. column:NAME is a column that the cloud keeps.",
         "elevation", color()},
        {"exposure", "exposure", "STOPS|auto",
         "How much brighter the points' own colours are drawn, by powers of two; auto leaves it to the "
         "cloud.",
         "0.5",
         number([](auto& v) -> auto& { return v.style.exposure; }, {-3, 3, "lie between -3 and 3 stops"})},
        {"colormap", "colormap", "viridis|turbo|grey", "The ramp that turns values into colours.", "turbo",
         colormap()},
        {"range", "range", "LOW,HIGH|auto", "The values at the two ends of the ramp; auto takes the cloud's.",
         "0,25",
         value(
             [](auto& v) -> auto& { return v.style.range; }, checks::ends)},
        {"classes", "classes", "N,N,...|auto",
         "Draw these classifications only; none draws nothing, auto draws all.", "2,6",
         value([](auto& v) -> auto& { return v.style.classes; })},
        {"filter", "filter", "NAME:LOW..HIGH;NAME:LOW..HIGH;...|auto",
         "Draw only points whose values of a kept column, of intensity or of classification lie in the range, "
         "its ends included; LOW or HIGH may be left out, and up to four ranges all have to hold; auto draws "
         "everything. In a NAME, ; is written %3B and % is written %25.",
         "classification:2..6;intensity:1000..",
         value(
             [](auto& v) -> auto& { return v.style.filter; }, checks::columnRanges)},
        {"clip", "clip", "X0,Y0,Z0,X1,Y1,Z1|auto",
         "Draw what lies inside this box only; auto draws everything.", "0,0,0,10,10,5",
         value(
             [](auto& v) -> auto& { return v.style.clip; }, checks::clipBox)},
        {"clips", "clips", "SHAPE;SHAPE;...|auto",
         "Cut by up to eight shapes: box:CX,CY,CZ,SX,SY,SZ[,YAW[,PITCH,ROLL]] keeps what is in a turned box "
         "(in one of them at least), -box: what is outside, plane:PX,PY,PZ,NX,NY,NZ the side that its normal "
         "points to; auto cuts nothing.",
         "box:5,5,2,10,4,4,30;plane:0,0,3,0,0,-1",
         value(
             [](auto& v) -> auto& { return v.style.clips; }, checks::clipShapes)},
        {"shading", "shading", "unlit|phong|eyedome|auto",
         "How light falls on points; auto leaves it to the method.", "eyedome",
         value([](auto& v) -> auto& { return v.style.shading; })},
        {"light.ambient", "light.ambient", "SHARE", "Of phong's light: what comes from everywhere.", "0.3",
         number(
             [](auto& v) -> auto& { return v.style.light.ambient; }, shares)},
        {"light.headlight", "light.headlight", "SHARE",
         "Of phong's light: what comes from a soft lamp over the viewer's left shoulder.", "0.7",
         number(
             [](auto& v) -> auto& { return v.style.light.headlight; }, shares)},
        {"light.sun", "light.sun", "AZIMUTH,ELEVATION|auto",
         "Where the sun stands, in degrees: from north (the file's +Y) by east, and above the horizon; auto "
         "has "
         "no sun.",
         "135,40",
         value(
             [](auto& v) -> auto& { return v.style.light.sun; }, checks::sun)},
        {"light.sunlight", "light.sunlight", "SHARE",
         "Of phong's light: what comes from the sun, where there is one.", "0.8",
         number(
             [](auto& v) -> auto& { return v.style.light.sunlight; }, shares)},
        {"light.shine", "light.shine", "SHARE",
         "How bright the headlight's reflections are in surfaces that face it.", "0.2",
         number(
             [](auto& v) -> auto& { return v.style.light.shine; }, shares)},
        {"light.occlusion", "light.occlusion", "STRENGTH|auto",
         "How dark hollows, corners and the feet of things are drawn, with any shading; 0 is off, auto "
         "leaves "
         "it to the cloud's look.",
         "0.6",
         number(
             [](auto& v) -> auto& { return v.style.light.occlusion; }, shares)},
        {"light.shadow", "light.shadow", "STRENGTH",
         "How dark the sun's shadows are, with any shading, where there is a sun; 0 is off.", "0.8",
         number(
             [](auto& v) -> auto& { return v.style.light.shadow; }, shares)},
        {"mirrors", "mirrors", "true|false", "Whether the cloud's mirrors show what stands before them.",
         "false", value([](auto& v) -> auto& { return v.style.mirrors; })},
        {"behindMirrors", "behindMirrors", "true|false",
         "Whether points are drawn that the scanner saw in a mirror, and recorded behind it.", "true",
         value([](auto& v) -> auto& { return v.style.behindMirrors; })},
        {"outliers", "outliers", "hide|show",
         "Whether points are drawn that are far from everything else, alone or in small groups.", "show",
         value([](auto& v) -> auto& { return v.style.outliers; })},
        {"background", "background", "transparent|#rrggbb|#rrggbb,#rrggbb",
         "Behind the points: nothing (PNG), one colour, or a gradient from top to bottom.", "#ffffff",
         value([](auto& v) -> auto& { return v.style.background; })},
        {"with", "with", "CLOUD[,shift:DX:DY:DZ][,tint:RRGGBB][,hidden];...|auto",
         "Show up to 64 other clouds of the same coordinate system together with this one, each moved, tinted or "
         "hidden; . is the cloud itself, auto shows it alone. A tint multiplies a cloud's own colours, and is the "
         "colour of one that has none.",
         ".,shift:0:0:0.12,tint:ff8800",
         value(
             [](auto& v) -> auto& { return v.with; }, checks::viewedClouds)},
        {"detail", "detail", "PIXELS|auto",
         "How fine: the distance of neighbouring samples on screen down to which the cloud is refined.", "1",
         number([](auto& v) -> auto& { return v.quality.detail; }, {0, 1024, "lie between 0 and 1024 px"})},
        {"budget", "budget", "SAMPLES|auto", "Draw at most so many samples; auto sets no limit.", "5000000",
         whole([](auto& v) -> auto& { return v.quality.budget; }, {1, 0x1p64, "be at least 1 sample"})},
        {"samples", "samples", "N|auto", "Anti-aliasing: so many slightly shifted pictures are averaged.",
         "4", whole([](auto& v) -> auto& { return v.quality.samples; }, {1, 64, "lie between 1 and 64"})},
        {"quality", "quality", "1-100", "Quality of the JPEG.", "90",
         whole([](auto& v) -> auto& { return v.quality.jpegQuality; }, {1, 100, "lie between 1 and 100"})},
        {"subsampling", "subsampling", "4:4:4|4:2:2|4:2:0", "Colour resolution of the JPEG.", "4:4:4",
         value([](auto& v) -> auto& { return v.quality.subsampling; })},
    };
    return words;
}

}  // namespace

std::span<const ViewWord> viewWords() {
    return table();
}

}  // namespace scancast
