#include "protocol/view/view.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "sample_views.hpp"

namespace scancast {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

struct Refused {
    ErrorCode code;
    const char* field;
    std::function<void(View&)> change;
};

TEST(View, SoundOnesPass) {
    for (const auto& view : test::sampleViews())
        EXPECT_TRUE(validate(view)) << validate(view).error().message;
}

TEST(View, EachWrongValueIsRefusedByItsWord) {
    const auto impossible = ErrorCode::ImpossibleView, invalid = ErrorCode::InvalidArgument;
    const std::vector<Refused> cases{
        {impossible, "target", [](View& v) { v.camera.target = v.camera.eye; }},
        {impossible, "eye", [](View& v) { v.camera.eye.x = nan; }},
        {impossible, "target", [](View& v) { v.camera.target.y = infinity; }},
        {impossible, "eye", [](View& v) { v.camera.eye.z = 1e300; }},
        {impossible, "up",
         [](View& v) {
             v.camera.up = {0, 0, 0};
         }},
        {impossible, "up",
         [](View& v) {
             v.camera.up = {0, -7, 0};
         }},
        {impossible, "up", [](View& v) { v.camera.up.z = nan; }},
        {impossible, "fov", [](View& v) { v.camera.fov = 0; }},
        {impossible, "fov", [](View& v) { v.camera.fov = 180; }},
        {impossible, "fov", [](View& v) { v.camera.fov = -60; }},
        {impossible, "fov", [](View& v) { v.camera.fov = nan; }},
        {impossible, "near", [](View& v) { v.camera.near = 0; }},
        {impossible, "near", [](View& v) { v.camera.near = nan; }},
        {impossible, "far", [](View& v) { v.camera.far = -1; }},
        {impossible, "near", [](View& v) { v.camera.near = 2, v.camera.far = 2; }},
        {invalid, "width", [](View& v) { v.width = 0; }},
        {invalid, "height", [](View& v) { v.height = 16385; }},
        {invalid, "method", [](View& v) { v.style.method = ""; }},
        {invalid, "param", [](View& v) { v.style.parameters["a b"] = 1.0; }},
        {invalid, "param.size", [](View& v) { v.style.parameters["size"] = nan; }},
        {invalid, "param.size", [](View& v) { v.style.parameters["size"] = std::string(257, 'x'); }},
        {invalid, "color", [](View& v) { v.style.color = ColorSource::Normal, v.style.byIntensity = true; }},
        {invalid, "color", [](View& v) { v.style.color = ColorSource::Auto, v.style.byIntensity = true; }},
        {invalid, "exposure", [](View& v) { v.style.exposure = nan; }},
        {invalid, "colormap", [](View& v) { v.style.colormap = "rainbow"; }},
        {invalid, "range",
         [](View& v) {
             v.style.range = {1, 1};
         }},
        {invalid, "range",
         [](View& v) {
             v.style.range = {0, nan};
         }},
        {invalid, "clip",
         [](View& v) {
             v.style.clip = ClipBox{{0, 0, 1}, {1, 1, 0}};
         }},
        {impossible, "clip",
         [](View& v) {
             v.style.clip = ClipBox{{0, 0, 0}, {1, nan, 1}};
         }},
        {impossible, "clips",
         [](View& v) {
             v.style.clips = {TurnedBox{{0, nan, 0}, {1, 1, 1}}};
         }},
        {impossible, "clips",
         [](View& v) {
             v.style.clips = {HalfSpace{{0, 0, 0}, {0, 0, nan}}};
         }},
        {invalid, "clips",
         [](View& v) {
             v.style.clips = {HalfSpace{}, TurnedBox{{0, 0, 0}, {1, -1, 1}}};
         }},
        {invalid, "clips",
         [](View& v) {
             v.style.clips = {TurnedBox{{0, 0, 0}, {1, 1, 1}, {0, 361, 0}}};
         }},
        {invalid, "clips", [](View& v) { v.style.clips.assign(mostClipShapes + 1, HalfSpace{}); }},
        {invalid, "detail", [](View& v) { v.quality.detail = -0.1; }},
        {invalid, "detail", [](View& v) { v.quality.detail = nan; }},
        {invalid, "budget", [](View& v) { v.quality.budget = 0; }},
        {invalid, "samples", [](View& v) { v.quality.samples = 65; }},
        {invalid, "quality", [](View& v) { v.quality.jpegQuality = 0; }},
    };
    for (std::size_t i = 0; i < cases.size(); ++i) {
        View view;
        cases[i].change(view);
        const auto result = validate(view);
        ASSERT_FALSE(result) << "case " << i << ", " << cases[i].field;
        EXPECT_EQ(result.error().code, cases[i].code) << "case " << i << ": " << result.error().message;
        EXPECT_EQ(result.error().field, cases[i].field) << "case " << i << ": " << result.error().message;
        EXPECT_FALSE(result.error().message.empty());
    }
}

TEST(View, OrthographicNeedsAHeightAndNoFov) {
    auto view = test::orthographicView();
    view.camera.fov = 500;
    EXPECT_TRUE(validate(view));
    view.camera.viewHeight = 0;
    ASSERT_FALSE(validate(view));
    EXPECT_EQ(validate(view).error().field, "viewHeight");
}

TEST(View, MatrixMustBeARigidMotion) {
    // Scaling, mirroring, shearing and transposing are the four ways in which clients get it wrong.
    const auto wrong = [](std::function<void(std::array<double, 16>&)> change) {
        auto view = test::matrixView();
        change(*view.camera.viewMatrix);
        const auto result = validate(view);
        return !result && result.error().code == ErrorCode::ImpossibleView &&
               result.error().field == "viewMatrix";
    };
    EXPECT_TRUE(wrong([](auto& m) { m[0] = 2; }));
    EXPECT_TRUE(wrong([](auto& m) { m[0] = -1; }));
    EXPECT_TRUE(wrong([](auto& m) { m[1] = 0.5; }));
    EXPECT_TRUE(wrong([](auto& m) { std::swap(m[3], m[12]), std::swap(m[11], m[14]); }));
    EXPECT_TRUE(wrong([](auto& m) { m[13] = nan; }));
    EXPECT_TRUE(wrong([](auto& m) { m.fill(0); }));
}

TEST(View, MatrixReplacesEyeTargetAndUp) {
    auto view = test::matrixView();
    view.camera.eye = view.camera.target;
    EXPECT_TRUE(validate(view));
}

TEST(View, TinyVectorsStillHaveADirection) {
    View view;
    view.camera.up = {0, 0, 1e-200};
    EXPECT_TRUE(validate(view));
    view.camera.target = {0, 0, 0};
    view.camera.eye = {1e-250, 0, 0};
    EXPECT_TRUE(validate(view));
}

}  // namespace
}  // namespace scancast
