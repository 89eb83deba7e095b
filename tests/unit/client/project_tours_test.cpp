// Project files as the page writes them, and as anybody may send them.
#include "client/cpp/program/tour/project_tours.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace scancast::client {
namespace {

nlohmann::json whole() {
    return nlohmann::json::parse(R"({
        "format": "scancast-project", "version": 1, "cloud": {"id": "town", "title": "Old town"}, "measures": [{"kind": "later"}],
        "views": [{"name": "south", "view": "cloud=town&eye=0,-9,0&target=0,0,0&method=disc&upAxis=y&present"},
                  {"name": "east", "view": "eye=9,0,0&target=0,0,0&fov=40"}],
        "tours": [{"name": "There and back", "views": ["south", "east", "south"], "seconds": 3, "pause": 0.5, "loop": false},
                  {"name": "All", "later": 7}], "later": [[]]})");
}

Error refused(const nlohmann::json& file) {
    const auto project = parseProjectTours(file.dump());
    EXPECT_FALSE(project) << file.dump();
    return project ? Error{} : project.error();
}

TEST(ProjectTours, ViewsAndToursAreReadAndTheRestIsLeftAlone) {
    // A word without a value is no query's.
    auto file = whole();
    file["views"][0]["view"] = "cloud=town&eye=0,-9,0&target=0,0,0&method=disc&upAxis=y&measures=d3.1";
    const auto project = parseProjectTours(file.dump());
    ASSERT_TRUE(project) << project.error().message;
    EXPECT_EQ(project->cloud, "town");
    ASSERT_EQ(project->views.size(), 2U);
    EXPECT_EQ(project->views[0].up, UpAxis::Y);
    EXPECT_EQ(project->views[0].words,
              (WordValues{{"eye", "0,-9,0"}, {"target", "0,0,0"}, {"method", "disc"}}));
    EXPECT_EQ(project->views[1].words.size(), 3U);
    const auto first = project->tour("");
    ASSERT_TRUE(first);
    EXPECT_EQ(*first, (ProjectTour{"There and back", {0, 1, 0}, 3, 0.5, false}));
    EXPECT_EQ(*project->tour("All"), (ProjectTour{"All", {0, 1}, 4, 2, false}));
    EXPECT_NE(project->tour("Alles").error().message.find("There and back, All"), std::string::npos);
    file.erase("tours");
    EXPECT_EQ(parseProjectTours(file.dump())->tour("")->stops, (std::vector<std::size_t>{0, 1}));
}

TEST(ProjectTours, WhatIsWrongIsNamed) {
    const std::vector<std::pair<std::string, std::string>> cases{
        {R"([{"op":"replace","path":"/version","value":2}])", "version"},
        {R"([{"op":"remove","path":"/cloud"}])", "cloud"},
        {R"([{"op":"replace","path":"/cloud","value":7}])", "cloud"},
        {R"([{"op":"replace","path":"/cloud","value":{"id":7}}])", "cloud.id"},
        {R"([{"op":"replace","path":"/views","value":{}}])", "views"},
        {R"([{"op":"replace","path":"/views/1","value":null}])", "views[1]"},
        {R"([{"op":"replace","path":"/views/1/name","value":"south"}])", "views[1].name"},
        {R"([{"op":"replace","path":"/views/1/name","value":""}])", "views[1].name"},
        {R"([{"op":"replace","path":"/tours/1/name","value":"There and back"}])", "tours[1].name"},
        {R"([{"op":"replace","path":"/tours/1/name","value":""}])", "tours[1].name"},
        {R"([{"op":"remove","path":"/views/0/view"}])", "views[0].view"},
        {R"([{"op":"replace","path":"/views/0/view","value":"eye=%zz"}])", "views[0].view"},
        {R"([{"op":"replace","path":"/views/0/view","value":"upAxis=x"}])", "views[0].view"},
        {R"([{"op":"replace","path":"/tours/0/views/1","value":"nowhere"}])", "tours[0].views[1]"},
        {R"([{"op":"replace","path":"/tours/0/views/1","value":3}])", "tours[0].views[1]"},
        {R"([{"op":"replace","path":"/tours/0/seconds","value":0}])", "tours[0].seconds"},
        {R"([{"op":"replace","path":"/tours/0/pause","value":-1}])", "tours[0].pause"},
        {R"([{"op":"replace","path":"/tours/0/pause","value":"long"}])", "tours[0].pause"},
        {R"([{"op":"replace","path":"/tours/0/loop","value":1}])", "tours[0].loop"},
    };
    auto good = whole();
    good["views"][0]["view"] = "eye=0,-9,0";
    for (const auto& [patch, field] : cases) {
        const auto error = refused(good.patch(nlohmann::json::parse(patch)));
        EXPECT_EQ(error.field, field) << patch << ": " << error.message;
        EXPECT_FALSE(error.message.empty());
    }
    auto many = good;
    many["views"] = nlohmann::json::array();
    for (std::size_t i = 0; i <= mostProjectViews; ++i)
        many["views"].push_back({{"name", std::to_string(i)}, {"view", "fov=60"}});
    EXPECT_EQ(refused(many).field, "views");
    for (const std::string text : {"", "null", "[]", "{}", R"({"format": "other"})", R"({"format": 1})"})
        EXPECT_EQ(parseProjectTours(text).error().code, ErrorCode::Malformed) << text;
    EXPECT_EQ(parseProjectTours(std::string(longestProject + 1, ' ')).error().code, ErrorCode::ResourceLimit);
}

}  // namespace
}  // namespace scancast::client
