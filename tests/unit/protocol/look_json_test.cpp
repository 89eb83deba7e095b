// Looks are read back as they were printed; what a look cannot be is refused, and named by its path.
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "tests/unit/protocol/sample_looks.hpp"

namespace scancast {
namespace {

using nlohmann::json;

TEST(LookJson, ReadsBackExactly) {
    for (const Look& look : {test::richLook(), test::plainLook()}) {
        const auto text = parseJson(printJson(toJson(look)));
        ASSERT_TRUE(text) << text.error().message;
        const auto back = applyLook(Look{}, *text);
        ASSERT_TRUE(back) << back.error().message;
        EXPECT_EQ(*back, look);
        EXPECT_TRUE(validate(*back));
        // All is said, so that nothing of what it is applied to stays.
        EXPECT_EQ(applyLook(test::richLook(), *text), look);
        EXPECT_EQ(applyLook(test::plainLook(), *text), look);
    }
}

TEST(LookJson, EveryKindHasItsName) {
    for (std::size_t k = 0; k < sceneKindNames.size(); ++k) {
        const auto look = applyLook(test::richLook(), {{"kind", sceneKindNames[k]}});
        ASSERT_TRUE(look);
        EXPECT_EQ(look->kind, SceneKind(k));
        EXPECT_EQ(toJson(*look).at("kind"), sceneKindNames[k]);
    }
}

// Right because the rest is compared as a whole: each change is made by hand in a copy.
TEST(LookJson, ChangesLeaveTheRestAlone) {
    const auto changed = [](const json& changes) { return applyLook(test::richLook(), changes).value(); };
    Look wanted = test::richLook();
    EXPECT_EQ(changed(json::object()), wanted);
    wanted.reason = "because";
    EXPECT_EQ(changed({{"reason", "because"}}), wanted);
    wanted = test::richLook();
    wanted.style.shading = Shading::EyeDome;
    wanted.style.exposure = std::nullopt;
    EXPECT_EQ(changed({{"style", {{"shading", "eyedome"}, {"exposure", nullptr}}}}), wanted);
    wanted = test::richLook();
    wanted.bounds[1] = {9, 6e6, 9};
    EXPECT_EQ(changed({{"bounds", {{"max", {9, 6e6, 9}}}}}), wanted);
    wanted = test::richLook();
    wanted.views = {{"here", false, Camera{}}};
    wanted.views[0].camera.eye = {1, 2, 3};
    wanted.views[0].camera.target = {4, 5, 6};
    EXPECT_EQ(
        changed({{"views", {{{"name", "here"}, {"camera", {{"eye", {1, 2, 3}}, {"target", {4, 5, 6}}}}}}}}),
        wanted);
    wanted = test::richLook();
    wanted.outline = {{7, 8, 9}};
    wanted.noise = 0;
    EXPECT_EQ(changed({{"outline", {{7, 8, 9}}}, {"noise", 0}}), wanted);
}

TEST(LookJson, WhatItCannotBeIsNamed) {
    json view = toJson(test::plainLook()).at("views").at(0);
    const auto without = [view](const char* key) {
        json v = view;
        v.erase(key);
        return v;
    };
    const auto with = [view](const char* key, const json& value) {
        json v = view;
        v[key] = value;
        return v;
    };
    const std::vector<std::pair<const char*, json>> wrong{
        {"kind", {{"kind", "landscape"}}},
        {"kind", {{"kind", 3}}},
        {"reason", {{"reason", 7}}},
        {"reason", {{"reason", std::string(5000, 'x')}}},
        {"up", {{"up", {0, 0, 2}}}},
        {"up", {{"up", {0, 0, 0}}}},
        {"up", {{"up", {0, 1}}}},
        {"up", {{"up", "z"}}},
        {"bounds", {{"bounds", {1, 2}}}},
        {"bounds", {{"bounds", {{"min", {1, 1, 1}}, {"max", {2, 0, 2}}}}}},
        {"bounds.min", {{"bounds", {{"min", {1, 1, "one"}}}}}},
        {"bounds.size", {{"bounds", {{"size", {1, 1, 1}}}}}},
        {"outline", {{"outline", json::array()}}},
        {"outline", {{"outline", 5}}},
        {"outline", {{"outline", {{1, 2}}}}},
        {"outline", {{"outline", {{1, 2, "3"}}}}},
        {"outline", {{"outline", json(257, json{1, 2, 3})}}},
        {"noise", {{"noise", -0.1}}},
        {"noise", {{"noise", "loud"}}},
        {"style", {{"style", "plain"}}},
        {"style", {{"style", {{"width", 100}}}}},
        {"style", {{"style", {{"camera", view.at("camera")}}}}},
        {"style", {{"style", {{"subsampling", "4:2:0"}}}}},
        {"style", {{"style", {{"shading", "dark"}}}}},
        {"style", {{"style", {{"range", {2, 1}}}}}},
        {"style", {{"style", {{"exposure", 4}}}}},
        {"views", {{"views", json::array()}}},
        {"views", {{"views", json(7, view)}}},
        {"views", {{"views", view}}},
        {"views[0]", {{"views", {"top"}}}},
        {"views[0].camera", {{"views", {without("camera")}}}},
        {"views[1].camera", {{"views", {view, with("camera", {{"eye", {1, 1, 1}}, {"target", {1, 1, 1}}})}}}},
        {"views[0].camera", {{"views", {with("camera", 5)}}}},
        {"views[0].camera", {{"views", {with("camera", {{"fov", 180}})}}}},
        {"views[0].name", {{"views", {with("name", 5)}}}},
        {"views[0].name", {{"views", {with("name", std::string(65, 'x'))}}}},
        {"views[0].inside", {{"views", {with("inside", "yes")}}}},
        {"views[0].style", {{"views", {with("style", json::object())}}}},
        {"colour", {{"colour", "rgb"}}},
        {"", json::array()},
        {"", json("airborne")},
        {"", json(nullptr)},
    };
    for (const auto& [path, changes] : wrong) {
        const auto look = applyLook(test::richLook(), changes);
        ASSERT_FALSE(look) << changes.dump();
        EXPECT_TRUE(look.error().field.starts_with(path)) << look.error().field << " for " << changes.dump();
        EXPECT_EQ(look.error().field.empty(), *path == '\0') << changes.dump();
        EXPECT_FALSE(look.error().message.empty());
    }
}

// Looks stand in cloud files: what older programs do not know would make them refuse the file.
TEST(LookJson, HasNoWordThatOlderProgramsDoNotKnowWhereItSaysNothing) {
    std::vector<std::string> keys;
    const json look = toJson(test::plainLook());
    for (const auto& word : look["style"].items()) keys.push_back(word.key());
    EXPECT_EQ(keys, (std::vector<std::string>{"background", "behindMirrors", "classes", "clip", "clips",
                                              "color", "colormap", "exposure", "light", "method", "mirrors",
                                              "outliers", "param", "range", "shading"}));
    Look filtered = test::plainLook();
    filtered.style.filter = {{"distance", 1.0, {}}};
    filtered.style.color = ColorSource::Column;
    filtered.style.column = "distance";
    const auto again = applyLook(Look{}, toJson(filtered));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->style, filtered.style);
    const auto refused = applyLook(test::plainLook(), {{"style", {{"with", nullptr}}}});
    ASSERT_FALSE(refused) << "other clouds are the view's";
    EXPECT_EQ(refused.error().field, "style");
}

TEST(LookJson, WithoutViewOrOutlineNothingCanBeShown) {
    EXPECT_TRUE(validate(test::plainLook()));
    EXPECT_FALSE(validate(Look{}));
    Look look = test::plainLook();
    look.views.clear();
    EXPECT_EQ(validate(look).error().field, "views");
    look = test::plainLook();
    look.outline.clear();
    EXPECT_EQ(validate(look).error().field, "outline");
}

}  // namespace
}  // namespace scancast
