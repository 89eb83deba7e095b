#include "server/net/stream_connection.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <deque>
#include <optional>

#include "server/describe.hpp"
#include "server/stream/catalog_world.hpp"
#include "server/stream/session.hpp"

namespace scancast {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;
using Clock = StreamSession::Clock;

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

class StreamConnection final : public Connection,
                               public StreamPort,
                               public std::enable_shared_from_this<StreamConnection> {
  public:
    StreamConnection(NetStream stream, http::request<http::empty_body> request, NetContext& context)
        : ws_(std::move(stream)),
          context_(context),
          world_(context.catalog),
          request_(std::move(request)),
          timer_(ws_.get_executor()),
          closeTimer_(ws_.get_executor()) {}

    ~StreamConnection() override {
        context_.connections.remove(this);
        if (!session_) return;
        session_->connectionLost(false, Clock::now());
        context_.scheduler.closeMailbox(mailbox_);
        context_.sessions.fetch_sub(1);
        context_.metrics.sessionClosed();
    }

    void run() {
        // tcp_stream's own deadlines belong to HTTP; from here on the WebSocket keeps time.
        ws_.next_layer().tcp().expires_never();
        websocket::stream_base::timeout patience;
        patience.handshake_timeout = context_.limits.closeTimeout;
        patience.idle_timeout = context_.limits.idleTimeout;
        patience.keep_alive_pings = true;
        ws_.set_option(patience);
        ws_.read_message_max(context_.limits.maxHelloBytes);
        ws_.auto_fragment(false);
        const bool known = offersProtocol(request_);
        ws_.set_option(websocket::stream_base::decorator([known](websocket::response_type& response) {
            if (known) response.set(http::field::sec_websocket_protocol, std::string(webSocketProtocol));
            response.set(http::field::server, "scancast");
        }));
        ws_.async_accept(request_,
                         [self = shared_from_this(), known](error_code ec) { self->onAccept(ec, known); });
    }

    void shutDown() override {
        asio::post(ws_.get_executor(), [weak = weak_from_this()] {
            const auto self = weak.lock();
            if (!self) return;
            if (self->session_) return self->session_->goAway();
            self->ws_.next_layer().tcp().close();  // still shaking hands, or refused already
        });
    }

    void sayGoodbye() override { shutDown(); }

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
        enqueue(std::move(message));
    }

    void sendFrame(const FrameHeader& header, std::shared_ptr<const Bytes> picture) override {
        if (closing_) return;
        Outgoing message;
        message.header = printFrameHeader(header);
        message.picture = std::move(picture);
        enqueue(std::move(message));
    }

    void order(std::uint64_t number, PictureOrder order) override {
        context_.scheduler.wish(mailbox_, std::move(order), doneFor(number));
    }

    bool replaceWaiting(std::uint64_t number, PictureOrder order) override {
        return context_.scheduler.replaceWaiting(mailbox_, std::move(order), doneFor(number));
    }

    void pick(std::uint64_t seq, std::shared_ptr<const Cloud> cloud, View view, double x, double y) override {
        // The answer comes from another thread, or at once from here; either way it is posted.
        auto done = [weak = weak_from_this(), executor = ws_.get_executor(), seq,
                     cloud](Expected<std::optional<Picked>> picked) {
            auto point = picked.map([&](const std::optional<Picked>& found) {
                return found ? pickedJson(*cloud, *found) : nlohmann::json();
            });
            asio::post(executor, [weak, seq, point = std::move(point)]() mutable {
                const auto self = weak.lock();
                if (self && !self->gone_ && !self->closing_) self->session_->pickDone(seq, std::move(point));
            });
        };
        if (auto asked = context_.api.picker().pick(cloud, view, x, y, done); !asked)
            done(tl::unexpected(std::move(asked.error())));
    }

    void abandon() override { context_.scheduler.abandon(mailbox_); }

    void close(CloseCode code, std::string reason) override {
        if (closing_) return;
        closing_ = websocket::close_reason(websocket::close_code(code), shortReason(std::move(reason)));
        closeTimer_.expires_after(context_.limits.closeTimeout);
        closeTimer_.async_wait([weak = weak_from_this()](error_code ec) {
            const auto self = weak.lock();
            if (self && !ec) self->ws_.next_layer().tcp().close();
        });
        if (!writing_) sendClose();
    }

    std::function<void()> onTaken() override {
        return [weak = weak_from_this(), executor = ws_.get_executor()] {
            asio::post(executor, [weak] {
                const auto self = weak.lock();
                if (self && !self->gone_ && !self->closing_) self->session_->taken();
            });
        };
    }

  private:
    struct Outgoing {
        std::string text;  ///< unless there is a picture
        std::array<std::uint8_t, frameHeaderLength> header{};
        std::shared_ptr<const Bytes> picture;
    };

