#include "client/cpp/http_get.hpp"

#include "client/cpp/timed_io.hpp"

#include <algorithm>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>

#include "client/cpp/refusal.hpp"

namespace scancast::client {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;

constexpr std::uint32_t longestHead = 8192;

using Body = http::vector_body<std::uint8_t>;

using Request = http::request<http::string_body>;

Request requestOf(http::verb verb, const ServerUrl& url, const std::string& target,
                  const std::string& token) {
    Request request(verb, target, 11);
    request.set(http::field::host, url.authority());
    request.set(http::field::user_agent, "scancast-client");
    request.set(http::field::connection, "close");
    if (!token.empty()) request.set(http::field::authorization, "Bearer " + token);
    return request;
}

Expected<HttpAnswer> answerOf(http::response<Body> response, const ServerUrl& url) {
    const auto field = [&](auto name) { return std::string(response[name]); };
    HttpAnswer answer{static_cast<int>(response.result_int()),
                      field(http::field::content_type),
                      field(http::field::etag),
                      field("Server-Timing"),
                      field("Scancast-Damaged"),
                      std::move(response.body()),
                      field("Scancast-Method"),
                      field("Scancast-Method-Reason")};
    if (answer.status < 400) return answer;
    const std::string_view text(reinterpret_cast<const char*>(answer.body.data()), answer.body.size());
    return tl::unexpected(refusal(url, answer.status, answer.contentType, text));
}

Expected<HttpAnswer> ask(const ServerUrl& url, const Request& request, std::uint64_t longest,
                         const Credentials& credentials, const Timeouts& timeouts) {
    boost::asio::io_context io;
    auto open = connectUntil(io, url, credentials, Clock::now() + timeouts.connect);
    if (!open) return passOn(open);
    NetStream& stream = *open;
    const auto deadline = Clock::now() + timeouts.answer;
    const auto close = [&] {
        ErrorCodeOfBoost ignored;  // nothing is sent after this
        stream.tcp().socket().close(ignored);
    };
    if (const auto error = runUntil(
            io, deadline, [&](auto handler) { http::async_write(stream, request, handler); }, close))
        return tl::unexpected(networkError(error, url, "sending a request"));
    beast::flat_buffer buffer;
    http::response_parser<Body> parser;
    parser.header_limit(longestHead);
    parser.body_limit(longest);
    if (const auto error = runUntil(
            io, deadline, [&](auto handler) { http::async_read_header(stream, buffer, parser, handler); },
            close))
        return tl::unexpected(networkError(error, url, "reading the answer"));
    if (parser.get().result_int() >= 400) {
        const auto allowed = std::min(longest, longestRefusal);
        parser.body_limit(allowed);
        if (const auto length = parser.content_length(); length && *length > allowed)
            return tl::unexpected(networkError(http::error::body_limit, url, "reading why it refuses"));
    }
    if (const auto error = runUntil(
            io, deadline, [&](auto handler) { http::async_read(stream, buffer, parser, handler); }, close))
        return tl::unexpected(networkError(error, url, "reading the answer"));
    close();
    return answerOf(parser.release(), url);
}

}  // namespace

Expected<HttpAnswer> httpGet(const ServerUrl& url, const std::string& target, std::uint64_t longest,
                             const std::string& ifNoneMatch, const Credentials& credentials,
                             const Timeouts& timeouts) {
    Request request = requestOf(http::verb::get, url, target, credentials.token);
    if (!ifNoneMatch.empty()) request.set(http::field::if_none_match, ifNoneMatch);
    return ask(url, request, longest, credentials, timeouts);
}

Expected<HttpAnswer> httpPostJson(const ServerUrl& url, const std::string& target, std::uint64_t longest,
                                  std::string json, const Credentials& credentials,
                                  const Timeouts& timeouts) {
    Request request = requestOf(http::verb::post, url, target, credentials.token);
    request.set(http::field::content_type, "application/json");
    request.body() = std::move(json);
    request.prepare_payload();
    return ask(url, request, longest, credentials, timeouts);
}

}  // namespace scancast::client
