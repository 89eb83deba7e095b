#include "client/cpp/stream.hpp"

#include "client/cpp/timed_io.hpp"

#include <atomic>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/error.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>

#include "client/cpp/paced_stream.hpp"
#include "client/cpp/refusal.hpp"
#include "protocol/nearest_name.hpp"
#include "protocol/text/plain_text.hpp"
#include "protocol/view/view_json.hpp"

namespace scancast::client {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;

constexpr std::size_t longestMessage = std::size_t{512} << 20u;  // a picture of 16384 × 16384 px at its worst
// Taken apart, JSON takes many times its length; and before the welcome nobody has shown to be a server.
constexpr std::size_t longestText = std::size_t{1} << 20u;

Error goodbye(std::uint16_t code, std::string_view reason) {
    const auto kind = code == static_cast<std::uint16_t>(CloseCode::TryAgainLater) ? ErrorCode::ResourceLimit
                      : code == static_cast<std::uint16_t>(CloseCode::GoingAway)   ? ErrorCode::Cancelled
                                                                                   : ErrorCode::Io;
    std::string message = "the server closed the session";
    if (!reason.empty()) message += ": " + plainText(reason);
    return {kind, message + " (close code " + std::to_string(code) + ")", {}};
}

/// What a message says; nothing when it is of a type from the future.
Expected<std::optional<StreamEvent>> eventOf(std::span<const std::uint8_t> bytes, bool text) {
    if (!text) {
        const auto frame = parseFrame(bytes);
        if (!frame) return passOn(frame);
        ReceivedFrame received{frame->header, {}, {frame->packedDepth.begin(), frame->packedDepth.end()}};
        auto& picture = frame->header.codec == Codec::Jpeg ? received.jpeg : received.h264;
        picture.assign(frame->picture.begin(), frame->picture.end());
        return received;
    }
    if (bytes.size() > longestText)
        return fail(ErrorCode::ResourceLimit, "the server sent a text of " + std::to_string(bytes.size()) +
                                                  " bytes, more than this client accepts");
    auto message = parseServerMessage({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    if (!message) {
        if (message.error().code == ErrorCode::Unsupported) return std::nullopt;
        return passOn(message);
    }
    if (auto* stats = std::get_if<messages::Stats>(&*message)) return std::move(*stats);
    if (auto* problem = std::get_if<messages::ProblemReport>(&*message)) return std::move(*problem);
    if (auto* picked = std::get_if<messages::Picked>(&*message)) return std::move(*picked);
    if (auto* drain = std::get_if<messages::Drain>(&*message)) return *drain;
    if (auto* pong = std::get_if<messages::Pong>(&*message)) return *pong;
    if (const auto* bye = std::get_if<messages::Bye>(&*message))
        return tl::unexpected(goodbye(static_cast<std::uint16_t>(bye->code), bye->reason));
    return fail(ErrorCode::Malformed, "the server said welcome twice");
}

}  // namespace

class Stream::Connection {
  public:
    Connection(ServerUrl url, const Timeouts& timeouts) : url_(std::move(url)), timeouts_(timeouts) {}

    ~Connection() {
        if (!socket_) return;
        drop();
        io_.restart();
        io_.poll();  // a read that still waits ends here, while what it reads into is there
    }

    Expected<void> open(const Credentials& credentials, double readBytesPerSecond) {
        auto connected = connectUntil(io_, url_, credentials, Clock::now() + timeouts_.connect);
        if (!connected) return passOn(std::move(connected));
        socket_ = std::make_unique<websocket::stream<PacedStream>>(std::move(*connected), readBytesPerSecond);
        socket_->read_message_max(longestText);
        socket_->auto_fragment(false);
        return handshake(credentials.token);
    }

    Expected<void> send(const ClientMessage& message) {
        const auto text = printMessage(message);
        socket_->text(true);
        const auto error =
            run([&](auto handler) { socket_->async_write(boost::asio::buffer(text), handler); });
        if (error) return tl::unexpected(lost(error, "sending a message"));
        return {};
    }

    using Bytes = std::span<const std::uint8_t>;

    /// One whole message; it stays valid until the next call. Nothing when there is none by the deadline, or
    /// when interrupted; what has arrived of it is kept.
    Expected<std::optional<Bytes>> readUntil(Clock::time_point deadline) {
        if (!reading_) {
            buffer_.clear();
            reading_ = true;
            arrived_.reset();
            socket_->async_read(buffer_, [this](ErrorCodeOfBoost error, std::size_t) { arrived_ = error; });
        }
        io_.restart();
        while (!arrived_ && !interrupted_.exchange(false) && io_.run_one_until(deadline) > 0) {
        }
        if (!arrived_) return std::nullopt;
        if (*arrived_) return tl::unexpected(lost(*arrived_, "waiting for the next message"));
        reading_ = false;
        const auto data = buffer_.cdata();
        return Bytes(static_cast<const std::uint8_t*>(data.data()), data.size());
    }

    /// The same with the deadline of an answer, which ends the session.
    Expected<Bytes> read() {
        const auto deadline = Clock::now() + timeouts_.answer;
        for (;;) {
            const auto bytes = readUntil(deadline);
            if (!bytes) return passOn(bytes);
            if (*bytes) return **bytes;
            if (Clock::now() < deadline) continue;  // interrupted
            drop();
            return tl::unexpected(lost(boost::asio::error::timed_out, "waiting for the next message"));
        }
    }

    /// From the welcome on, messages may be as long as pictures are.
    void acceptPictures() { socket_->read_message_max(longestMessage); }

    void interrupt() {
        interrupted_ = true;
        boost::asio::post(io_, [] {});
    }

    /// For an answer.
    std::chrono::milliseconds patience() const { return timeouts_.answer; }

    bool gotText() const { return socket_->got_text(); }

    Expected<void> close(std::chrono::milliseconds patience) {
        const auto error = runUntil(
            io_, Clock::now() + patience,
            [&](auto handler) { socket_->async_close(websocket::close_code::normal, handler); },
            [this] { drop(); });
        // Whoever hangs up first has closed, too; proxies do so without another word.
        const bool hungUp = error == websocket::error::closed || error == boost::asio::error::eof ||
                            error == boost::asio::error::connection_reset ||
                            error == boost::asio::error::broken_pipe ||
                            error == boost::asio::ssl::error::stream_truncated;
        if (error && !hungUp) return tl::unexpected(lost(error, "closing the session"));
        return {};
    }

    messages::Welcome welcome;

  private:
    template <class Start>
    ErrorCodeOfBoost run(Start start) {
        return runUntil(io_, Clock::now() + timeouts_.answer, start, [this] { drop(); });
    }

    void drop() {
        ErrorCodeOfBoost ignored;  // the session is over either way
        socket_->next_layer().net().tcp().socket().close(ignored);
    }

    Expected<void> handshake(const std::string& token) {
        socket_->set_option(websocket::stream_base::decorator([&token](websocket::request_type& request) {
            if (!token.empty()) request.set(http::field::authorization, "Bearer " + token);
            request.set(http::field::user_agent, "scancast-client");
            request.set(http::field::sec_websocket_protocol, std::string(webSocketProtocol));
        }));
        websocket::response_type response;
        const auto error = run([&](auto handler) {
            socket_->async_handshake(response, url_.authority(), std::string(webSocketPath), handler);
        });
        if (error == websocket::error::upgrade_declined)
            return tl::unexpected(refusal(url_, static_cast<int>(response.result_int()),
                                          std::string(response[http::field::content_type]), response.body()));
        if (error) return tl::unexpected(networkError(error, url_, "opening the stream"));
        const std::string agreed(response[http::field::sec_websocket_protocol]);
        if (agreed != webSocketProtocol)
            return fail(ErrorCode::Unsupported,
                        url_.authority() + " speaks " +
                            (agreed.empty() ? "no subprotocol" : "subprotocol " + quoteText(agreed)) +
                            " where this client needs scancast.v1: is it a Scancast server of this version?");
        return {};
    }

    Error lost(const ErrorCodeOfBoost& error, std::string_view doing) const {
        if (error == websocket::error::closed) {
            const auto& reason = socket_->reason();
            return goodbye(reason.code, std::string_view(reason.reason.data(), reason.reason.size()));
        }
        return networkError(error, url_, doing);
    }

    ServerUrl url_;
    Timeouts timeouts_;
    boost::asio::io_context io_;
    std::unique_ptr<websocket::stream<PacedStream>> socket_;
    beast::flat_buffer buffer_;
    bool reading_ = false;                     // from the first wait for a message until it is handed over
    std::optional<ErrorCodeOfBoost> arrived_;  // how that ended
    std::atomic<bool> interrupted_ = false;
};

Stream::Stream(std::unique_ptr<Connection> connection) : connection_(std::move(connection)) {}
Stream::Stream(Stream&&) noexcept = default;
Stream& Stream::operator=(Stream&&) noexcept = default;
Stream::~Stream() = default;

Expected<Stream> Stream::open(const ServerUrl& url, const messages::Hello& hello, const Timeouts& timeouts,
                              const Credentials& credentials, double readBytesPerSecond) {
    auto connection = std::make_unique<Connection>(url, timeouts);
    if (auto ok = connection->open(credentials, readBytesPerSecond); !ok) return passOn(ok);
    if (auto ok = connection->send(hello); !ok) return passOn(ok);
    const auto text = connection->read();
    if (!text) return passOn(text);
    if (!connection->gotText())
        return fail(ErrorCode::Malformed, url.authority() + " sent a frame before its welcome");
    const auto message = parseServerMessage({reinterpret_cast<const char*>(text->data()), text->size()});
    if (!message) return passOn(message);
    if (const auto* problem = std::get_if<messages::ProblemReport>(&*message))
        return tl::unexpected(errorOf(problem->problem));
    if (const auto* bye = std::get_if<messages::Bye>(&*message))
        return tl::unexpected(goodbye(static_cast<std::uint16_t>(bye->code), bye->reason));
    const auto* welcome = std::get_if<messages::Welcome>(&*message);
    if (!welcome) return fail(ErrorCode::Malformed, url.authority() + " did not answer hello with a welcome");
    connection->welcome = *welcome;
    connection->acceptPictures();
    return Stream(std::move(connection));
}

const messages::Welcome& Stream::welcome() const {
    return connection_->welcome;
}

Expected<void> Stream::sendView(std::uint64_t seq, const View& view) {
    return send(messages::ViewChange{seq, std::nullopt, toJson(view)});
}

Expected<void> Stream::send(const ClientMessage& message) {
    return connection_->send(message);
}

Expected<void> Stream::ack(const FrameHeader& header) {
    return send(messages::Ack{header.frameId});
}

Expected<StreamEvent> Stream::receive() {
    for (;;) {
        const auto bytes = connection_->read();
        if (!bytes) return passOn(bytes);
        auto event = eventOf(*bytes, connection_->gotText());
        if (!event) return passOn(std::move(event));
        if (*event) return std::move(**event);
    }
}

Expected<std::optional<StreamEvent>> Stream::receiveFor(std::chrono::milliseconds wait) {
    const auto deadline = Clock::now() + wait;
    for (;;) {
        const auto bytes = connection_->readUntil(deadline);
        if (!bytes) return passOn(bytes);
        if (!*bytes) return std::nullopt;
        auto event = eventOf(**bytes, connection_->gotText());
        if (!event || *event) return event;
    }
}

void Stream::interrupt() {
    connection_->interrupt();
}

Expected<ReceivedFrame> Stream::receiveFrame() {
    for (;;) {
        auto event = receive();
        if (!event) return passOn(event);
        if (auto* frame = std::get_if<ReceivedFrame>(&*event)) return std::move(*frame);
        if (const auto* report = std::get_if<messages::ProblemReport>(&*event))
            return tl::unexpected(errorOf(report->problem));
    }
}

Expected<void> Stream::close() {
    return connection_->close(connection_->patience());
}

Expected<void> Stream::close(std::chrono::milliseconds patience) {
    return connection_->close(std::min(patience, connection_->patience()));
}

}  // namespace scancast::client
