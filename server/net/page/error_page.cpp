#include "server/net/page/error_page.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>
#include <openssl/sha.h>

#include <algorithm>
#include <array>

#include "protocol/text/plain_text.hpp"
#include "server/net/api/negotiate.hpp"

namespace scancast {
namespace {

constexpr std::string_view pageStyle =
    ":root{color-scheme:light dark;--ink:#1d242b;--quiet:#5b6670;--paper:#f4f6f8;--link:#0b5cad}"
    "@media(prefers-color-scheme:dark){:root{--ink:#e8edf2;--quiet:#9aa7b4;--paper:#1b2128;--link:#8cc4ff}}"
    "body{margin:0;min-height:100vh;display:grid;place-items:center;background:var(--paper);color:var(--ink);"
    "font:17px/1.5 system-ui,sans-serif}"
    "main{max-width:34rem;padding:2rem 1.5rem;overflow-wrap:anywhere}"
    "h1{margin:0 0 .75rem;font-size:1.6rem;line-height:1.25}p{margin:0 0 1rem}"
    "a{display:inline-block;padding:.6rem 1.1rem;border:1px solid currentColor;border-radius:.5rem;color:var("
    "--link);"
    "text-decoration:none}a:hover,a:focus{text-decoration:underline}"
    "small{display:block;margin-top:1.75rem;color:var(--quiet)}";

struct Words {
    int status;
    std::string_view heading;
    std::string_view advice;
};

constexpr std::string_view forPrograms = "This address is for programs. To look at scans, open the viewer.";
constexpr std::string_view startOver = "Check the address, or start again from the viewer.";
constexpr std::string_view waitAMoment = "Wait a moment, then reload this page.";
constexpr std::string_view askForLess = "Ask for a smaller picture, or look at the scan in the viewer.";

constexpr std::array pageWords{
    Words{400, "There is a mistake in this address", startOver},
    Words{401, "This needs an access token",
          "Open the viewer, which asks for the token. Whoever runs this server can give you one."},
    Words{403, "You are not allowed to see this",
          "If you think that you should be, ask whoever runs this server."},
    Words{404, "There is nothing here",
          "The address may be misspelled, or what it showed has been removed. The viewer lists everything "
          "there is."},
    Words{405, "This address does not work that way", forPrograms},
    Words{406, "There is no page here", forPrograms},
    Words{409, "This is not possible right now", waitAMoment},
    Words{410, "This has been removed", "The viewer lists everything there is."},
    Words{413, "This is more than the server does at once", askForLess},
    Words{414, "This address is too long", startOver},
    Words{415, "This address does not work that way", forPrograms},
    Words{422, "This view cannot be drawn", startOver},
    Words{426, "This address does not work that way", forPrograms},
    Words{429, "Too many requests", waitAMoment},
    Words{503, "This is not available right now", waitAMoment},
    Words{504, "This took too long", "Try again when the server is less busy, or ask for a smaller picture."},
};

Words wordsFor(int status) {
    const auto known = std::ranges::find(pageWords, status, &Words::status);
    if (known != pageWords.end()) return *known;
    if (status >= 500) {
        return {status, "Something went wrong on the server",
                "It is not your fault. Try again; if it keeps happening, give whoever runs this server the "
                "request ID below."};
    }
    return {status, "This request was refused", startOver};
}

std::string base64(const unsigned char* bytes, std::size_t size) {
    std::string text(4 * ((size + 2) / 3) + 1, '\0');  // with the zero that OpenSSL ends it with
    const int length = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes, int(size));
    text.resize(std::size_t(length));
    return text;
}

}  // namespace

std::string htmlText(std::string_view text) {
    std::string safe;
    for (const char c : plainText(text)) {
        switch (c) {
            case '&':
                safe += "&amp;";
                break;
            case '<':
                safe += "&lt;";
                break;
            case '>':
                safe += "&gt;";
                break;
            case '"':
                safe += "&quot;";
                break;
            case '\'':
                safe += "&#39;";
                break;
            default:
                safe += c;
        }
    }
    return safe;
}

std::string errorPage(const Problem& problem) {
    const Words words = wordsFor(problem.status);
    std::string page = fmt::format(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{} - "
        "Scancast</title>\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"robots\" content=\"noindex\">\n"
        "<link rel=\"icon\" href=\"/favicon.svg\" type=\"image/svg+xml\">\n<style>{}</style>\n</head>\n"
        "<body>\n<main>\n<h1>{}</h1>\n",
        words.heading, pageStyle, words.heading);
    if (!problem.detail.empty()) page += "<p>" + htmlText(problem.detail) + "</p>\n";
    page += fmt::format("<p>{}</p>\n<a href=\"/\">Open the viewer</a>\n<small>{} {}", words.advice,
                        problem.status, htmlText(reasonPhrase(problem.status)));
    if (!problem.requestId.empty()) page += "<br>Request ID: " + htmlText(problem.requestId);
    return page + "</small>\n</main>\n</body>\n</html>\n";
}

std::string errorPagePolicy(std::string_view frameAncestors) {
    static const std::string styleHash = [] {
        std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
        SHA256(reinterpret_cast<const unsigned char*>(pageStyle.data()), pageStyle.size(), digest.data());
        return base64(digest.data(), digest.size());
    }();
    return fmt::format(
        "default-src 'none'; style-src 'sha256-{}'; img-src 'self'; base-uri 'none'; form-action 'none'; "
        "frame-ancestors {}",
        styleHash, frameAncestors);
}

void presentProblem(const HttpRequest& request, HttpResponse& response, std::string_view frameAncestors) {
    if (!response.problem) return;
    response.set("Vary", "Accept");
    if (!prefersPage(request.header("accept"))) return;
    response.text = errorPage(*response.problem);
    for (auto& [name, value] : response.headers)
        if (name == "Content-Type") value = "text/html; charset=utf-8";
    response.set("Content-Security-Policy", errorPagePolicy(frameAncestors))
        .set("Referrer-Policy", "no-referrer");
}

}  // namespace scancast
