#include "client/cpp/http_stream.hpp"

#include "client/cpp/timed_io.hpp"

#include <algorithm>
#include <boost/asio/ssl/error.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <limits>

#include "client/cpp/http_get.hpp"
#include "client/cpp/refusal.hpp"

namespace scancast::client {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;

constexpr std::uint32_t longestStreamedHead = 16384;
constexpr std::size_t pieceBytes = std::size_t{256} << 10u;

bool sameName(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
    return std::ranges::equal(a, b, [&](char x, char y) { return lower(x) == lower(y); });
}

class StreamedRequest {
  public:
    StreamedRequest(boost::asio::io_context& io, NetStream& stream, const ServerUrl& url,
                    const Timeouts& timeouts)
        : io_(io), stream_(stream), url_(url), timeouts_(timeouts), piece_(pieceBytes) {
        parser_.header_limit(longestStreamedHead);
        parser_.body_limit(std::numeric_limits<std::uint64_t>::max());
        buffer_.reserve(pieceBytes);  // as much is read at once as fits
    }

    Expected<void> send(const http::request<http::string_body>& request) {
        if (const auto error = run([&](auto handler) { http::async_write(stream_, request, handler); }))
            return tl::unexpected(networkError(error, url_, "sending a request"));
        if (const auto error =
                run([&](auto handler) { http::async_read_header(stream_, buffer_, parser_, handler); }))
            return tl::unexpected(networkError(error, url_, "reading the answer"));
        return {};
    }

    /// The rest, piece by piece.
    Expected<void> read(const TakeBytes& take) {
        while (!parser_.is_done()) {
            auto& body = parser_.get().body();
            body.data = piece_.data();
            body.size = piece_.size();
            auto error =
                run([&](auto handler) { http::async_read_some(stream_, buffer_, parser_, handler); });
            if (error == http::error::need_buffer) error = {};
            const std::size_t bytes = piece_.size() - body.size;
            if (bytes > 0)
                if (auto ok = take(std::span(piece_).first(bytes)); !ok) return ok;
            taken_ += bytes;
            if (error && !isEnd(error))
                return tl::unexpected(networkError(error, url_, "reading the answer"));
            if (error)
                return fail(ErrorCode::Truncated,
                            url_.authority() + " broke its answer off after " + std::to_string(taken_) +
                                " bytes: what has come is not all of it. The server's log says why.");
        }
        return {};
    }

    StreamedAnswer answer() const {
        StreamedAnswer answer{static_cast<int>(parser_.get().result_int()), taken_};
        for (const auto& field : parser_.get())
            answer.headers.emplace_back(std::string(field.name_string()), std::string(field.value()));
        return answer;
    }
    unsigned status() const { return parser_.get().result_int(); }

  private:
    /// The connection ended, and the answer had not.
    static bool isEnd(const ErrorCodeOfBoost& error) {
        return error == http::error::partial_message || error == http::error::end_of_stream ||
               error == boost::asio::error::eof || error == boost::asio::error::connection_reset ||
               error == boost::asio::ssl::error::stream_truncated;
    }
    template <class Start>
    ErrorCodeOfBoost run(Start start) {
        return runUntil(io_, Clock::now() + timeouts_.answer, start, [&] {
            ErrorCodeOfBoost ignored;
            stream_.tcp().socket().close(ignored);
        });
    }

    boost::asio::io_context& io_;
    NetStream& stream_;
    const ServerUrl& url_;
    const Timeouts& timeouts_;
    std::vector<std::byte> piece_;
    beast::flat_buffer buffer_;
    http::response_parser<http::buffer_body> parser_;
    std::uint64_t taken_ = 0;
};

}  // namespace

std::string StreamedAnswer::header(std::string_view name) const {
    std::string joined;
    for (const auto& [key, value] : headers) {
        if (!sameName(key, name)) continue;
        if (!joined.empty()) joined += ", ";
        joined += value;
    }
    return joined;
}

namespace {

Expected<StreamedAnswer> streamed(const ServerUrl& url, http::request<http::string_body> request,
                                  std::string_view accept, const Credentials& credentials,
                                  const Timeouts& timeouts, const TakeBytes& take) {
    request.set(http::field::host, url.authority());
    request.set(http::field::user_agent, "scancast-client");
    request.set(http::field::connection, "close");
    if (!accept.empty()) request.set(http::field::accept, beast::string_view(accept.data(), accept.size()));
    if (!credentials.token.empty()) request.set(http::field::authorization, "Bearer " + credentials.token);
    request.prepare_payload();
    boost::asio::io_context io;
    auto open = connectUntil(io, url, credentials, Clock::now() + timeouts.connect);
    if (!open) return passOn(open);
    StreamedRequest asked(io, *open, url, timeouts);
    if (auto ok = asked.send(request); !ok) return passOn(ok);
    if (asked.status() >= 400) {
        std::string text;
        const auto keep = [&](std::span<const std::byte> bytes) -> Expected<void> {
            if (text.size() + bytes.size() > longestRefusal)
                return fail(ErrorCode::ResourceLimit,
                            url.authority() + " refuses with a text that is too long.");
            text.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
            return {};
        };
        if (auto ok = asked.read(keep); !ok) return passOn(ok);
        const StreamedAnswer answer = asked.answer();
        return tl::unexpected(refusal(url, answer.status, answer.header("Content-Type"), text));
    }
    if (auto ok = asked.read(take); !ok) return passOn(ok);
    return asked.answer();
}

}  // namespace

Expected<StreamedAnswer> httpPostStreamed(const ServerUrl& url, const std::string& target, std::string json,
                                          std::string_view accept, const Credentials& credentials,
                                          const Timeouts& timeouts, const TakeBytes& take) {
    http::request<http::string_body> request(http::verb::post, target, 11);
    request.set(http::field::content_type, "application/json");
    request.body() = std::move(json);
    return streamed(url, std::move(request), accept, credentials, timeouts, take);
}

Expected<StreamedAnswer> httpGetStreamed(const ServerUrl& url, const std::string& target,
                                         std::string_view accept, const Credentials& credentials,
                                         const Timeouts& timeouts, const TakeBytes& take) {
    return streamed(url, {http::verb::get, target, 11}, accept, credentials, timeouts, take);
}

}  // namespace scancast::client
