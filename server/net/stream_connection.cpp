#include "server/net/stream_connection.hpp"

#include <fmt/format.h>

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <deque>
#include <optional>

#include "server/net/api/handler.hpp"
#include "server/net/session_host.hpp"
#include "server/net/write_watch.hpp"

namespace scancast {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;

bool offersProtocol(const http::request<http::empty_body>& request) {
    for (const auto& field : request) {
        if (field.name() != http::field::sec_websocket_protocol) continue;
        for (const auto token : http::token_list(field.value())) {
            if (token == beast::string_view(webSocketProtocol.data(), webSocketProtocol.size())) return true;
        }
    }
    return false;
}

// A close frame holds 123 bytes of reason; cut between characters.
std::string shortReason(std::string reason) {
    constexpr std::size_t longest = 120;
    if (reason.size() > longest) {
        reason.resize(longest);
        while (!reason.empty() && (static_cast<unsigned char>(reason.back()) & 0xc0) == 0x80)
            reason.pop_back();
        if (!reason.empty() && static_cast<unsigned char>(reason.back()) >= 0x80) reason.pop_back();
    }
    return reason;
}

class StreamConnection final : public SessionHost {
  public:
    StreamConnection(NetStream stream, http::request<http::empty_body> request, NetContext& context,
                     Grant grant, RequestRecord record)
        : SessionHost(stream.get_executor(), context, std::move(grant), std::move(record)),
          ws_(std::move(stream)),
          request_(std::move(request)),
          closeTimer_(ws_.get_executor()),
          watch_(ws_.get_executor(), context.limits.leastRate),
          buffers_(context.memory.hold(MemoryUse::Connections, bytesOfConnection)),
          texts_(context.memory.hold(MemoryUse::Texts)) {}

    void run() {
        // tcp_stream's own deadlines belong to HTTP; from here on the WebSocket keeps time.
        ws_.next_layer().tcp().expires_never();
        websocket::stream_base::timeout patience;
        // Beast's own clock also runs while a client that has answered a close keeps its line open. A read that waits then must
        // end before that clock does (Boost 1.74 asserts it): closeTimer_ goes first, by far.
        patience.handshake_timeout = 2 * context_.limits.closeTimeout;
        patience.idle_timeout = context_.limits.idleTimeout;
        patience.keep_alive_pings = true;
        ws_.set_option(patience);
        ws_.control_callback([this](websocket::frame_type kind, beast::string_view) {
            if (kind == websocket::frame_type::close && !closing_) cutSoon();
        });
        ws_.read_message_max(context_.limits.maxHelloBytes);
        ws_.auto_fragment(false);
        const bool known = offersProtocol(request_);
        ws_.set_option(websocket::stream_base::decorator(
            [known, id = ids().request,
             strictTransport = context_.api.strictTransport()](websocket::response_type& response) {
                if (known) response.set(http::field::sec_websocket_protocol, std::string(webSocketProtocol));
                response.set(http::field::server, "scancast");
                response.set("X-Request-Id", id);
                if (!strictTransport.empty())
                    response.set(http::field::strict_transport_security, strictTransport);
            }));
        ws_.async_accept(
            request_, handler([known](StreamConnection& self, error_code ec) { self.onAccept(ec, known); }));
    }

    // ---- StreamPort
    // -------------------------------------------------------------------------------------------

    void sendText(std::string text) override {
        if (closing_) return;
        if (queue_.size() >= context_.limits.maxQueuedTexts) {
            // A client that asks and asks and never reads: nothing more is promised to it.
            return close(CloseCode::PolicyViolation, "Too many unread messages.");
        }
        Outgoing message;
        message.text = std::move(text);
        unread_ += message.text.size();
        texts_.resize(unread_);
        enqueue(std::move(message));
    }

    void sendFrame(const FrameHeader& header, std::shared_ptr<const Bytes> picture,
                   std::shared_ptr<const Bytes> depth) override {
        if (closing_) return;
        if (writing_ && context_.memory.streamsAreFull()) return giveUpSlowReader();
        Outgoing message;
        message.header = printFrameHeader(header, depth ? depth->size() : 0);
        message.depth = std::move(depth);
        message.picture = std::move(picture);
        enqueue(std::move(message));
    }

    void close(CloseCode code, std::string reason) override {
        if (closing_) return;
        endsBecause(fmt::format("closed {}: {}", int(code), reason));
        closing_ = websocket::close_reason(websocket::close_code(code), shortReason(std::move(reason)));
        cutSoon();
        if (!writing_) sendClose();
    }

  private:
    /// There is no memory for what clients have not read, and this one has something to read.
    void giveUpSlowReader() {
        context_.metrics.slowReaderEnded();
        queue_.resize(1);  // what is being written
        texts_.resize(unread_ = queue_.front().text.size());
        close(CloseCode::TryAgainLater, "Frames are not read as fast as they come, and memory is short.");
    }

    /// The line ends with what is said last, or when its time is over, whatever the client does.
    void cutSoon() {
        closeTimer_.expires_after(context_.limits.closeTimeout);
        closeTimer_.async_wait([weak = weak_from_this()](error_code ec) {
            const auto self = std::static_pointer_cast<StreamConnection>(weak.lock());
            if (self && !ec) self->cut();
        });
    }

    std::shared_ptr<StreamConnection> self() {
        return std::static_pointer_cast<StreamConnection>(shared_from_this());
    }
    bool listening() const override { return !gone_ && !closing_; }
    void cut() override { ws_.next_layer().tcp().close(); }
    void giveUp() noexcept override { gone_ = true; }
    template <class Work>
    Handler<StreamConnection, Work> handler(Work work) {
        return {self(), std::move(work)};
    }

