#include "protocol/view_words.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "protocol/nearest_name.hpp"
#include "protocol/view_values.hpp"

namespace scancast {
namespace {

constexpr std::array<ViewWord, 27> words{{
    {"eye", "--eye", "X,Y,Z", "Where the viewer is, in the file's coordinates.", "12.5,-3,1.7"},
    {"target", "--target", "X,Y,Z", "The point that is looked at, in the middle of the picture.", "0,0,1.5"},
    {"up", "--up", "X,Y,Z", "The direction that is up in the picture.", "0,0,1"},
    {"viewMatrix", "--view-matrix", "M0,...,M15",
     "World to view, 16 numbers column by column as in OpenGL; replaces eye, target and up.",
     "1,0,0,0,0,0,-1,0,0,1,0,0,0,0,-10,1"},
    {"projection", "--projection", "perspective|orthographic", "How depth becomes size.", "orthographic"},
    {"fov", "--fov", "DEGREES", "Full vertical field of view; perspective only.", "60"},
    {"viewHeight", "--view-height", "LENGTH", "Height of the picture in the cloud's unit; orthographic only.",
     "25"},
    {"near", "--near", "LENGTH|auto", "Nothing nearer than this is drawn.", "0.5"},
    {"far", "--far", "LENGTH|auto", "Nothing farther than this is drawn.", "500"},
    {"width", "--width", "PIXELS", "Width of the picture, 1 to 16384.", "1280"},
    {"height", "--height", "PIXELS", "Height of the picture, 1 to 16384.", "720"},
    {"method", "--method", "NAME", "How points are drawn; it starts with its own default parameters.",
     "paraboloid"},
    {"param.NAME", "--param", "NAME=VALUE", "A parameter of the method; may be given once for each.",
     "sizePx=5"},
    {"color", "--color", "rgb|intensity|elevation|classification|normal|depth|lod|#rrggbb",
     "Where colours come from, or one colour for everything (the # may be left out).", "elevation"},
    {"colormap", "--colormap", "viridis|turbo|grey", "The ramp that turns values into colours.", "turbo"},
    {"range", "--range", "LOW,HIGH|auto", "The values at the two ends of the ramp; auto takes the cloud's.",
     "0,25"},
    {"classes", "--classes", "N,N,...|auto",
     "Draw these classifications only; none draws nothing, auto draws all.", "2,6"},
    {"clip", "--clip", "X0,Y0,Z0,X1,Y1,Z1|auto",
     "Draw what lies inside this box only; auto draws everything.", "0,0,0,10,10,5"},
    {"shading", "--shading", "unlit|phong|eyedome|auto",
     "How light falls on points; auto leaves it to the method.", "eyedome"},
    {"mirrors", "--mirrors", "true|false", "Whether the cloud's mirrors show what stands before them.",
     "false"},
    {"behindMirrors", "--behind-mirrors", "true|false",
     "Whether points are drawn that the scanner saw in a mirror, and recorded behind it.", "true"},
    {"background", "--background", "transparent|#rrggbb|#rrggbb,#rrggbb",
     "Behind the points: nothing (PNG), one colour, or a gradient from top to bottom.", "#ffffff"},
    {"detail", "--detail", "PIXELS|auto",
     "How fine: the distance of neighbouring samples on screen down to which the cloud is refined.", "1"},
    {"budget", "--budget", "SAMPLES|auto", "Draw at most so many samples; auto sets no limit.", "5000000"},
    {"samples", "--samples", "N|auto",
     "Anti-aliasing: so many slightly shifted pictures are averaged, 1 to 64.", "4"},
    {"quality", "--quality", "1-100", "Quality of the JPEG.", "90"},
    {"subsampling", "--subsampling", "4:4:4|4:2:2|4:2:0", "Colour resolution of the JPEG.", "4:4:4"},
}};

constexpr std::string_view parameterPrefix = "param.";
constexpr std::size_t mostWords = 256;

using values::Parsed;

Parsed<double> number(std::string_view text) {
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code == std::errc::result_out_of_range && end == text.data() + text.size())
        return tl::unexpected(quoteText(text) + " is too large or too small for a number");
    if (code != std::errc{} || end != text.data() + text.size())
        return tl::unexpected(quoteText(text) + " is no number");
    return value;
}

template <class T>
Parsed<T> whole(std::string_view text, std::uint64_t least, std::uint64_t most) {
    std::uint64_t value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc{} || end != text.data() + text.size() || value < least || value > most)
        return tl::unexpected(quoteText(text) + " is no whole number from " + std::to_string(least) +
                              (most == UINT64_MAX ? std::string(" upwards") : " to " + std::to_string(most)));
    return static_cast<T>(value);
}

