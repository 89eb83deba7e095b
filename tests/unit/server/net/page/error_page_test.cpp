#include "server/net/page/error_page.hpp"

#include <gtest/gtest.h>
#include <openssl/evp.h>

#include <regex>

namespace scancast {
namespace {

// What Chromium and Firefox send when somebody follows a link.
constexpr const char* chromium =
    "text/html,application/xhtml+xml,application/xml;q=0.9,image/avif,image/webp,image/apng,*/*;q=0.8,"
    "application/signed-exchange;v=b3;q=0.7";
constexpr const char* firefox = "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8";

HttpRequest withAccept(const std::string& accept) {
    return {"GET", "/x", {{"accept", accept}}};
}

TEST(ErrorPage, TextIsNeverMarkup) {
    EXPECT_EQ(htmlText("<b a='1' c=\"2\">&amp;"), "&lt;b a=&#39;1&#39; c=&quot;2&quot;&gt;&amp;amp;");
    EXPECT_EQ(htmlText("Gebäude 7"), "Gebäude 7");
    EXPECT_EQ(htmlText(std::string("a\0b\x1b\xff", 5)), "a?b??");
    Problem problem = problemOf(404, "Nothing is at <script>alert(\"1\")</script>\u202e.", "/<i>");
    problem.requestId = "\"><script>";
    const std::string page = errorPage(problem);
    EXPECT_EQ(page.find("<script"), std::string::npos) << page;
    EXPECT_EQ(page.find("<i>"), std::string::npos) << page;
    EXPECT_EQ(page.find("\u202e"), std::string::npos) << "nor does it turn the direction of writing";
    EXPECT_NE(page.find("&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt;?."), std::string::npos) << page;
}

TEST(ErrorPage, EveryStatusSaysWhatHappenedAndWhatToDo) {
    for (const int status : {400, 401, 403, 404, 405, 406, 409, 410, 413, 414,
                             415, 418, 422, 426, 429, 431, 500, 503, 504, 507}) {
        Problem problem = problemOf(status, "The very sentence.");
        problem.requestId = "abc-123";
        const std::string page = errorPage(problem);
        EXPECT_NE(page.find("<h1>"), std::string::npos) << status;
        EXPECT_NE(page.find("<p>The very sentence.</p>"), std::string::npos) << status;
        EXPECT_NE(page.find("<a href=\"/\">"), std::string::npos) << status;
        EXPECT_NE(page.find(std::to_string(status)), std::string::npos) << status;
        EXPECT_NE(page.find("abc-123"), std::string::npos) << status;
        EXPECT_LT(page.size(), 3000U) << status;
    }
    EXPECT_EQ(errorPage(problemOf(404, "")).find("<p></p>"), std::string::npos);
}

// Right because the hash is made anew, of what stands in the page, by another function of the library.
TEST(ErrorPage, ThePolicyLetsInThatStyleSheetAndNoScript) {
    const std::string page = errorPage(problemOf(404, "Gone."));
    const auto begin = page.find("<style>") + 7;
    const std::string style = page.substr(begin, page.find("</style>") - begin);
    unsigned char digest[EVP_MAX_MD_SIZE], text[2 * EVP_MAX_MD_SIZE];
    unsigned size = 0;
    ASSERT_EQ(EVP_Digest(style.data(), style.size(), digest, &size, EVP_sha256(), nullptr), 1);
    EVP_EncodeBlock(text, digest, int(size));
    const std::string policy = errorPagePolicy("'self' https://viewer.example");
    EXPECT_NE(policy.find("style-src 'sha256-" + std::string(reinterpret_cast<char*>(text)) + "';"),
              std::string::npos)
        << policy;
    EXPECT_EQ(policy.find("default-src 'none';"), 0U);
    EXPECT_NE(policy.find("frame-ancestors 'self' https://viewer.example"), std::string::npos);
    EXPECT_EQ(policy.find("script"), std::string::npos);
    // Which would let nothing in that the policy forbids anyway: no style or handler in an attribute.
    EXPECT_FALSE(std::regex_search(page, std::regex("<[^>]*\\s(style|on[a-z]+)=")));
}

TEST(ErrorPage, IsForBrowsersAndProgramsGetTheProblem) {
    for (const char* accept : {chromium, firefox, "text/html"}) {
        HttpResponse response = problemResponse(problemOf(503, "Not yet."));
        presentProblem(withAccept(accept), response, "'none'");
        EXPECT_EQ(response.status, 503);
        EXPECT_EQ(*response.find("Content-Type"), "text/html; charset=utf-8") << accept;
        EXPECT_EQ(*response.find("Vary"), "Accept");
        EXPECT_EQ(*response.find("Cache-Control"), "no-store");
        EXPECT_EQ(*response.find("Retry-After"), "1");
        EXPECT_NE(response.find("Content-Security-Policy"), nullptr);
        EXPECT_EQ(response.text.find("<!doctype html>"), 0U);
    }
    for (const char* accept :
         {"", "*/*", "application/json", "application/problem+json", "image/avif,*/*;q=0.8",
          "text/html, application/json", "text/html;q=0.5, */*"}) {
        HttpResponse response = problemResponse(problemOf(503, "Not yet."));
        presentProblem(withAccept(accept), response, "'none'");
        EXPECT_EQ(*response.find("Content-Type"), problemMediaType) << accept;
        EXPECT_EQ(*response.find("Vary"), "Accept") << accept;
    }
    HttpResponse fine = textResponse(200, "ok");
    presentProblem(withAccept(firefox), fine, "'none'");
    EXPECT_EQ(fine.text, "ok");
    EXPECT_EQ(fine.find("Vary"), nullptr);
}

}  // namespace
}  // namespace scancast