    void onAccept(error_code ec, bool known) {
        if (ec) return;
        if (!known) {
            close(CloseCode::ProtocolError, "Offer the subprotocol scancast.v1.");
        } else if (context_.sessions.fetch_add(1) >= context_.limits.maxSessions) {
            context_.sessions.fetch_sub(1);
            close(CloseCode::TryAgainLater, "All sessions are taken; try again later.");
        } else {
            openSession();
        }
        read();
    }

    void openSession() {
        context_.metrics.sessionOpened();
        mailbox_ = context_.scheduler.openMailbox();
        SessionOptions options;
        options.id = "s" + std::to_string(context_.lastSession.fetch_add(1) + 1);
        options.resumable = &context_.resumable;
        options.maxPixels = context_.limits.maxPixels;
        options.quiet = context_.limits.quiet;
        options.helloPatience = context_.limits.helloTimeout;
        session_.emplace(std::move(options), world_, *this, context_.metrics, Clock::now());
        if (context_.scheduler.draining()) return session_->goAway();  // came in with the last goodbyes
        keepTime();
    }

    void read() {
        ws_.async_read(buffer_,
                       [self = shared_from_this()](error_code ec, std::size_t) { self->onRead(ec); });
    }

    void onRead(error_code ec) {
        if (ec) {
            // Closed, gone, or sent what WebSocket forbids: Beast has answered with 1002, 1007 or 1009
            // itself.
            gone_ = true;
            if (session_) session_->connectionLost(saidGoodbye(ec), Clock::now());
            timer_.cancel();
            closeTimer_.cancel();
            return;
        }
        if (session_ && !closing_) {
            if (ws_.got_text()) {
                session_->text({static_cast<const char*>(buffer_.data().data()), buffer_.size()},
                               Clock::now());
                if (session_->greeted()) ws_.read_message_max(maxMessageBytes);
            } else {
                session_->binary();
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

    // The scheduler's threads only post; what is late for a connection that is gone falls away.
    PictureDone doneFor(std::uint64_t number) {
        return [weak = weak_from_this(), executor = ws_.get_executor(), number](Expected<Picture> result) {
            asio::post(executor, [weak, number, result = std::move(result)]() mutable {
                const auto self = weak.lock();
                if (!self || self->gone_ || self->closing_) return;
                self->session_->pictureDone(number, std::move(result), Clock::now());
                self->keepTime();
            });
        };
    }

    void keepTime() {
        const auto wake = session_->wakeAt();
        if (wake == armed_) return;
        armed_ = wake;
        timer_.cancel();
        if (!wake) return;
        timer_.expires_at(*wake);
        timer_.async_wait([weak = weak_from_this()](error_code ec) {
            const auto self = weak.lock();
            if (!self || ec || self->gone_ || self->closing_) return;
            self->armed_.reset();
            self->session_->tick(Clock::now());
            self->keepTime();
        });
    }

    void enqueue(Outgoing message) {
        queue_.push_back(std::move(message));
        if (!writing_) writeNext();
    }

    void writeNext() {
        writing_ = true;
        const Outgoing& message = queue_.front();
        auto onWritten = [self = shared_from_this()](error_code ec, std::size_t) { self->onWritten(ec); };
        if (message.picture) {
            ws_.binary(true);
            ws_.async_write(std::array<asio::const_buffer, 2>{asio::buffer(message.header),
                                                              asio::buffer(*message.picture)},
                            std::move(onWritten));
        } else {
            ws_.text(true);
            ws_.async_write(asio::buffer(message.text), std::move(onWritten));
        }
    }

    void onWritten(error_code ec) {
        writing_ = false;
        queue_.pop_front();
        if (ec) {
            queue_.clear();
            return;
        }
        if (!queue_.empty()) return writeNext();
        if (closing_) sendClose();
    }

    void sendClose() {
        ws_.async_close(*closing_, [self = shared_from_this()](error_code) {});
    }

    websocket::stream<NetStream> ws_;
    NetContext& context_;
    const CatalogWorld world_;
    http::request<http::empty_body> request_;
    beast::flat_buffer buffer_;
    asio::steady_timer timer_, closeTimer_;
    std::optional<Clock::time_point> armed_;
    Scheduler::MailboxId mailbox_ = 0;
    std::optional<StreamSession> session_;
    std::deque<Outgoing> queue_;
    bool writing_ = false;
    bool gone_ = false;
    std::optional<websocket::close_reason> closing_;
};

}  // namespace

void startStream(NetStream stream, http::request<http::empty_body> request, NetContext& context) {
    const auto connection =
        std::make_shared<StreamConnection>(std::move(stream), std::move(request), context);
    if (context.connections.add(connection, context.limits.maxConnections)) connection->run();
}

}  // namespace scancast
