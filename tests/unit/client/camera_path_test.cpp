#include "client/cpp/camera_path.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>

namespace scancast::client {
namespace {

View baseView() {
    View view;
    view.camera.eye = {9, 9, 9};
    view.camera.target = {1, 2, 3};
    return view;
}

CameraPath parsed(const std::string& json) {
    auto path = parseCameraPath(json, baseView());
    EXPECT_TRUE(path) << path.error().message;
    return path.value_or(CameraPath{});
}

const std::string three = R"({"view": {"method": "disc", "width": 100}, "keys": [
    {"time": 10, "camera": {"eye": [0, 0, 0], "fov": 30}},
    {"time": 12, "camera": {"eye": [4, 0, 0]}},
    {"time": 13, "camera": {"eye": [4, 3, 0], "target": [1, 2, 4], "fov": 60}}]})";

TEST(CameraPath, PassesThroughItsKeysAndWhatIsNotGivenIsAsBefore) {
    const auto path = parsed(three);
    EXPECT_EQ(path.begin(), 10);
    EXPECT_EQ(path.seconds(), 3);
    EXPECT_EQ(path.view.style.method, "disc");
    EXPECT_EQ(path.view.width, 100);
    EXPECT_EQ(path.keys[1].camera.fov, 30);
    EXPECT_EQ(path.keys[1].camera.target, glm::dvec3(1, 2, 3));
    for (const auto& key : path.keys) {
        const auto view = path.at(key.time);
        EXPECT_LT(glm::distance(view.camera.eye, key.camera.eye), 1e-12);
        EXPECT_LT(glm::distance(view.camera.target, key.camera.target), 1e-12);
        EXPECT_NEAR(view.camera.fov, key.camera.fov, 1e-12);
        EXPECT_EQ(view.style.method, "disc");
    }
    EXPECT_EQ(path.at(-5).camera.eye, glm::dvec3(0));
    EXPECT_LT(glm::distance(path.at(99).camera.eye, {4, 3, 0}), 1e-12);
    EXPECT_NEAR(path.at(12.5).camera.fov, 45, 1e-12);
}

// Oracle: differences of positions. Where speed jumps, those before and after a key differ by a fixed amount
// however near they are taken.
TEST(CameraPath, SpeedDoesNotJumpAtAKey) {
    const auto path = parsed(three);
    const double h = 1e-5;
    const auto eye = [&](double time) { return path.at(time).camera.eye; };
    const auto before = (eye(12) - eye(12 - h)) / h, after = (eye(12 + h) - eye(12)) / h;
    EXPECT_LT(glm::distance(before, after), 1e-3);
    EXPECT_GT(glm::length(before), 0.5) << "it does not stop there either";
}

// Oracle: what moves evenly along a line does so between keys that are not evenly spaced in time, too.
TEST(CameraPath, EvenMotionStaysEven) {
    const auto path = parsed(R"({"keys": [{"time": 0, "camera": {"eye": [0, 0, 0]}},
        {"time": 1, "camera": {"eye": [2, 0, 0]}}, {"time": 4, "camera": {"eye": [8, 0, 0]}},
        {"time": 5, "camera": {"eye": [10, 0, 0]}}]})");
    for (double time = 0; time <= 5; time += 0.125)
        EXPECT_NEAR(path.at(time).camera.eye.x, 2 * time, 1e-12) << time;
}

TEST(CameraPath, WithoutTimesKeysAreASecondApart) {
    const auto path =
        parsed(R"({"keys": [{}, {"camera": {"eye": [1, 1, 1]}}, {"camera": {"eye": [2, 1, 1]}}]})");
    EXPECT_EQ(path.seconds(), 2);
    EXPECT_EQ(path.keys[0].camera, baseView().camera);
}

TEST(CameraPath, ErrorsNameTheField) {
    for (const auto& [json, field] : std::vector<std::pair<std::string, std::string>>{
             {"[]", ""},
             {"{", ""},
             {"{}", "keys"},
             {R"({"keys": 3})", "keys"},
             {R"({"keys": []})", "keys"},
             {R"({"keys": [{}]})", "keys"},
             {R"({"keys": [1, 2]})", "keys[0]"},
             {R"({"keys": [{}, {}], "kyes": 1})", "kyes"},
             {R"({"keys": [{}, {"tiem": 1}]})", "keys[1].tiem"},
             {R"({"keys": [{"time": 1}, {"time": 1}]})", "keys[1].time"},
             {R"({"keys": [{}, {"camera": {"fvo": 1}}]})", "keys[1].camera.fvo"},
             {R"({"keys": [{}, {"camera": {"type": "orthographic"}}]})", "keys[1].camera.type"},
             {R"({"keys": [{}, {"camera": {"viewMatrix": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,-10,1]}}]})",
              "keys[1].camera.viewMatrix"},
             {R"({"keys": [{}, {}], "view": {"widht": 1}})", "view.widht"}}) {
        const auto path = parseCameraPath(json, baseView());
        ASSERT_FALSE(path) << json;
        EXPECT_EQ(path.error().field, field) << json << ": " << path.error().message;
    }
}

TEST(CameraPath, TheExampleIsOne) {
    std::ifstream file(SCANCAST_SOURCE_DIR "/client/cpp/example/flight.json");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    EXPECT_EQ(parsed(text).keys.size(), 3U);
}

}  // namespace
}  // namespace scancast::client
