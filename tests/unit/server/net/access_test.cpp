#include "server/net/access.hpp"

#include <gtest/gtest.h>

#include "protocol/bearer.hpp"

namespace scancast {
namespace {

const std::string user = "user-0123456789abcdef";
const std::string admin = "admin-0123456789abcdef";

HttpRequest with(const std::string& header, const std::string& value) {
    return {"GET", "/", {{header, value}}};
}

int status(const Access& access, const HttpRequest& request, Route route = Route::Clouds) {
    const auto checked = access.check(request, route);
    return checked ? 200 : checked.error().status;
}

TEST(Access, WithoutATokenNobodyIsAsked) {
    const Access open({});
    EXPECT_EQ(status(open, {}), 200);
    EXPECT_EQ(status(open, with("authorization", "Bearer whatever")), 200);
    EXPECT_EQ(status(Access({std::nullopt, admin}), {}), 200);
}

TEST(Access, ATokenIsAskedForAndCompared) {
    const Access access({user, admin});
    EXPECT_EQ(status(access, with("authorization", "Bearer " + user)), 200);
    EXPECT_EQ(status(access, with("authorization", "Bearer " + admin)), 200);
    for (const std::string& wrong : {user + "x", user.substr(1), std::string("x"), std::string()})
        EXPECT_EQ(status(access, with("authorization", "Bearer " + wrong)), 401) << wrong;
    EXPECT_EQ(status(access, with("authorization", user)), 401);
    EXPECT_EQ(
        status(access, {"GET", "/", {{"authorization", "Bearer " + user}, {"authorization", "Bearer x"}}}),
        401);
    EXPECT_EQ(status(access, {"GET", "/?token=" + user, {}}), 401) << "never from an address";
}

TEST(Access, OnlyTheAdministratorAdministers) {
    const auto asking = [](const std::string& token, const char* method) {
        return HttpRequest{method, "/", {{"authorization", "Bearer " + token}}};
    };
    const Access both({user, admin});
    const Access adminOnly({std::nullopt, admin});
    for (const auto& [method, route] :
         {std::pair("GET", Route::Sessions), {"POST", Route::Clouds}, {"DELETE", Route::Cloud}}) {
        for (const Access* access : {&both, &adminOnly}) {
            EXPECT_EQ(status(*access, asking(admin, method), route), 200);
            EXPECT_EQ(status(*access, {method, "/", {}}, route), 401);
            EXPECT_EQ(status(*access, asking("another-0123456789", method), route), 401);
        }
        EXPECT_EQ(status(both, asking(user, method), route), 403);
        EXPECT_EQ(status(Access({user, std::nullopt}), asking(user, method), route), 403);
        EXPECT_EQ(status(Access({}), {method, "/", {}}, route), 403) << "nobody can";
    }
    EXPECT_EQ(status(adminOnly, {"GET", "/", {}}, Route::Clouds), 200);
    EXPECT_EQ(status(both, asking(user, "GET"), Route::Cloud), 200);
}

TEST(Access, ThePageAndItsHealthNeedNone) {
    const Access access({user, std::nullopt});
    for (const Route route : {Route::Asset, Route::Health, Route::Ready})
        EXPECT_EQ(status(access, {}, route), 200);
    for (const Route route : {Route::Clouds, Route::Cloud, Route::Methods, Route::Metrics,
                              Route::SnapshotJpeg, Route::SnapshotPng, Route::Stream})
        EXPECT_EQ(status(access, {}, route), 401);
}

TEST(Access, RefusalsSayHowAndNothingOfTheToken) {
    const Access access({user, std::nullopt});
    const HttpResponse missing = access.check({}, Route::Clouds).error();
    EXPECT_EQ(*missing.find("WWW-Authenticate"), R"(Bearer realm="scancast")");
    EXPECT_EQ(*missing.find("Content-Type"), "application/problem+json");
    const HttpResponse wrong =
        access.check(with("authorization", "Bearer wrong-token"), Route::Clouds).error();
    EXPECT_NE(wrong.find("WWW-Authenticate")->find("invalid_token"), std::string::npos);
    EXPECT_EQ(wrong.text.find("wrong-token"), std::string::npos);
}

TEST(Access, AWebSocketBringsItAsASubprotocol) {
    const Access access({user, std::nullopt});
    const auto offering = [&](const std::string& token) {
        return with("sec-websocket-protocol", "scancast.v1, " + bearerSubprotocol(token));
    };
    EXPECT_EQ(status(access, offering(user), Route::Stream), 200);
    EXPECT_EQ(status(access, offering("another-token-of-16"), Route::Stream), 401);
    EXPECT_EQ(status(access, offering(user), Route::Clouds), 401) << "for streams only";
}

TEST(Access, AnswersToWhoShowsATokenAreTheirs) {
    EXPECT_TRUE(Access({user, std::nullopt}).isPrivate(with("authorization", "Bearer " + user)));
    EXPECT_FALSE(Access({}).isPrivate(with("authorization", "Bearer " + user)));
    EXPECT_FALSE(Access({user, std::nullopt}).isPrivate({}));
}

}  // namespace
}  // namespace scancast
