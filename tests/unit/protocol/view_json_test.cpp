#include "protocol/view/view_json.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "sample_views.hpp"

namespace scancast {
namespace {

using nlohmann::json;

View applied(const View& base, const char* text) {
    const auto view = applyJson(base, json::parse(text));
    if (view) return *view;
    ADD_FAILURE() << text << ": " << view.error().message;
    return base;
}

Error refused(const char* text, const View& base = {}) {
    const auto view = applyJson(base, json::parse(text));
    if (!view) return view.error();
    ADD_FAILURE() << "accepted: " << text;
    return {};
}

TEST(ViewJson, RoundTripIsExact) {
    // Fields without influence (fov of an orthographic camera) are not printed, so the text is what must come
    // back.
    for (const auto& view : test::sampleViews())
        for (const auto& base : test::sampleViews()) {
            const auto text = printJson(toJson(view));
            const auto back = applyJson(base, *parseJson(text));
            ASSERT_TRUE(back) << back.error().message;
            EXPECT_EQ(printJson(toJson(*back)), text);
        }
}

TEST(ViewJson, NothingIsLostWhereEverythingMatters) {
    const auto view = test::richView();
    EXPECT_EQ(*applyJson(View{}, toJson(view)), view);
}

TEST(ViewJson, CanonicalTextIsFixed) {
    EXPECT_EQ(
        printJson(toJson(View{})),
        R"({"background":["#3a424e","#16191e"],"behindMirrors":false,"budget":null,"camera":{"eye":[0.0,-1.0,0.0],"far":null,)"
        R"("fov":60.0,"near":null,"target":[0.0,0.0,0.0],"type":"perspective","up":[0.0,0.0,1.0]},)"
        R"("classes":null,"clip":null,"clips":null,"color":"auto","colormap":"viridis","detail":null,"exposure":null,"filter":null,"height":720,)"
        R"("light":{"ambient":0.5,"headlight":0.5,"occlusion":null,"shadow":0.0,"shine":0.08,"sun":null,"sunlight":0.5},)"
        R"("method":"auto","mirrors":true,"outliers":"hide","param":{},"quality":90,"range":null,"samples":null,"shading":null,)"
        R"("subsampling":"4:2:0","width":1280,"with":null})")
        << "A new word? Put it here, in the order of the alphabet.";
}

TEST(ViewJson, SubsetsKeepTheRest) {
    const auto base = test::richView();
    EXPECT_EQ(applied(base, "{}"), base);

    auto wider = base;
    wider.width = 2000;
    EXPECT_EQ(applied(base, R"({"width": 2000})"), wider);
    EXPECT_EQ(applied(base, R"({"width": 2000.0})"), wider);

    auto dimmed = base;
    dimmed.style.light.ambient = 0.75;
    EXPECT_EQ(applied(base, R"({"light": {"ambient": 0.75}})"), dimmed);

    auto moved = base;
    moved.camera.eye = {1, 2, 3};
    EXPECT_EQ(applied(base, R"({"camera": {"eye": [1, 2, 3]}})"), moved);
}

TEST(ViewJson, NullRestoresTheAutomaticValue) {
    const auto view = applied(test::richView(), R"({"camera": {"near": null, "far": null}, "range": null,
        "classes": null, "clip": null, "clips": null, "filter": null, "exposure": null, "shading": null, "light": {"sun": null}, "background": null, "detail": null, "budget": null,
        "samples": null, "with": null})");
    EXPECT_EQ(view.camera.near, std::nullopt);
    EXPECT_EQ(view.camera.far, std::nullopt);
    EXPECT_EQ(view.style.range, std::nullopt);
    EXPECT_EQ(view.style.classes, std::nullopt);
    EXPECT_EQ(view.style.clip, std::nullopt);
    EXPECT_TRUE(view.style.clips.empty());
    EXPECT_TRUE(view.style.filter.empty());
    EXPECT_EQ(view.style.exposure, std::nullopt);
    EXPECT_EQ(view.style.shading, std::nullopt);
    EXPECT_EQ(view.style.light.sun, std::nullopt);
    EXPECT_EQ(view.style.background, Background{});
    EXPECT_EQ(view.quality.detail, std::nullopt);
    EXPECT_EQ(view.quality.budget, std::nullopt);
    EXPECT_EQ(view.quality.samples, std::nullopt);
    EXPECT_TRUE(view.with.empty());
}

TEST(ViewJson, OneFormOfTheCameraEndsTheOther) {
    const auto matrix = test::matrixView();
    EXPECT_EQ(applied(matrix, R"({"camera": {"eye": [5, 5, 5]}})").camera.viewMatrix, std::nullopt);
    EXPECT_EQ(applied(matrix, R"({"camera": {"viewMatrix": null}})").camera.viewMatrix, std::nullopt);
    EXPECT_EQ(applied(matrix, R"({"camera": {"fov": 50}})").camera.viewMatrix, matrix.camera.viewMatrix);
    EXPECT_EQ(applied(View{}, R"({"camera": {"viewMatrix": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}})")
                  .camera.viewMatrix->at(0),
              1);
    for (const auto* text :
         {R"({"camera": {"eye": [1,2,3], "viewMatrix": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}})",
          R"({"camera": {"up": [0,1,0], "viewMatrix": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}})"})
        EXPECT_EQ(refused(text).field, "camera.viewMatrix");
}

TEST(ViewJson, MethodDropsParametersAndParamAdds) {
    const auto base = test::richView();
    EXPECT_TRUE(applied(base, R"({"method": "point"})").style.parameters.empty());
    const auto added = applied(base, R"({"param": {"scale": 2, "smooth": null}})").style.parameters;
    EXPECT_EQ(added,
              (ParameterValues{{"footprint", std::string("square")}, {"scale", 2.0}, {"sizePx", 5.5}}));
    EXPECT_EQ(applied(base, R"({"param": {"smooth": false}, "method": "cone"})").style.parameters,
              (ParameterValues{{"smooth", false}}));
}

TEST(ViewJson, ClassesAreASet) {
    EXPECT_EQ(applied(View{}, R"({"classes": [6, 2, 6]})"), applied(View{}, R"({"classes": [2, 6]})"));
    EXPECT_EQ(applied(View{}, R"({"classes": []})").style.classes, std::vector<std::uint8_t>{});
}

TEST(ViewJson, UnknownFieldsNameTheirPathAndTheNearestName) {
    EXPECT_EQ(refused(R"({"camera": {"fvo": 50}})").message, "camera.fvo: unknown; did you mean fov?");
    EXPECT_EQ(refused(R"({"camera": {"fvo": 50}})").field, "camera.fvo");
    EXPECT_EQ(refused(R"({"colour": "rgb"})").message, "colour: unknown; did you mean color?");
    EXPECT_EQ(refused(R"({"clip": {"min": [0,0,0], "max": [1,1,1], "mid": 1}})").field, "clip.mid");
    EXPECT_NE(refused(R"({"qqqqqqq": 1})").message.find("known are camera, width"), std::string::npos);
}

TEST(ViewJson, WrongTypesAndValuesNameTheirPath) {
    const std::vector<std::pair<const char*, const char*>> cases{
        {R"([])", ""},
        {R"(17)", ""},
        {R"({"camera": 5})", "camera"},
        {R"({"camera": null})", "camera"},
        {R"({"camera": {"type": "fisheye"}})", "camera.type"},
        {R"({"camera": {"eye": [1, 2]}})", "camera.eye"},
        {R"({"camera": {"eye": [1, 2, "3"]}})", "camera.eye"},
        {R"({"camera": {"eye": null}})", "camera.eye"},
        {R"({"camera": {"fov": "60"}})", "camera.fov"},
        {R"({"camera": {"viewMatrix": [1, 2, 3]}})", "camera.viewMatrix"},
        {R"({"width": -1})", "width"},
        {R"({"width": 0})", "width"},
        {R"({"width": 12.5})", "width"},
        {R"({"width": "wide"})", "width"},
        {R"({"height": 16385})", "height"},
        {R"({"method": 5})", "method"},
        {R"({"param": [1]})", "param"},
        {R"({"param": {"sizePx": [1]}})", "param"},
        {R"({"param": {"": 1}})", "param"},
        {R"({"color": "mauve"})", "color"},
        {R"({"color": "#12345"})", "color"},
        {R"({"color": "intensity*intensity"})", "color"},
        {R"({"exposure": 3.5})", "exposure"},
        {R"({"colormap": "jet"})", "colormap"},
        {R"({"range": [1]})", "range"},
        {R"({"range": [2, 1]})", "range"},
        {R"({"classes": 2})", "classes"},
        {R"({"classes": [256]})", "classes"},
        {R"({"classes": [-1]})", "classes"},
        {R"({"classes": [1.5]})", "classes"},
        {R"({"clip": {"min": [0,0,0]}})", "clip.max"},
        {R"({"clip": [0,0,0,1,1,1]})", "clip"},
        {R"({"filter": "gps_time:1..2"})", "filter"},
        {R"({"filter": [1]})", "filter[0]"},
        {R"({"filter": [{"low": 1}]})", "filter[0].column"},
        {R"({"filter": [{"column": "a", "low": "1"}]})", "filter[0].low"},
        {R"({"filter": [{"column": "a", "low": 1, "most": 2}]})", "filter[0].most"},
        {R"({"filter": [{"column": "a"}]})", "filter"},
        {R"({"filter": [{"column": "", "low": 1}]})", "filter"},
        {R"({"filter": [{"column": "a", "low": 2, "high": 1}]})", "filter"},
        {R"({"filter": [{"column":"a","low":1},{"column":"a","low":1},{"column":"a","low":1},{"column":"a","low":1},{"column":"a","low":1}]})",
         "filter"},
        {R"({"color": "column:"})", "color"},
        {R"({"with": {}})", "with"},
        {R"({"with": "b"})", "with"},
        {R"({"with": [1]})", "with[0]"},
        {R"({"with": [{}]})", "with[0].cloud"},
        {R"({"with": [{"cloud": ""}]})", "with"},
        {R"({"with": [{"cloud": "b"}, {"cloud": "c", "shift": [1, 2]}]})", "with[1].shift"},
        {R"({"with": [{"cloud": "b", "tint": "red"}]})", "with[0].tint"},
        {R"({"with": [{"cloud": "b", "hidden": 1}]})", "with[0].hidden"},
        {R"({"with": [{"cloud": "b", "color": "#ffffff"}]})", "with[0].color"},
        {R"({"clips": {}})", "clips"},
        {R"({"clips": "box:0,0,0,1,1,1"})", "clips"},
        {R"({"clips": [1]})", "clips[0]"},
        {R"({"clips": [{}]})", "clips[0].box"},
        {R"({"clips": [{"box": {"center": [0,0,0]}}]})", "clips[0].box.size"},
        {R"({"clips": [{"box": {"center": [0,0,0], "size": [1,1,1], "turn": 30}}]})", "clips[0].box.turn"},
        {R"({"clips": [{"box": {"center": [0,0,0], "size": [1,0,1]}}]})", "clips"},
        {R"({"clips": [{"box": {"center": [0,0,0], "size": [1,1,1]}, "keep": "some"}]})", "clips[0].keep"},
        {R"({"clips": [{"box": {"center": [0,0,0], "size": [1,1,1], "yaw": 3}}]})", "clips[0].box.yaw"},
        {R"({"clips": [{"plane": {"point": [0,0,0], "normal": [0,0,1]}}, {"plane": {"point": [0,0,0]}}]})",
         "clips[1].plane.normal"},
        {R"({"clips": [{"plane": {"point": [0,0,0], "normal": [0,0,1]}, "keep": "inside"}]})",
         "clips[0].keep"},
        {R"({"clips": [{"plane": {"point": [0,0,0], "normal": [0,0,0]}}]})", "clips"},
        {R"({"clips": [{"plane": {}, "box": {}}]})", "clips[0].plane"},
        {R"({"shading": "gouraud"})", "shading"},
        {R"({"light": 1})", "light"},
        {R"({"light": null})", "light"},
        {R"({"light": {"ambient": 1.5}})", "light.ambient"},
        {R"({"light": {"ambient": null}})", "light.ambient"},
        {R"({"light": {"sun": [90]}})", "light.sun"},
        {R"({"light": {"sun": [90, -1]}})", "light.sun"},
        {R"({"light": {"suns": [90, 1]}})", "light.suns"},
        {R"({"mirrors": 1})", "mirrors"},
        {R"({"behindMirrors": null})", "behindMirrors"},
        {R"({"background": "#12"})", "background"},
        {R"({"background": ["#000000"]})", "background"},
        {R"({"background": {}})", "background"},
        {R"({"detail": "fine"})", "detail"},
        {R"({"budget": 0})", "budget"},
        {R"({"budget": 1e300})", "budget"},
        {R"({"samples": 65})", "samples"},
        {R"({"quality": 101})", "quality"},
        {R"({"subsampling": "4:1:1"})", "subsampling"},
    };
    for (const auto& [text, field] : cases) {
        const auto error = refused(text);
        EXPECT_EQ(error.code, ErrorCode::InvalidArgument) << text << ": " << error.message;
        EXPECT_EQ(error.field, field) << text << ": " << error.message;
    }
}

TEST(ViewJson, ImpossibleViewsNameTheJsonPath) {
    const auto error = refused(R"({"camera": {"eye": [1,1,1], "target": [1,1,1]}})");
    EXPECT_EQ(error.code, ErrorCode::ImpossibleView);
    EXPECT_EQ(error.field, "camera.target");
    EXPECT_EQ(refused(R"({"camera": {"fov": 180}})").field, "camera.fov");
}

TEST(ViewJson, NotANumberIsNoView) {
    json changes = {{"camera", {{"eye", {0.0, std::nan(""), 0.0}}}}};
    const auto view = applyJson(View{}, changes);
    ASSERT_FALSE(view);
    EXPECT_EQ(view.error().code, ErrorCode::ImpossibleView);
}

TEST(ViewJson, HugeArraysAreRefusedWithoutBeingCopied) {
    const json huge(1'000'000, 1);
    for (const auto* field : {"classes", "range", "background", "param", "clip", "clips", "with"})
        EXPECT_FALSE(applyJson(View{}, json{{field, huge}})) << field;
    EXPECT_FALSE(applyJson(View{}, json{{"camera", {{"eye", huge}}}}));
    EXPECT_FALSE(applyJson(View{}, json{{"camera", {{"viewMatrix", huge}}}}));
}

TEST(ViewJson, LongNamesStayShortInMessages) {
    json changes;
    changes[std::string(50'000, 'x')] = 1;
    const auto view = applyJson(View{}, changes);
    ASSERT_FALSE(view);
    EXPECT_LT(view.error().message.size(), 1000u);
}

}  // namespace
}  // namespace scancast
