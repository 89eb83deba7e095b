// The page's files over real sockets: encodings, lengths, what may be kept.
#include "server/net/page/page.hpp"
#include "tests/integration/server_fixture.hpp"

namespace scancast::test {
namespace {

class PageFilesTest : public ServerTest {};

TEST_F(PageFilesTest, ComeInTheEncodingThatWasAskedFor) {
    start();
    const ServedAsset script = *findAsset("/main.js");
    RawSocket socket(port());
    for (const auto& [asked, coding, bytes] :
         {std::tuple<std::string, std::string, std::string_view>{"Accept-Encoding: gzip, deflate, br, zstd",
                                                                 "br", script.file->brotli},
          {"Accept-Encoding: br;q=0.1, gzip", "gzip", script.file->gzip},
          {"Accept: */*", "", script.file->bytes}}) {
        const HttpReply get = requestOn(socket, "/main.js", {asked});
        EXPECT_EQ(get.status, 200);
        EXPECT_EQ(get.header("content-encoding"), coding) << asked;
        EXPECT_EQ(get.body, bytes) << asked;
        EXPECT_EQ(get.header("content-length"), std::to_string(bytes.size())) << asked;
        EXPECT_EQ(get.header("vary"), "Accept-Encoding");
        const HttpReply head = requestOn(socket, "/main.js", {asked}, "HEAD");
        EXPECT_EQ(head.header("content-length"), get.header("content-length")) << asked;
        EXPECT_EQ(head.header("content-encoding"), coding) << asked;
        const HttpReply same = requestOn(socket, "/main.js", {asked, "If-None-Match: " + get.header("etag")});
        EXPECT_EQ(same.status, 304) << asked;
        EXPECT_EQ(same.header("etag"), get.header("etag")) << asked;
    }
    EXPECT_EQ(requestOn(socket, "/openapi.json", {"Accept-Encoding: br"}).header("content-encoding"), "br");
}

TEST_F(PageFilesTest, AreKeptUnderTheirContentsNameAlsoWhereATokenIsNeeded) {
    options.tokens.users = {{"all", "0123456789abcdef"}};
    start();
    const std::string page = request(port(), "/").body;
    const std::string folder = "assets/" + std::string(pageFiles().hash) + "/";
    EXPECT_NE(page.find("src=\"" + folder + "main.js\""), std::string::npos);
    EXPECT_EQ(page.find("src=\"main.js\""), std::string::npos);
    EXPECT_EQ(request(port(), "/").header("cache-control"), "no-cache");
    EXPECT_EQ(request(port(), "/" + folder + "main.js").header("cache-control"),
              "public, max-age=31536000, immutable");
    const HttpReply old = request(port(), "/assets/00112233aabbccdd/main.js");
    EXPECT_EQ(old.status, 200);
    EXPECT_EQ(old.header("cache-control"), "no-cache");
    EXPECT_EQ(old.body, findAsset("/main.js")->file->bytes);
    EXPECT_EQ(request(port(), "/" + folder + "nothing.js").status, 404);
    EXPECT_EQ(request(port(), "/" + folder + "index.html").status, 404);
}

}  // namespace
}  // namespace scancast::test
