// What somebody meets who follows a link, and what a program gets at the same address.
#include <nlohmann/json.hpp>

#include "tests/integration/server_fixture.hpp"

namespace scancast::test {
namespace {

const std::string browser = "Accept: text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8";

class ErrorPagesTest : public ServerTest {};

void expectPage(const HttpReply& reply, int status, const std::string& what) {
    EXPECT_EQ(reply.status, status) << what;
    EXPECT_EQ(reply.header("content-type"), "text/html; charset=utf-8") << what;
    EXPECT_NE(reply.header("content-security-policy").find("default-src 'none'; style-src 'sha256-"),
              std::string::npos)
        << what;
    EXPECT_NE(reply.header("vary").find("Accept"), std::string::npos) << what;
    EXPECT_EQ(reply.header("x-content-type-options"), "nosniff") << what;
    EXPECT_EQ(reply.header("content-length"), std::to_string(reply.body.size())) << what;
    EXPECT_NE(reply.body.find("<a href=\"/\">"), std::string::npos) << what;
    EXPECT_FALSE(reply.header("x-request-id").empty()) << what;
    EXPECT_NE(reply.body.find(reply.header("x-request-id")), std::string::npos) << what;
}

TEST_F(ErrorPagesTest, BrowsersGetPagesAndProgramsGetProblems) {
    start();
    const std::tuple<std::string, std::string, std::vector<std::string>, int> cases[] = {
        {"GET", "/teapot", {}, 404},
        {"GET", "/teapot.js", {}, 404},
        {"GET", "/api/v1/teapot", {}, 404},
        {"GET", "/api/v1/clouds/three", {}, 404},
        {"GET", "/api/v1/clouds/three/snapshot.jpg", {}, 404},
        {"GET", "/api/v1/clouds/three/stream.mjpg", {}, 404},
        {"GET", "/%zz", {}, 400},
        {"GET", "/api/v1/clouds/one/snapshot.jpg?fvo=1", {}, 400},
        {"GET", "/api/v1/clouds/one/snapshot.jpg?eye=0,0,0&target=0,0,0", {}, 422},
        {"GET", "/", {"Host: evil.example"}, 403},
        {"GET", "/", {"Origin: http://evil.example"}, 403},
        {"PUT", "/api/v1/clouds", {}, 405},
        {"GET", "/api/v1/clouds/one/pick", {}, 405},
        {"GET", "/api/v1/clouds/one/measure", {}, 405},
        {"GET", "/api/v1/stream", {}, 426},
        {"GET", "/" + std::string(9000, 'a'), {}, 414},
        {"GET", "/", {"Transfer-Encoding: gzip"}, 400},
    };
    for (const auto& [method, target, headers, status] : cases) {
        const std::string what = method + " " + target.substr(0, 60);
        auto asking = headers;
        asking.push_back(browser);
        expectPage(request(port(), target, asking, method), status, what);
        for (const char* accept : {"Accept: */*", "Accept: application/json, */*;q=0.1"}) {
            asking.back() = accept;
            const HttpReply reply = request(port(), target, asking, method);
            EXPECT_EQ(reply.status, status) << what;
            EXPECT_EQ(reply.header("content-type"), "application/problem+json") << what;
            EXPECT_EQ(parseJson(reply.body).value()["requestId"], reply.header("x-request-id")) << what;
            EXPECT_TRUE(reply.header("content-security-policy").empty()) << what;
        }
    }
    RawSocket socket(port());
    const HttpReply head = requestOn(socket, "/teapot", {browser}, "HEAD");
    EXPECT_EQ(head.status, 404);
    EXPECT_EQ(head.header("content-type"), "text/html; charset=utf-8");
    EXPECT_EQ(requestOn(socket, "/api/v1/clouds", {browser}).header("content-type"), "application/json")
        << "what is no problem is what it was";
}

TEST_F(ErrorPagesTest, ACloudThatWasRemovedAndOneThatFailed) {
    start();
    const std::string address = "/api/v1/clouds/late/snapshot.jpg";
    const auto late = server->catalog().add("late");
    expectPage(request(port(), address, {browser}), 503, "loading");
    server->catalog().setFailed(late, "its file is <cut off>");
    const HttpReply failed = request(port(), address, {browser});
    expectPage(failed, 404, "failed");
    EXPECT_NE(failed.body.find("&lt;cut off&gt;"), std::string::npos) << failed.body;
    server->catalog().setReady(server->catalog().add("gone"), one);
    EXPECT_EQ(request(port(), "/api/v1/clouds/gone", {browser}).status, 200);
    ASSERT_TRUE(server->catalog().remove("gone"));
    expectPage(request(port(), "/api/v1/clouds/gone/snapshot.jpg", {browser}), 404, "removed");
}

TEST_F(ErrorPagesTest, WithoutATokenOrWithTooManyWrongOnes) {
    options.tokens.users = {{"all", "0123456789abcdef"}};
    start();
    const HttpReply refused = request(port(), "/api/v1/clouds", {browser});
    expectPage(refused, 401, "no token");
    EXPECT_EQ(refused.header("www-authenticate"), "Bearer realm=\"scancast\"");
    HttpReply last;
    for (int i = 0; i < 12; ++i)
        last = request(port(), "/api/v1/clouds", {browser, "Authorization: Bearer wrong-wrong-wrong"});
    expectPage(last, 429, "too many wrong tokens");
    EXPECT_FALSE(last.header("retry-after").empty());
}

}  // namespace
}  // namespace scancast::test
