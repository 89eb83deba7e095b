#include "server/net/router.hpp"

#include <gtest/gtest.h>

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
        {"/api/v1/methods", Route::Methods},
        {"/api/v1/clouds/town/snapshot.jpg", Route::SnapshotJpeg},
        {"/api/v1/clouds/town/snapshot.png?width=3", Route::SnapshotPng},
        {"/api/v1/clouds/town/snapshot", Route::Snapshot},
        {"/api/v1/clouds/town/pick", Route::Pick},
        {"/api/v1/stream", Route::Stream},
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
    EXPECT_EQ(routed->cloud, "old town");
    EXPECT_EQ(routed->query, "eye=1,2,3&color=%23ff0000");
    EXPECT_EQ(routed->path, "/api/v1/clouds/old town/snapshot.jpg");
}

TEST(Router, AnEscapedSlashStaysInItsSegment) {
    const auto routed = route("/api/v1/clouds/..%2F..%2Fetc%2Fpasswd");
    ASSERT_TRUE(routed);
    EXPECT_EQ(routed->route, Route::Cloud);
    EXPECT_EQ(routed->cloud, "../../etc/passwd");  // a name that no catalog holds
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
        {"/" + std::string(maxTargetLength, 'a'), 414},
    };
    for (const auto& [target, status] : wrong) {
        const auto routed = route(target);
        ASSERT_FALSE(routed) << target;
        EXPECT_EQ(routed.error().status, status) << target;
    }
}

TEST(Router, PercentDecode) {
    EXPECT_EQ(*percentDecode("a%20b%2Bc+d"), "a b+c+d");
    EXPECT_EQ(*percentDecode("%e8%a6%b3"), "観");
    EXPECT_FALSE(percentDecode("%"));
    EXPECT_FALSE(percentDecode("%1"));
    EXPECT_FALSE(percentDecode("%g0"));
}

TEST(Router, PatternsHoldNoIds) {
    EXPECT_EQ(pattern(Route::Cloud), "/api/v1/clouds/{id}");
    EXPECT_EQ(pattern(Route::Asset), "/");
}

}  // namespace
}  // namespace scancast