template <std::size_t N>
Parsed<std::array<double, N>> numbers(std::string_view text) {
    std::array<double, N> result{};
    std::size_t count = 0;
    for (std::string_view rest = text;; ++count) {
        const auto comma = rest.find(',');
        if (count < N) {
            const auto value = number(rest.substr(0, comma));
            if (!value) return tl::unexpected(value.error());
            result[count] = *value;
        }
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    if (count + 1 != N)
        return tl::unexpected("expected " + std::to_string(N) + " numbers with commas between them, got " +
                              std::to_string(count + 1));
    return result;
}

Parsed<glm::dvec3> vector(std::string_view text) {
    return numbers<3>(text).map([](const auto& v) { return glm::dvec3(v[0], v[1], v[2]); });
}

Parsed<std::vector<std::uint8_t>> classes(std::string_view text) {
    std::vector<std::uint8_t> result;
    if (text == "none") return result;
    for (std::string_view rest = text;;) {
        const auto comma = rest.find(',');
        const auto value = whole<std::uint8_t>(rest.substr(0, comma), 0, 255);
        if (!value) return tl::unexpected(value.error());
        if (std::find(result.begin(), result.end(), *value) == result.end()) result.push_back(*value);
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    std::sort(result.begin(), result.end());
    return result;
}

Parsed<bool> flag(std::string_view text) {
    if (text == "true" || text == "false") return text == "true";
    return tl::unexpected("expected true or false, got " + quoteText(text));
}

Parsed<ClipBox> clipBox(std::string_view text) {
    return numbers<6>(text).map([](const auto& v) {
        return ClipBox{glm::dvec3(v[0], v[1], v[2]), glm::dvec3(v[3], v[4], v[5])};
    });
}

ParameterValue parameterValue(std::string_view text) {
    if (text == "true") return true;
    if (text == "false") return false;
    if (const auto value = number(text)) return *value;
    return std::string(text);
}

/// What applying a word says: nothing, or the sentence on what is wrong with the value.
using Outcome = tl::expected<void, std::string>;

template <class T, class U>
Outcome set(U& out, Parsed<T> parsed) {
    if (!parsed) return tl::unexpected(parsed.error());
    out = std::move(*parsed);
    return {};
}

/// `auto` clears; anything else is parsed.
template <class T, class Parse>
Outcome setOptional(std::optional<T>& out, std::string_view text, Parse parse) {
    if (text == "auto") {
        out.reset();
        return {};
    }
    return set(out, Parsed<T>(parse(text)));
}

std::optional<Outcome> applyCameraWord(Camera& camera, std::string_view word, std::string_view text) {
    const auto lookAt = [&](glm::dvec3& out) {
        auto outcome = set(out, vector(text));
        if (outcome) camera.viewMatrix.reset();
        return outcome;
    };
    if (word == "eye") return lookAt(camera.eye);
    if (word == "target") return lookAt(camera.target);
    if (word == "up") return lookAt(camera.up);
    if (word == "viewMatrix") return set(camera.viewMatrix, numbers<16>(text));
    if (word == "projection") return set(camera.projection, values::projection(text));
    if (word == "fov") return set(camera.fov, number(text));
    if (word == "viewHeight") return set(camera.viewHeight, number(text));
    if (word == "near") return setOptional(camera.near, text, number);
    if (word == "far") return setOptional(camera.far, text, number);
    return std::nullopt;
}

std::optional<Outcome> applyStyleWord(Style& style, std::string_view word, std::string_view text) {
    if (word == "method") {
        style.method = text;
        style.parameters.clear();
        return Outcome{};
    }
    if (word.starts_with(parameterPrefix)) {
        style.parameters[std::string(word.substr(parameterPrefix.size()))] = parameterValue(text);
        return Outcome{};
    }
    if (word == "color") {
        const auto color = values::color(text);
        if (!color) return Outcome(tl::unexpected(color.error()));
        style.color = color->source;
        style.flatColor = color->flat;
        return Outcome{};
    }
    if (word == "colormap") return set(style.colormap, values::colormap(text));
    if (word == "range") return setOptional(style.range, text, numbers<2>);
    if (word == "classes") return setOptional(style.classes, text, classes);
    if (word == "clip") return setOptional(style.clip, text, clipBox);
    if (word == "shading") return setOptional(style.shading, text, values::shading);
    if (word == "mirrors") return set(style.mirrors, flag(text));
    if (word == "behindMirrors") return set(style.behindMirrors, flag(text));
    if (word == "background") return set(style.background, values::background(text));
    return std::nullopt;
}

std::optional<Outcome> applyQualityWord(Quality& quality, std::string_view word, std::string_view text) {
    if (word == "detail") return setOptional(quality.detail, text, number);
    if (word == "budget")
        return setOptional(quality.budget, text,
                           [](auto t) { return whole<std::uint64_t>(t, 1, UINT64_MAX); });
    if (word == "samples")
        return setOptional(quality.samples, text, [](auto t) { return whole<int>(t, 1, 64); });
    if (word == "quality") return set(quality.jpegQuality, whole<int>(text, 1, 100));
    if (word == "subsampling") return set(quality.subsampling, values::subsampling(text));
    return std::nullopt;
}

std::optional<Outcome> apply(View& view, std::string_view word, std::string_view text) {
    if (word == "width") return set(view.width, whole<int>(text, 1, maxPictureSide));
    if (word == "height") return set(view.height, whole<int>(text, 1, maxPictureSide));
    if (auto outcome = applyCameraWord(view.camera, word, text)) return outcome;
    if (auto outcome = applyStyleWord(view.style, word, text)) return outcome;
    return applyQualityWord(view.quality, word, text);
}

bool has(const WordValues& given, std::string_view word) {
    return std::any_of(given.begin(), given.end(), [&](const auto& pair) { return pair.first == word; });
}

/// What can only be seen by looking at all words together.
Expected<void> checkTogether(const WordValues& given) {
    if (given.size() > mostWords) return fail(ErrorCode::InvalidArgument, "there are more than 256 words");
    std::vector<std::string_view> sorted;
    for (const auto& [word, value] : given) sorted.push_back(word);
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end())
        return fail(ErrorCode::InvalidArgument, quoteText(*twice) + " is given twice", std::string(*twice));
    if (has(given, "viewMatrix") && (has(given, "eye") || has(given, "target") || has(given, "up")))
        return fail(ErrorCode::InvalidArgument,
                    "viewMatrix: stands beside eye, target or up; give one or the other", "viewMatrix");
    return {};
}

}  // namespace

std::span<const ViewWord> viewWords() {
    return words;
}

Expected<void> applyWord(View& view, std::string_view word, std::string_view value) {
    if (const auto outcome = apply(view, word, value)) {
        if (*outcome) return {};
        return fail(ErrorCode::InvalidArgument, std::string(word) + ": " + outcome->error(),
                    std::string(word));
    }
    std::vector<std::string_view> known;
    for (const auto& entry : words) known.push_back(entry.word);
    const auto at = word.substr(0, 64);
    return fail(ErrorCode::InvalidArgument, unknownName(at, word, known), std::string(at));
}

Expected<View> applyWords(const View& base, const WordValues& given) {
    if (auto sound = checkTogether(given); !sound) return tl::unexpected(sound.error());
    View view = base;
    // The method goes first, because it drops the parameters of the one before.
    for (const bool methodPass : {true, false})
        for (const auto& [word, value] : given)
            if ((word == "method") == methodPass)
                if (auto applied = applyWord(view, word, value); !applied)
                    return tl::unexpected(applied.error());
    if (auto sound = validate(view); !sound) return tl::unexpected(sound.error());
    return view;
}

}  // namespace scancast