    struct Outgoing {
        std::string text;  ///< unless there is a picture
        std::array<std::uint8_t, frameHeaderLength> header{};
        std::shared_ptr<const Bytes> depth;  ///< between header and picture; may be null
        std::shared_ptr<const Bytes> picture;

        std::size_t size() const {
            return picture ? header.size() + (depth ? depth->size() : 0) + picture->size() : text.size();
        }
    };

    void onAccept(error_code ec, bool known) {
        if (ec) {
            constexpr int badRequest = 400;  // which Beast has answered
            refused(badRequest);
            return endsBecause(ec.message());
        }
        if (!known) {
            close(CloseCode::ProtocolError, "Offer the subprotocol scancast.v1.");
        } else if (!begin()) {
            close(CloseCode::TryAgainLater, "All sessions are taken; try again later.");
        }
        read();
    }

    bool begin() {
        SessionOptions options;
        options.resumable = &context_.resumable;
        options.video = &context_.video;
        if (!openSession(ClientKind::WebSocket, std::move(options))) return false;
        if (context_.scheduler.draining()) session()->goAway();  // came in with the last goodbyes
        if (const auto left = context_.leavesIn()) session()->moveOn({0, std::uint64_t(left->count())});
        return true;
    }

    void read() {
        ws_.async_read(buffer_,
                       handler([](StreamConnection& self, error_code ec, std::size_t) { self.onRead(ec); }));
    }

    void onRead(error_code ec) {
        if (ec) {
            // Closed, gone, or sent what WebSocket forbids: Beast has answered with 1002, 1007 or 1009
            // itself.
            gone_ = true;
            endsBecause(ec == websocket::error::closed ? "closed by the client"
                        : ec == beast::error::timeout  ? "silent for too long"
                                                       : "left");
            if (session()) session()->connectionLost(saidGoodbye(ec), Clock::now());
            leave();
            closeTimer_.cancel();
            return;
        }
        if (session() != nullptr && !closing_) {
            if (ws_.got_text()) {
                session()->text({static_cast<const char*>(buffer_.data().data()), buffer_.size()},
                                Clock::now());
                if (session()->greeted()) ws_.read_message_max(maxMessageBytes);
            } else {
                session()->binary();
            }
            keepTime();
        }
        buffer_.consume(buffer_.size());
        read();
    }

    // Not so a browser's tab that reloads (1001) or a line that breaks: whoever was there may come back.
    bool saidGoodbye(error_code ec) const {
        return ec == websocket::error::closed && ws_.reason().code == websocket::close_code::normal;
    }

    void enqueue(Outgoing message) {
        queue_.push_back(std::move(message));
        if (!writing_) writeNext();
    }

    void writeNext() {
        writing_ = true;
        watch_.begin(ws_.next_layer().tcp().socket().native_handle(), weak_from_this(), [this] {
            context_.metrics.slowReaderEnded();
            endsBecause("read too slowly");
            cut();
        });
        const Outgoing& message = queue_.front();
        auto onWritten =
            handler([](StreamConnection& self, error_code ec, std::size_t) { self.onWritten(ec); });
        if (message.picture) {
            ws_.binary(true);
            const auto depth = message.depth ? asio::buffer(*message.depth) : asio::const_buffer();
            ws_.async_write(std::array<asio::const_buffer, 3>{asio::buffer(message.header), depth,
                                                              asio::buffer(*message.picture)},
                            std::move(onWritten));
        } else {
            ws_.text(true);
            ws_.async_write(asio::buffer(message.text), std::move(onWritten));
        }
    }

    void onWritten(error_code ec) {
        writing_ = false;
        watch_.end();
        const Outgoing& message = queue_.front();
        if (!ec) count(message.size(), message.picture != nullptr);
        unread_ -= message.text.size();
        queue_.pop_front();
        texts_.resize(unread_);
        if (ec) {
            queue_.clear();
            texts_.resize(unread_ = 0);
            // Half a message may be on its way: nothing that came after it would be understood. The read that waits ends
            // with the connection. What was given up because it is being closed is no failure.
            if (ec != websocket::error::closed && ec != asio::error::operation_aborted) cut();
            return;
        }
        if (!queue_.empty()) return writeNext();
        if (closing_) sendClose();
    }

    void sendClose() {
        ws_.async_close(*closing_, handler([](StreamConnection&, error_code) {}));
    }

    websocket::stream<NetStream> ws_;
    http::request<http::empty_body> request_;
    beast::flat_buffer buffer_;
    asio::steady_timer closeTimer_;
    WriteWatch watch_;
    std::deque<Outgoing> queue_;
    const TransientMemory::Hold buffers_;
    TransientMemory::Hold texts_;
    std::size_t unread_ = 0;  // bytes of texts
    bool writing_ = false;
    bool gone_ = false;
    std::optional<websocket::close_reason> closing_;
};

}  // namespace

void startStream(NetStream stream, http::request<http::empty_body> request, NetContext& context,
                 ConnectionRegister::Place place, Grant grant, RequestRecord record) {
    constexpr int switchingProtocols = 101;
    record.status = switchingProtocols;
    const auto connection = std::make_shared<StreamConnection>(std::move(stream), std::move(request), context,
                                                               std::move(grant), std::move(record));
    connection->take(std::move(place));
    connection->run();
}

}  // namespace scancast
