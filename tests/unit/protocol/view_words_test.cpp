#include "protocol/view/view_words.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "protocol/view/view_json.hpp"
#include "sample_views.hpp"

namespace scancast {
namespace {

View applied(const WordValues& words, const View& base = {}) {
    const auto view = applyWords(base, words);
    if (view) return *view;
    ADD_FAILURE() << view.error().message;
    return base;
}

Error refused(const WordValues& words, const View& base = {}) {
    const auto view = applyWords(base, words);
    if (!view) return view.error();
    ADD_FAILURE() << "accepted " << printQuery(words);
    return {};
}

TEST(ViewWords, TableIsComplete) {
    std::set<std::string> names, flags, paths;
    std::string_view group;
    for (const auto& word : viewWords()) {
        EXPECT_TRUE(names.insert(std::string(word.word)).second) << word.word;
        // The words of a group share one, and stand together.
        EXPECT_TRUE(flags.insert(word.flag()).second || word.group() == group) << word.flag();
        group = word.group();
        EXPECT_TRUE(paths.insert(std::string(word.path)).second) << word.path;
        EXPECT_TRUE(word.meaning.ends_with(".")) << word.meaning;
        EXPECT_FALSE(word.shape.empty());
    }
    EXPECT_THAT(flags, testing::IsSupersetOf({"--eye", "--view-height", "--param", "--light"}));
}

TEST(ViewWords, RangesAreTheSameForTextJsonAndTheViewItself) {
    for (const auto& word : viewWords()) {
        if (!word.value.range) continue;
        auto base = word.word == "viewHeight" ? test::orthographicView() : View{};
        const auto [least, most, must, code] = *word.value.range;
        for (const double value : {least, most, least / 2 - 1, 2 * most, std::nan("")}) {
            const bool legal = value >= least && value <= most;
            const nlohmann::json json = value < 0x1p63 && value == std::floor(value)
                                            ? nlohmann::json(std::int64_t(value))
                                            : nlohmann::json(value);
            if (legal && value == 0x1p64) continue;  // no whole number of 64 bits
            const auto dot = word.path.find('.');
            const auto changes =
                dot == std::string_view::npos
                    ? nlohmann::json{{word.path, json}}
                    : nlohmann::json{{word.path.substr(0, dot), {{word.path.substr(dot + 1), json}}}};
            EXPECT_EQ(applyJson(base, changes).has_value(), legal) << word.word << " " << json;
            EXPECT_EQ(applyWords(base, {{std::string(word.word), json.dump()}}).has_value(), legal)
                << word.word << " " << json;
        }
    }
}

TEST(ViewWords, EveryExampleChangesAView) {
    // A base that differs from every example, so that a word that did nothing would show.
    const auto base = test::richView();
    for (const auto& word : viewWords()) {
        std::string name(word.word), value(word.example);
        if (name == "param.NAME") {
            name = "param." + value.substr(0, value.find('='));
            value = value.substr(value.find('=') + 1);
        }
        View view = base;
        const auto result = applyWord(view, name, value);
        ASSERT_TRUE(result) << name << ": " << result.error().message;
        // A switch has two values only, and its example may be the base's.
        View plain;
        ASSERT_TRUE(applyWord(plain, name, value)) << name;
        if (name != "subsampling") {
            EXPECT_TRUE(view != base || plain != View{}) << name;
        }
        EXPECT_TRUE(validate(view)) << name;
    }
}

TEST(ViewWords, WordsAndJsonMeanTheSame) {
    const auto words = applied({{"eye", "1,2,3"},
                                {"target", "0,0,1"},
                                {"up", "0,1,0"},
                                {"fov", "45"},
                                {"near", "0.5"},
                                {"far", "auto"},
                                {"width", "640"},
                                {"height", "480"},
                                {"method", "cone"},
                                {"param.sizePx", "5"},
                                {"param.smooth", "true"},
                                {"param.footprint", "square"},
                                {"color", "#ff8800*intensity"},
                                {"exposure", "-0.5"},
                                {"colormap", "grey"},
                                {"range", "-1,1e3"},
                                {"classes", "6,2"},
                                {"clip", "0,0,0,1,2,3"},
                                {"clips", "-box:1,2,3,4,5,6,30;plane:0,0,1,0,0,-2"},
                                {"shading", "phong"},
                                {"light.ambient", "0.25"},
                                {"light.headlight", "1"},
                                {"light.sun", "-45,30.5"},
                                {"light.sunlight", "0.75"},
                                {"light.shine", "0"},
                                {"light.occlusion", "0.5"},
                                {"light.shadow", "1"},
                                {"mirrors", "false"},
                                {"behindMirrors", "true"},
                                {"outliers", "show"},
                                {"background", "#010203,#040506"},
                                {"with", "b,tint:#0102ff,shift:1:-2:3e-1,hidden;."},
                                {"detail", "2"},
                                {"budget", "1000"},
                                {"samples", "8"},
                                {"quality", "50"},
                                {"subsampling", "4:2:2"}});
    const auto json =
        applyJson(View{}, nlohmann::json::parse(R"({"camera": {"eye": [1,2,3], "target": [0,0,1],
        "up": [0,1,0], "fov": 45, "near": 0.5, "far": null}, "width": 640, "height": 480, "method": "cone",
        "param": {"sizePx": 5, "smooth": true, "footprint": "square"}, "color": "#ff8800*intensity",
        "exposure": -0.5, "colormap": "grey",
        "range": [-1, 1e3], "classes": [2, 6], "clip": {"min": [0,0,0], "max": [1,2,3]},
        "clips": [{"box": {"center": [1,2,3], "size": [4,5,6], "turn": [30,0,0]}, "keep": "outside"},
                  {"plane": {"point": [0,0,1], "normal": [0,0,-2]}}], "shading": "phong",
        "light": {"ambient": 0.25, "headlight": 1, "sun": [-45, 30.5], "sunlight": 0.75, "shine": 0, "occlusion": 0.5, "shadow": 1},
        "mirrors": false, "behindMirrors": true, "outliers": "show",
        "background": ["#010203", "#040506"],
        "with": [{"cloud": "b", "tint": "#0102ff", "shift": [1, -2, 0.3], "hidden": true}, {"cloud": "."}],
        "detail": 2, "budget": 1000, "samples": 8, "quality": 50,
        "subsampling": "4:2:2"})"));
    ASSERT_TRUE(json) << json.error().message;
    EXPECT_EQ(words, *json);
}

TEST(ViewWords, AColourMayBeMultipliedByIntensity) {
    for (const char* word :
         {"rgb*intensity", "elevation*intensity", "classification*intensity", "cloud*intensity", "#ff8800*intensity"}) {
        const View view = applied({{"color", word}});
        EXPECT_TRUE(view.style.byIntensity) << word;
        EXPECT_EQ(colorWord(view.style), word);
        EXPECT_FALSE(applied({{"color", "rgb"}}, view).style.byIntensity) << "the next colour ends it";
    }
    EXPECT_THAT(refused({{"color", "rgb*depth"}}).message, testing::HasSubstr("only intensity"));
    EXPECT_THAT(refused({{"color", "normal*intensity"}}).message, testing::HasSubstr("classification"));
}

TEST(ViewWords, HiddenPointsMayBeShown) {
    const View view = applied({{"color", "visibility"}});
    EXPECT_EQ(view.style.color, ColorSource::Visibility);
    EXPECT_EQ(colorWord(view.style), "visibility");
    EXPECT_THAT(refused({{"color", "visible"}}).message, testing::HasSubstr("visibility"));
    EXPECT_THAT(refused({{"color", "visibility*intensity"}}).message, testing::HasSubstr("classification"));
}

TEST(ViewWords, OneWordKeepsTheRest) {
    auto expected = test::richView();
    expected.camera.eye = {1, 2, 3};
    EXPECT_EQ(applied({{"eye", "1,2,3"}}, test::richView()), expected);
    EXPECT_EQ(applied({}, test::richView()), test::richView());
}

TEST(ViewWords, OrderIsOfNoImportance) {
    EXPECT_EQ(applied({{"param.sizePx", "5"}, {"method", "cone"}}),
              applied({{"method", "cone"}, {"param.sizePx", "5"}}));
    EXPECT_EQ(applied({{"method", "cone"}, {"param.sizePx", "5"}}, test::richView()).style.parameters,
              (ParameterValues{{"sizePx", 5.0}}));
}

TEST(ViewWords, AutoClears) {
    const auto view = applied({{"near", "auto"},
                               {"far", "auto"},
                               {"range", "auto"},
                               {"classes", "auto"},
                               {"clip", "auto"},
                               {"clips", "auto"},
                               {"with", "auto"},
                               {"exposure", "auto"},
                               {"shading", "auto"},
                               {"light.sun", "auto"},
                               {"detail", "auto"},
                               {"budget", "auto"},
                               {"samples", "auto"}},
                              test::richView());
    EXPECT_FALSE(view.camera.near || view.camera.far || view.style.range || view.style.classes ||
                 view.style.clip || !view.style.clips.empty() || view.style.exposure || view.style.shading ||
                 view.style.light.sun || view.quality.detail || view.quality.budget || view.quality.samples);
    EXPECT_TRUE(view.with.empty());
    EXPECT_EQ(applied({{"classes", "none"}}).style.classes, std::vector<std::uint8_t>{});
}

TEST(ViewWords, EyeEndsAMatrixAndBothAreRefused) {
    EXPECT_EQ(applied({{"eye", "9,9,9"}}, test::matrixView()).camera.viewMatrix, std::nullopt);
    EXPECT_EQ(refused({{"viewMatrix", "1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1"}, {"up", "0,1,0"}}).field,
              "viewMatrix");
}

TEST(ViewWords, WrongOnesNameTheWord) {
    const std::vector<std::pair<std::string, std::string>> cases{{"eye", ""},
                                                                 {"eye", "1,2"},
                                                                 {"eye", "1,2,3,4"},
                                                                 {"eye", "1,2,x"},
                                                                 {"eye", "1, 2,3"},
                                                                 {"eye", "1,,3"},
                                                                 {"eye", "1e999,0,0"},
                                                                 {"viewMatrix", "1,2,3"},
                                                                 {"projection", "isometric"},
                                                                 {"fov", "sixty"},
                                                                 {"fov", "60deg"},
                                                                 {"near", "none"},
                                                                 {"width", "0"},
                                                                 {"width", "-5"},
                                                                 {"width", "99999"},
                                                                 {"width", "1e3"},
                                                                 {"height", ""},
                                                                 {"method", ""},
                                                                 {"param.", "1"},
                                                                 {"param.a b", "1"},
                                                                 {"color", "mauve"},
                                                                 {"color", "#12"},
                                                                 {"color", "rgb*"},
                                                                 {"color", "rgb*elevation"},
                                                                 {"color", "mauve*intensity"},
                                                                 {"color", "auto*intensity"},
                                                                 {"color", "depth*intensity"},
                                                                 {"color", "rgb*intensity*intensity"},
                                                                 {"exposure", "4"},
                                                                 {"exposure", "bright"},
                                                                 {"colormap", "jet"},
                                                                 {"range", "1"},
                                                                 {"range", "2,1"},
                                                                 {"classes", "256"},
                                                                 {"classes", "2,,3"},
                                                                 {"clip", "0,0,0"},
                                                                 {"clip", "1,0,0,0,1,1"},
                                                                 {"shading", "flat"},
                                                                 {"light.ambient", "-0.1"},
                                                                 {"light.headlight", "2"},
                                                                 {"light.sun", "135"},
                                                                 {"light.sun", "361,40"},
                                                                 {"light.sun", "135,91"},
                                                                 {"light.sun", "nan,40"},
                                                                 {"light.sunlight", "bright"},
                                                                 {"light.shine", "auto"},
                                                                 {"mirrors", "off"},
                                                                 {"behindMirrors", ""},
                                                                 {"background", "blue"},
                                                                 {"background", "#000000,"},
                                                                 {"detail", "-1"},
                                                                 {"budget", "0"},
                                                                 {"budget", "99999999999999999999"},
                                                                 {"samples", "0"},
                                                                 {"samples", "4.5"},
                                                                 {"quality", "101"},
                                                                 {"subsampling", "411"}};
    for (const auto& [word, value] : cases) {
        const auto error = refused({{word, value}});
        EXPECT_EQ(error.code, ErrorCode::InvalidArgument) << word << "=" << value << ": " << error.message;
        EXPECT_EQ(error.field, word.starts_with("param.") ? "param" : word) << value << ": " << error.message;
    }
}

TEST(ViewWords, ImpossibleViewsAreAnotherError) {
    EXPECT_EQ(refused({{"eye", "nan,0,0"}}).code, ErrorCode::ImpossibleView);
    EXPECT_EQ(refused({{"eye", "inf,0,0"}}).code, ErrorCode::ImpossibleView);
    EXPECT_EQ(refused({{"eye", "0,0,0"}, {"target", "0,0,0"}}).code, ErrorCode::ImpossibleView);
    EXPECT_EQ(refused({{"fov", "180"}}).field, "fov");
}

TEST(ViewWords, UnknownAndRepeatedWordsAreRefused) {
    EXPECT_EQ(refused({{"fvo", "60"}}).message, "fvo: unknown; did you mean fov?");
    EXPECT_EQ(refused({{"light.ambiant", "1"}}).message,
              "light.ambiant: unknown; did you mean light.ambient?");
    EXPECT_EQ(refused({{"view-height", "60"}}).message, "view-height: unknown; did you mean viewHeight?");
    EXPECT_EQ(refused({{"fov", "60"}, {"fov", "60"}}).message, "\"fov\" is given twice");
    EXPECT_FALSE(applyWords({}, WordValues(257, {"fov", "60"})));
}

TEST(ViewWords, AnErrorLeavesTheViewAlone) {
    View view = test::richView();
    for (const auto& [word, value] :
         {std::pair{"eye", "1,2"}, {"color", "mauve"}, {"clip", "1"}, {"nope", "1"}})
        EXPECT_FALSE(applyWord(view, word, value));
    EXPECT_EQ(view, test::richView());
}

TEST(Query, DecodesAndSplits) {
    const auto words = parseQuery("eye=1%2C2,3&color=%23FF8800&flag&empty=&a=b=c&&x=1+1");
    ASSERT_TRUE(words) << words.error().message;
    EXPECT_EQ(*words, (WordValues{{"eye", "1,2,3"},
                                  {"color", "#FF8800"},
                                  {"flag", ""},
                                  {"empty", ""},
                                  {"a", "b=c"},
                                  {"x", "1+1"}}));
    EXPECT_TRUE(parseQuery("")->empty());
}

TEST(Query, RefusesWhatIsNone) {
    for (const auto* query : {"a=%", "a=%2", "a=%zz", "a=%00", "a=%0a", "%1f=1"}) {
        const auto words = parseQuery(query);
        ASSERT_FALSE(words) << query;
        EXPECT_EQ(words.error().code, ErrorCode::InvalidArgument);
    }
    EXPECT_FALSE(parseQuery("a\nb=1"));
    EXPECT_FALSE(parseQuery(std::string(16 * 1024 + 1, 'x')));
    std::string many;
    for (int i = 0; i < 257; ++i) many += "a=1&";
    EXPECT_FALSE(parseQuery(many));
}

TEST(Query, PercentDecode) {
    EXPECT_EQ(*percentDecode("a%20b%2Bc+d", "it"), "a b+c+d");
    EXPECT_EQ(*percentDecode("%e8%a6%b3", "it"), "観");
    for (const auto* text : {"%", "%1", "%g0"}) EXPECT_FALSE(percentDecode(text, "it")) << text;
    EXPECT_EQ(
        percentDecode("%", "The address").error().message,
        "The address has a % that is not followed by two hexadecimal digits; a literal % is written %25");
}

TEST(Query, RoundTripOfEveryPrintableByte) {
    std::string value;
    for (int c = 0x20; c < 0x100; ++c)
        if (c != 0x7F) value += static_cast<char>(c);
    const WordValues words{{"eye", "1,2,3"}, {value, value}};
    EXPECT_EQ(*parseQuery(printQuery(words)), words);
    EXPECT_EQ(printQuery({{"eye", "1,-2,3.5"}, {"color", "#ff8800"}}), "eye=1,-2,3.5&color=%23ff8800");
}

}  // namespace
}  // namespace scancast
