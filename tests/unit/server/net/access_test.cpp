#include "server/net/access.hpp"

#include <gtest/gtest.h>

#include "protocol/bearer.hpp"

namespace scancast {
namespace {

const std::string user = "user-0123456789abcdef";
const std::string admin = "admin-0123456789abcdef";

AccessTokens tokens(const std::string& ofUser, const std::string& ofAdmin = {}) {
    AccessTokens result;
    if (!ofUser.empty()) result.users = {{"user", ofUser}};
    if (!ofAdmin.empty()) result.admins = {{"admin", ofAdmin}};
    return result;
}

HttpRequest with(const std::string& header, const std::string& value) {
    return {"GET", "/", {{header, value}}};
}

int status(const Access& access, const HttpRequest& request, Route route = Route::Clouds) {
    const auto checked = access.check(request, route);
    return checked ? 200 : checked.error().response.status;
}

TEST(Access, WithoutATokenNobodyIsAsked) {
    const Access open({});
    EXPECT_EQ(status(open, {}), 200);
    EXPECT_EQ(status(open, with("authorization", "Bearer whatever")), 200);
    EXPECT_EQ(status(Access(tokens({}, admin)), {}), 200);
}

TEST(Access, ATokenIsAskedForAndCompared) {
    const Access access(tokens(user, admin));
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
    const Access both(tokens(user, admin));
    const Access adminOnly(tokens({}, admin));
    for (const auto& [method, route] :
         {std::pair("GET", Route::Sessions), {"POST", Route::Clouds}, {"DELETE", Route::Cloud}}) {
        for (const Access* access : {&both, &adminOnly}) {
            EXPECT_EQ(status(*access, asking(admin, method), route), 200);
            EXPECT_EQ(status(*access, {method, "/", {}}, route), 401);
            EXPECT_EQ(status(*access, asking("another-0123456789", method), route), 401);
        }
        EXPECT_EQ(status(both, asking(user, method), route), 403);
        EXPECT_EQ(status(Access(tokens(user)), asking(user, method), route), 403);
        EXPECT_EQ(status(Access({}), {method, "/", {}}, route), 403) << "nobody can";
    }
    EXPECT_EQ(status(adminOnly, {"GET", "/", {}}, Route::Clouds), 200);
    EXPECT_EQ(status(both, asking(user, "GET"), Route::Cloud), 200);
}

TEST(Access, ThePageAndItsHealthNeedNone) {
    const Access access(tokens(user));
    for (const Route route : {Route::Asset, Route::Health, Route::Ready})
        EXPECT_EQ(status(access, {}, route), 200);
    for (const Route route : {Route::Clouds, Route::Cloud, Route::Methods, Route::Metrics,
                              Route::SnapshotJpeg, Route::SnapshotPng, Route::Stream})
        EXPECT_EQ(status(access, {}, route), 401);
}

TEST(Access, RefusalsSayHowAndNothingOfTheToken) {
    const Access access(tokens(user));
    const HttpResponse missing = access.check({}, Route::Clouds).error().response;
    EXPECT_EQ(*missing.find("WWW-Authenticate"), R"(Bearer realm="scancast")");
    EXPECT_EQ(*missing.find("Content-Type"), "application/problem+json");
    const HttpResponse wrong =
        access.check(with("authorization", "Bearer wrong-token"), Route::Clouds).error().response;
    EXPECT_NE(wrong.find("WWW-Authenticate")->find("invalid_token"), std::string::npos);
    EXPECT_EQ(wrong.text.find("wrong-token"), std::string::npos);
}

TEST(Access, AWebSocketBringsItAsASubprotocol) {
    const Access access(tokens(user));
    const auto offering = [&](const std::string& token) {
        return with("sec-websocket-protocol", "scancast.v1, " + bearerSubprotocol(token));
    };
    EXPECT_EQ(status(access, offering(user), Route::Stream), 200);
    EXPECT_EQ(status(access, offering("another-token-of-16"), Route::Stream), 401);
    EXPECT_EQ(status(access, offering(user), Route::Clouds), 401) << "for streams only";
}

std::string nameOf(const tl::expected<Grant, LoginRefusal>& checked) {
    return checked ? checked->identity.name : "refused";
}

TEST(Access, AFailureIsAboutATokenThatCame) {
    const Access access(tokens(user, admin));
    const auto failure = [&](const HttpRequest& request, Route route = Route::Clouds) {
        return access.check(request, route).error().failure;
    };
    EXPECT_EQ(failure({}), std::nullopt);
    EXPECT_EQ(failure(with("authorization", "Bearer wrong-token")), LoginFailure::Unknown);
    EXPECT_EQ(failure(with("authorization", "Basic abc")), LoginFailure::Malformed);
    EXPECT_EQ(failure(with("authorization", "Bearer " + user), Route::Sessions), std::nullopt)
        << "known, and not enough";
}

TEST(Access, SaysWhoseTokenItWas) {
    const Access access(AccessTokens{{{"alice", user}, {"bob", user + "-of-bob"}}, {{"carol", admin}}});
    const auto alice = access.check(with("authorization", "Bearer " + user), Route::Clouds);
    EXPECT_EQ(alice->identity, (Identity{"alice", IdentityKind::User}));
    EXPECT_EQ(nameOf(access.check(with("authorization", "Bearer " + user + "-of-bob"), Route::Clouds)),
              "bob");
    const auto carol = access.check(with("authorization", "Bearer " + admin), Route::Sessions);
    EXPECT_EQ(carol->identity, (Identity{"carol", IdentityKind::Admin}));
    EXPECT_EQ(access.check({}, Route::Health)->identity, Identity{});
    const Access open(tokens({}, admin));
    EXPECT_EQ(nameOf(open.check(with("authorization", "Bearer " + admin), Route::Clouds)), "admin");
    EXPECT_EQ(open.check({}, Route::Clouds)->identity, Identity{});
}

TEST(Access, ReplacedTokensAreWithdrawnAndTheOthersHoldOn) {
    const auto now = std::chrono::system_clock::now();
    const auto bearer = [](const std::string& token) { return with("authorization", "Bearer " + token); };
    const std::string other = user + "-another";
    Access access(AccessTokens{{{"alice", user}, {"bob", other}}, {{"carol", admin}}});
    const auto alice = access.check(bearer(user), Route::Clouds),
               bob = access.check(bearer(other), Route::Clouds),
               carol = access.check(bearer(admin), Route::Clouds);
    access.replace(AccessTokens{{{"dora", user + "-of-dora"}, {"bob", other}}, {{"carol", admin}}});
    EXPECT_EQ(status(access, bearer(user)), 401);
    EXPECT_EQ(status(access, bearer(user + "-of-dora")), 200);
    EXPECT_NE(alice->ended(now), nullptr);
    EXPECT_EQ(bob->ended(now), nullptr);
    EXPECT_EQ(carol->ended(now), nullptr);
    // The same token under another name, or good for something else, is another one.
    access.replace(AccessTokens{{{"rob", other}, {"carol", admin}}, {}});
    EXPECT_EQ(status(access, bearer(other)), 200);
    EXPECT_NE(bob->ended(now), nullptr);
    EXPECT_NE(carol->ended(now), nullptr);
    EXPECT_EQ(status(access, bearer(admin), Route::Sessions), 403);
}

TEST(Access, WhoNeededNoTokenIsWithdrawnWhenOneIsNeeded) {
    const auto now = std::chrono::system_clock::now();
    Access access({});
    const auto before = access.check({}, Route::Stream);
    access.replace(tokens({}, admin));
    EXPECT_EQ(before->ended(now), nullptr) << "still open to all";
    access.replace(tokens(user));
    EXPECT_NE(before->ended(now), nullptr);
    EXPECT_EQ(status(access, {}, Route::Stream), 401);
    access.replace({});
    const auto again = access.check({}, Route::Stream);
    EXPECT_EQ(again->ended(now), nullptr);
    access.replace(tokens(user));
    EXPECT_NE(again->ended(now), nullptr);
}

TEST(Access, AnswersToWhoShowsATokenAreTheirs) {
    EXPECT_TRUE(Access(tokens(user)).isPrivate(with("authorization", "Bearer " + user)));
    EXPECT_FALSE(Access({}).isPrivate(with("authorization", "Bearer " + user)));
    EXPECT_FALSE(Access(tokens(user)).isPrivate({}));
}

}  // namespace
}  // namespace scancast
