#include "client/cpp/server.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "protocol/problem.hpp"
#include "tests/unit/client/fake_session.hpp"

namespace scancast::client {
namespace {

using namespace std::chrono_literals;
using test::FakeAnswer;
using test::FakeServer;

const std::string jpeg = "\xFF\xD8\xFF picture";

Server serverAt(const FakeServer& fake) {
    return Server(fake.url(), {2s, 5s});
}

TEST(Server, ListsCloudsAndMethods) {
    const FakeServer fake(test::fakeLists());
    const auto server = serverAt(fake);
    const auto clouds = server.clouds();
    ASSERT_TRUE(clouds) << clouds.error().message;
    EXPECT_EQ(*clouds, std::vector{test::fakeCloud()});
    EXPECT_EQ(*server.cloud("town"), test::fakeCloud());
    EXPECT_EQ(*server.methods(), std::vector{test::fakeMethod()});
    const auto request = fake.requests().front();
    EXPECT_TRUE(request.starts_with("GET /api/v1/clouds HTTP/1.1\r\n")) << request;
    EXPECT_NE(request.find("Host: " + fake.url().authority() + "\r\n"), std::string::npos) << request;
}

TEST(Server, SnapshotCarriesTheWordsAndTheETag) {
    FakeServer::Script script;
    script.answers["/api/v1/clouds/my%20town/snapshot.jpg"] = {200, "image/jpeg", jpeg, "\"abc\""};
    const FakeServer fake(script);
    const auto server = serverAt(fake);
    const auto picture = server.snapshot("my town", {{"eye", "1,2,3"}, {"color", "#ff8800"}});
    ASSERT_TRUE(picture) << picture.error().message;
    EXPECT_EQ(std::string(picture->bytes.begin(), picture->bytes.end()), jpeg);
    EXPECT_EQ(picture->etag, "\"abc\"");
    EXPECT_FALSE(picture->notModified);
    EXPECT_TRUE(fake.requests().back().starts_with(
        "GET /api/v1/clouds/my%20town/snapshot.jpg?eye=1,2,3&color=%23ff8800 HTTP/1.1\r\n"));

    const auto again = server.snapshot("my town", {}, PictureFormat::Jpeg, "\"abc\"");
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_TRUE(again->notModified);
    EXPECT_TRUE(again->bytes.empty());
}

TEST(Server, AnIdCannotLeaveItsPlaceInThePath) {
    const FakeServer fake({});
    EXPECT_FALSE(serverAt(fake).cloud("a/../../secret?x#y"));
    EXPECT_TRUE(
        fake.requests().back().starts_with("GET /api/v1/clouds/a%2F..%2F..%2Fsecret%3Fx%23y HTTP/1.1\r\n"));
}

TEST(Server, ProblemsBecomeErrors) {
    FakeServer::Script script;
    const Error sent{ErrorCode::ImpossibleView, "eye and target are the same point", "target"};
    script.answers["/api/v1/clouds/town/snapshot.jpg"] = {422, "application/problem+json",
                                                          printJson(toJson(problemOf(sent))), ""};
    script.answers["/api/v1/clouds"] = {503, "text/html", "<h1>proxy</h1>", ""};
    script.answers["/api/v1/methods"] = {400, "application/problem+json", "not JSON", ""};
    const FakeServer fake(script);
    const auto server = serverAt(fake);
    const auto picture = server.snapshot("town", {});
    ASSERT_FALSE(picture);
    EXPECT_EQ(picture.error().code, sent.code);
    EXPECT_EQ(picture.error().message, sent.message);
    EXPECT_EQ(picture.error().field, sent.field);
    const auto clouds = server.clouds();
    ASSERT_FALSE(clouds);
    EXPECT_EQ(clouds.error().code, ErrorCode::DeviceUnavailable);
    EXPECT_NE(clouds.error().message.find("503 Service Unavailable"), std::string::npos)
        << clouds.error().message;
    EXPECT_NE(server.methods().error().message.find("400 Bad Request"), std::string::npos);
    EXPECT_EQ(server.cloud("nowhere").error().code, ErrorCode::NotFound);
}

TEST(Server, NobodyListens) {
    const auto url = test::nobodysUrl();
    const auto clouds = Server(url, {2s, 5s}).clouds();
    ASSERT_FALSE(clouds);
    EXPECT_EQ(clouds.error().code, ErrorCode::Io);
    EXPECT_EQ(clouds.error().message,
              "nothing listens at " + url.authority() + ": start one with `scancast serve FILE`");
}

TEST(Server, OneThatNeverAnswersIsGivenUp) {
    FakeServer::Script script;
    script.silent = true;
    const FakeServer fake(script);
    const auto clouds = Server(fake.url(), {2s, 100ms}).clouds();
    ASSERT_FALSE(clouds);
    EXPECT_EQ(clouds.error().code, ErrorCode::DeadlineExceeded);
    EXPECT_NE(clouds.error().message.find("did not answer in time"), std::string::npos)
        << clouds.error().message;
}

TEST(Server, UnknownHost) {
    // RFC 2606 reserves .invalid: it never resolves.
    const auto clouds = Server({"no-such-host.invalid", 80}, {20s, 5s}).clouds();
    ASSERT_FALSE(clouds);
    EXPECT_NE(clouds.error().message.find("no-such-host.invalid"), std::string::npos)
        << clouds.error().message;
}

TEST(Server, AnswersThatAreNone) {
    const std::vector<std::pair<std::string, ErrorCode>> cases{
        {"SSH-2.0-OpenSSH\r\n", ErrorCode::Malformed},
        {"HTTP/1.1 200 OK\r\nContent-Length: 100\r\n\r\n{\"clouds\": [", ErrorCode::Io},
        {"HTTP/1.1 200 OK\r\nContent-Length: 99999999999\r\n\r\n", ErrorCode::ResourceLimit},
        {"HTTP/1.1 200 OK\r\nContent-Length: 3\r\n\r\nabc", ErrorCode::Malformed},
        {"HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n{}", ErrorCode::Malformed},
    };
    for (const auto& [raw, code] : cases) {
        FakeServer::Script script;
        script.raw = raw;
        const FakeServer fake(script);
        const auto clouds = serverAt(fake).clouds();
        ASSERT_FALSE(clouds) << raw;
        EXPECT_EQ(clouds.error().code, code) << raw << ": " << clouds.error().message;
        EXPECT_NE(clouds.error().message.find(fake.url().authority()), std::string::npos)
            << clouds.error().message;
    }
}

TEST(Server, MoreThanAnAnswerMayHaveIsNotRead) {
    // Lists, errors, pictures of a size that was asked for, and heads have bounds of their own.
    const auto head = [](const std::string& status, std::uint64_t length) {
        return "HTTP/1.1 " + status + "\r\nContent-Length: " + std::to_string(length) + "\r\n\r\n";
    };
    const std::string chunk = "10000\r\n" + std::string(0x10000, 'x') + "\r\n";
    std::string endless = "HTTP/1.1 404 Not Found\r\nTransfer-Encoding: chunked\r\n\r\n";
    for (int i = 0; i < 5; ++i) endless += chunk;
    for (const auto& raw : {head("200 OK", (16u << 20u) + 1), head("503 No", (256u << 10u) + 1), endless,
                            "HTTP/1.1 200 OK\r\nX: " + std::string(9000, 'x') + "\r\n\r\n"}) {
        FakeServer::Script script;
        script.raw = raw;
        const FakeServer fake(script);
        const auto clouds = serverAt(fake).clouds();
        ASSERT_FALSE(clouds) << raw.substr(0, 80);
        EXPECT_EQ(clouds.error().code, ErrorCode::ResourceLimit) << clouds.error().message;
        EXPECT_NE(clouds.error().message.find("sent more than this client accepts"), std::string::npos);
    }
    const WordValues small{{"width", "64"}, {"height", "32"}};
    const auto refused = [&](std::uint64_t length, const WordValues& words) {
        FakeServer::Script script;
        script.raw = head("200 OK", length) + jpeg;
        const FakeServer fake(script);
        return serverAt(fake).snapshot("town", words).error().code;
    };
    EXPECT_EQ(refused((1u << 20u) + 8 * 64 * 32 + 1, small), ErrorCode::ResourceLimit);
    EXPECT_EQ(refused((1u << 20u) + 8 * 64 * 32, small), ErrorCode::Io) << "accepted, and cut short";
    EXPECT_EQ(refused((1u << 20u) + 8 * 64 * 32 + 1, {}), ErrorCode::Io) << "the cloud's size is not known";
}

TEST(Server, APageInsteadOfAPictureIsMalformed) {
    FakeServer::Script script;
    script.answers["/api/v1/clouds/town/snapshot.png"] = {200, "image/png", jpeg, ""};
    const FakeServer fake(script);
    EXPECT_EQ(serverAt(fake).snapshot("town", {}, PictureFormat::Png).error().code, ErrorCode::Malformed);
}

}  // namespace
}  // namespace scancast::client
