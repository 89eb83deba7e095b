#include "server/net/api/router.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"

namespace scancast {
namespace {

TEST(Router, EveryRoute) {
    const std::pair<const char*, Route> known[] = {
        {"/", Route::Asset},
        {"/main.js", Route::Asset},
        {"/healthz", Route::Health},
        {"/readyz", Route::Ready},
        {"/metrics", Route::Metrics},
        {"/api/v1/clouds", Route::Clouds},
        {"/api/v1/clouds/town", Route::Cloud},
        {"/api/v1/clouds/town/stations", Route::CloudStations},
        {"/api/v1/clouds/town/photos", Route::CloudPhotos},
        {"/api/v1/clouds/town/photos/17", Route::CloudPhoto},
        {"/api/v1/clouds/town/photos/any", Route::CloudPhoto},
        {"/clouds/town/photos/0", Route::CloudPhoto},
        {"/api/v1/methods", Route::Methods},
        {"/api/v1/clouds/town/snapshot.jpg", Route::SnapshotJpeg},
        {"/api/v1/clouds/town/snapshot.png?width=3", Route::SnapshotPng},
        {"/api/v1/clouds/town/snapshot", Route::Snapshot},
        {"/api/v1/clouds/town/pick", Route::Pick},
        {"/api/v1/clouds/town/measure", Route::Measure},
        {"/api/v1/clouds/town/stream.mjpg?fps=10", Route::StreamMjpeg},
        {"/api/v1/stream", Route::Stream},
        {"/api/v1/sessions", Route::Sessions},
        {"/api/v1/sessions/s1/view", Route::SessionView},
        {"/api/v1/guest-links", Route::GuestLinks},
        {"/api/v1/guest-session", Route::GuestSession},
        {"/openapi.json", Route::OpenApi},
        {"/clouds", Route::Clouds},
        {"/clouds/town", Route::Cloud},
        {"/methods", Route::Methods},
        {"/clouds/town/snapshot.jpg", Route::SnapshotJpeg},
    };
    for (const auto& [target, expected] : known) {
        const auto routed = route(target);
        ASSERT_TRUE(routed) << target;
        EXPECT_EQ(routed->route, expected) << target;
    }
}

TEST(Router, PartsOfATarget) {
    const auto routed = route("/api/v1/clouds/old%20town/snapshot.jpg?eye=1,2,3&color=%23ff0000");
    ASSERT_TRUE(routed);
    EXPECT_EQ(routed->id, "old town");
    EXPECT_EQ(routed->query, "eye=1,2,3&color=%23ff0000");
    EXPECT_EQ(routed->path, "/api/v1/clouds/old town/snapshot.jpg");
    const auto photo = route("/api/v1/clouds/old%20town/photos/1%37?x");
    ASSERT_TRUE(photo);
    EXPECT_EQ(photo->id, "old town");
    EXPECT_EQ(photo->n, "17");
    EXPECT_EQ(pattern(photo->route), "/api/v1/clouds/{id}/photos/{n}");
    EXPECT_EQ(routed->n, "") << "nothing stands for it there";
}

TEST(Router, AnEscapedSlashStaysInItsSegment) {
    const auto routed = route("/api/v1/clouds/..%2F..%2Fetc%2Fpasswd");
    ASSERT_TRUE(routed);
    EXPECT_EQ(routed->route, Route::Cloud);
    EXPECT_EQ(routed->id, "../../etc/passwd");  // a name that no catalog holds
}

TEST(Router, Refusals) {
    const std::pair<std::string, int> wrong[] = {
        {"", 400},
        {"clouds", 400},
        {"http://evil.example/", 400},
        {"*", 400},
        {"/api/v1/clouds/%zz", 400},
        {"/api/v1/clouds/%0a", 400},
        {"/api/v1/clouds/%00", 400},
        {"/%7f", 400},
        {"/a%2", 400},
        {"/api/v1", 404},
        {"/api", 404},
        {"/api/v2/clouds", 404},
        {"/api/v1/cloud", 404},
        {"/api/v1/clouds/", 404},
        {"/api/v1/clouds/town/snapshot.gif", 404},
        {"/api/v1/clouds/town/snapshot.jpg/", 404},
        {"/api/v1/clouds//snapshot.jpg", 404},
        {"/api/v1/clouds/town/photos/", 404},
        {"/api/v1/clouds//photos/3", 404},
        {"/api/v1/clouds/town/photos/3/4", 404},
        {"/api/v1/photos/3", 404},
        {"/api/v1/healthz", 404},
        {"/api/v1/sessions//view", 404},
        {"/api/v1/sessions/s1", 404},
        {"/" + std::string(maxTargetLength, 'a'), 414},
    };
    for (const auto& [target, status] : wrong) {
        const auto routed = route(target);
        ASSERT_FALSE(routed) << target;
        EXPECT_EQ(routed.error().status, status) << target;
    }
}

std::string fileText(const char* name) {
    std::ifstream file(std::string(SCANCAST_SOURCE_DIR) + name);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// As openapi.json says it; for most routes it stands once, at the top.
nlohmann::json securityOf(Need need) {
    if (need == Need::Nothing) return nlohmann::json::array();
    if (need == Need::Admin) return {{{"adminToken", nlohmann::json::array()}}};
    if (need == Need::Token) return {nlohmann::json::object(), {{"token", nlohmann::json::array()}}};
    return {};
}

// What programs and people read names the same routes and methods as the table that answers them.
TEST(Router, TheDescriptionsAgreeWithIt) {
    const auto description = parseJson(fileText("/protocol/openapi.json"));
    ASSERT_TRUE(description) << description.error().message;
    const std::string page = fileText("/protocol/PROTOCOL.md");
    const auto& paths = (*description)["paths"];
    std::size_t described = 0;
    for (const RouteInfo& info : routes) {
        ASSERT_TRUE(paths.contains(info.pattern)) << info.pattern;
        for (const std::string method : {"GET", "POST", "DELETE"}) {
            std::string lower = method;
            for (char& c : lower) c = char(c - 'A' + 'a');
            const bool understood = info.methods.find(method) != std::string_view::npos;
            EXPECT_EQ(paths[std::string(info.pattern)].contains(lower), understood) << method << info.pattern;
            const std::string row = "| `" + method + " " + std::string(info.pattern) + "`";
            EXPECT_EQ(page.find(row) != std::string::npos, understood) << row;
            described += understood ? 1 : 0;
            if (!understood) continue;
            const auto& operation = paths[std::string(info.pattern)][lower];
            EXPECT_EQ(operation.value("security", nlohmann::json()), securityOf(needOf(info.route, method)))
                << method << info.pattern;
        }
        EXPECT_EQ(info.methods.find("GET") == 0, info.methods.find("HEAD") != std::string_view::npos);
    }
    EXPECT_EQ(paths.size(), routes.size());
    EXPECT_GE(described, 18U);
}

TEST(Router, PatternsHoldNoIds) {
    EXPECT_EQ(pattern(Route::Cloud), "/api/v1/clouds/{id}");
    EXPECT_EQ(pattern(Route::Asset), "/");
}

}  // namespace
}  // namespace scancast
