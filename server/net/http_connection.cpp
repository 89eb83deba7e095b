#include <utility>  // before Beast: Boost 1.74 forgets it

#include "server/net/http_connection.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <boost/asio/dispatch.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <limits>
#include <optional>
#include <stop_token>

#include "server/net/api/handler.hpp"
#include "server/net/clients/public_url.hpp"
#include "server/net/log/shown_target.hpp"
#include "server/net/mjpeg_connection.hpp"
#include "server/net/refused_connection.hpp"
#include "server/net/stream_connection.hpp"
#include "server/net/write_watch.hpp"
#include "transport/net_stream.hpp"

namespace scancast {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using boost::system::error_code;

HttpRequest plain(const http::request_header<>& request) {
    HttpRequest result;
    result.method = std::string(request.method_string());
    result.target = std::string(request.target());
    for (const auto& field : request) {
        result.headers.emplace_back(lowerCase({field.name_string().data(), field.name_string().size()}),
                                    std::string(field.value()));
    }
    result.ids = RequestIds::of(result.header("x-request-id"), result.header("traceparent"));
    return result;
}

constexpr std::chrono::milliseconds watchInterval{40};

std::optional<IpAddress> peerOf(const asio::ip::tcp::socket& socket) {
    error_code none;
    const asio::ip::address address = socket.remote_endpoint(none).address();
    if (none) return std::nullopt;
    return address.is_v4() ? IpAddress::ofV4(address.to_v4().to_bytes())
                           : IpAddress::ofV6(address.to_v6().to_bytes());
}

class HttpConnection final : public Connection, public std::enable_shared_from_this<HttpConnection> {
  public:
    HttpConnection(asio::ip::tcp::socket socket, const std::optional<IpAddress>& peer, NetContext& context,
                   Entrance entrance)
        : encrypted_(context.tlsOf(entrance) != nullptr),
          stream_(streamOf(std::move(socket), context.tlsOf(entrance))),
          context_(context),
          entrance_(entrance),
          buffer_(2 * context.limits.maxHeaderBytes),
          peer_(peer),
          watch_(stream_.get_executor()),
          writing_(stream_.get_executor(), context.limits.leastRate),
          buffers_(context.memory.hold(MemoryUse::Connections, bytesOfConnection)),
          texts_(context.memory.hold(MemoryUse::Texts)) {}

    void run(ConnectionRegister::Place place) {
        place_ = std::move(place);
        place_.heldBy(shared_from_this());
        place_.idle();
        asio::dispatch(stream_.get_executor(), handler([](HttpConnection& self) { self.greet(); }));
    }

    void shutDown() override {
        asio::post(stream_.get_executor(), [weak = weak_from_this()] {
            const auto self = weak.lock();
            if (!self) return;
            self->leaving_ = true;
            if (!self->answering_) self->close();
        });
    }

    void fault() noexcept {
        if (!context_.connections.shuttingDown()) close();
    }

  private:
    template <class Work>
    Handler<HttpConnection, Work> handler(Work work) {
        return {shared_from_this(), std::move(work)};
    }

    void close() noexcept {
        if (handedOver_) return;
        std::ignore = contained("Closing a connection", [this] { stream_.tcp().close(); });
    }

    static NetStream streamOf(asio::ip::tcp::socket socket, std::shared_ptr<asio::ssl::context> tls) {
        beast::tcp_stream tcp(std::move(socket));
        return tls ? NetStream(std::move(tcp), std::move(tls)) : NetStream(std::move(tcp));
    }

    void greet() {
        stream_.tcp().expires_after(context_.limits.requestTimeout);
        stream_.handshake(NetStream::Side::Server,
                          sharedHandler(shared_from_this(), [](HttpConnection& self, error_code ec) {
                              if (!ec) self.readHead();
                          }));
    }

    void readHead() {
        answering_ = false;
        if (leaving_) return closeGently();
        awaitNext();
        parser_.emplace();
        parser_->header_limit(context_.limits.maxHeaderBytes);
        // A body that nobody wants is answered by its head; one that is wanted gets its limit when it is
        // read.
        parser_->body_limit(std::numeric_limits<std::uint64_t>::max());
        // One deadline for the whole head: a client that sends a byte now and then gains nothing.
        stream_.tcp().expires_after(context_.limits.requestTimeout);
        http::async_read_header(
            stream_, buffer_, *parser_,
            handler([](HttpConnection& self, error_code ec, std::size_t) { self.onHead(ec); }));
    }

    void awaitNext() {
        place_.idle();
        if (!proxied_) return;
        proxied_ = false;
        std::ignore = place_.countFor(context_.peerOf(peer_));  // a proxy's, which is not limited
    }

    // False when it has been answered that there is no place: for the client behind a proxy, or for anybody any more.
    bool countRequest() {
        if (!place_.busy()) {
            refuse(refusalResponse(ConnectionRefusal::Full, context_.registerOf(entrance_).limits()));
            return false;
        }
        request_.base = publicUrl(request_, encrypted_, peer_ && context_.proxies.trusts(*peer_));
        if (!peer_) return true;
        const CountedClient client = context_.proxies.clientOf(request_, *peer_);
        request_.client = client.client;
        inHand_.record().client = client.client;
        proxied_ = entrance_ == Entrance::Public && context_.proxies.trusts(*peer_);
        if (!proxied_) return true;
        if (const auto counted = place_.countFor(client); !counted) {
            write(refusalResponse(counted.error(), context_.connections.limits()), "refused");
            return false;
        }
        return true;
    }

    void onHead(error_code ec) {
        if (ec == http::error::end_of_stream) return closeGently();
        request_ = {};
        if (ec == http::error::header_limit || ec == http::error::buffer_overflow) {
            return refuse(431, "The headers of the request are longer than this server accepts.");
        }
        if (ec) return dropOrRefuse(ec);
        const auto& head = parser_->get();
        request_ = plain(head);
        beginRecord();
        // What is not read of a request would be taken for the next one.
        keepAlive_ = head.keep_alive() && parser_->is_done();
        version_ = head.version();
        if (std::string fault = framingFault(request_, version_); !fault.empty()) return refuse(400, fault);
        answering_ = true;
        stream_.tcp().expires_never();
        auto answered = contained("The server", [this] {
            if (countRequest()) answer();
        });
        if (!answered && !handedOver_) refuse(problemOf(answered.error()));
    }

    // Of what cannot be read as a request, the log has the client alone.
    void beginRecord() {
        RequestRecord record;
        record.method = request_.method;
        if (!record.method.empty()) record.target = shownTarget(request_.target);
        record.ids = request_.ids;
        if (peer_) record.client = peer_->client();
        inHand_ = context_.requestLog.begin(std::move(record));
    }

    // Errors of the parser are about what was sent; all others are about the connection, which is gone.
    void dropOrRefuse(error_code ec) {
        const bool ofParser = ec.category() == http::make_error_code(http::error::bad_method).category();
        if (ofParser && ec != http::error::partial_message)
            refuse(400, "This is not an HTTP/1.1 request: " + ec.message() + ".");
    }

    void answer() {
        auto routed = context_.api.admit(request_, entrance_);
        if (!routed) return write(std::move(routed.error()), "refused");
        inHand_.record().token = routed->grant.identity.name;
        const bool upgrade = beast::websocket::is_upgrade(parser_->get());
        if (routed->route == Route::Stream && upgrade && context_.api.leaving())
            return write(problemResponse(problemOf(503, "The server is shutting down.", routed->path)),
                         pattern(Route::Stream));
        if (routed->route == Route::Stream && upgrade) {
            context_.metrics.httpRequest(pattern(Route::Stream), 101);
            inHand_.record().route = pattern(Route::Stream);
            handedOver_ = true;
            return startStream(std::move(stream_),
                               http::request<http::empty_body>(std::move(parser_->get().base())), context_,
                               std::move(place_), std::move(routed->grant), inHand_.handOver());
        }
        if (routed->route == Route::StreamMjpeg && request_.method == "GET") {
            inHand_.record().route = pattern(Route::StreamMjpeg);
            handedOver_ = true;
            return startMjpeg(std::move(stream_), std::move(request_), std::move(*routed), context_,
                              std::move(place_), inHand_.handOver());
        }
        if (request_.method == "POST") return readBody(std::move(*routed));
        ask(*routed);
    }

    void readBody(Routed routed) {
        if (parser_->content_length().value_or(0) > context_.limits.maxBodyBytes) return refuseBody();
        parser_->body_limit(context_.limits.maxBodyBytes);
        answering_ = false;  // a shutdown does not wait for the rest
        place_.idle();
        stream_.tcp().expires_after(context_.limits.requestTimeout);
        if (request_.header("expect") == "100-continue") {
            static constexpr std::string_view goOn = "HTTP/1.1 100 Continue\r\n\r\n";
            return asio::async_write(stream_, asio::buffer(goOn),
                                     handler([routed = std::move(routed)](HttpConnection& self, error_code ec,
                                                                          std::size_t) mutable {
                                         if (!ec) self.readRest(std::move(routed));
                                     }));
        }
        readRest(std::move(routed));
    }

    void readRest(Routed routed) {
        http::async_read(
            stream_, buffer_, *parser_,
            handler([routed = std::move(routed)](HttpConnection& self, error_code ec, std::size_t) {
                if (ec == http::error::body_limit) return self.refuseBody();
                if (ec) return self.dropOrRefuse(ec);
                self.stream_.tcp().expires_never();
                if (!self.place_.busy()) return;  // it closes
                self.keepAlive_ = self.parser_->get().keep_alive();
                self.request_.body = std::move(self.parser_->get().body());
                self.texts_.resize(self.request_.body.size());
                self.ask(routed);
            }));
    }

    void refuseBody() {
        refuse(413,
               fmt::format("The body of a request may have at most {} bytes.", context_.limits.maxBodyBytes));
    }

    // The answer may come from the scheduler's threads; it is written on the strand. Where asking fails
    // half-way, an answer may come nevertheless: the first one counts.
    void ask(const Routed& routed) {
        answering_ = true;
        const std::uint64_t request = unanswered_ = ++requests_;
        const Respond respond = [self = shared_from_this(), request,
                                 route = routed.route](HttpResponse response) {
            asio::post(self->stream_.get_executor(), [self, request, route,
                                                      response = std::move(response)]() mutable {
                onBehalfOf(*self, [&] { self->answered(request, std::move(response), pattern(route)); });
            });
        };
        gone_ = std::stop_source();
        watchClient(request);
        const auto asked = contained(
            "The server", [&] { context_.api.answer(request_, routed, respond, gone_.get_token()); });
        if (!asked)
            answered(request, problemResponse(problemOf(asked.error(), routed.path)), pattern(routed.route));
    }

    // Who has gone, or has closed his half, waits for no answer: what is made for him is given up. Asked of the system
    // by itself, because what a client still sends must stay unread until it is answered. An answer that is lost ends
    // the connection, so this must not keep it.
    void watchClient(std::uint64_t request) {
        watch_.expires_after(watchInterval);
        watch_.async_wait([weak = weak_from_this(), request](error_code ec) {
            const auto self = weak.lock();
            if (!ec && self) onBehalfOf(*self, [&] { self->lookAfterClient(request); });
        });
    }

    void lookAfterClient(std::uint64_t request) {
        if (unanswered_ != request && !body_) return;
        pollfd peer{stream_.tcp().socket().native_handle(), POLLRDHUP, 0};
        if (::poll(&peer, 1, 0) <= 0) return watchClient(request);
        unanswered_ = 0;
        breakOff("left");
    }

    // What was being made for him ends, and so does the connection: he sees that it was not all.
    void breakOff(std::string_view why) {
        inHand_.left(body_ ? body_->sent : 0, why);
        body_.reset();
        response_ = {};
        gone_.request_stop();
        close();
    }

    void answered(std::uint64_t request, HttpResponse response, std::string_view route) {
        if (unanswered_ == request) write(std::move(response), route);
    }

    void refuse(int status, std::string detail) { refuse(problemOf(status, std::move(detail))); }

    void refuse(const Problem& problem) { refuse(problemResponse(problem)); }

    void refuse(HttpResponse response) {
        RequestIds ids = std::move(request_.ids);
        std::string accept = request_.header("accept");  // whether a person or a program reads the refusal
        request_ = {};
        if (!accept.empty()) request_.headers.emplace_back("accept", std::move(accept));
        request_.ids = ids.request.empty() ? RequestIds::of({}, {}) : std::move(ids);
        if (!inHand_) beginRecord();
        keepAlive_ = false;
        version_ = 11;
        write(std::move(response), "refused");
    }

    void write(HttpResponse response, std::string_view route) {
        unanswered_ = 0;
        watch_.cancel();
        response_ = std::move(response);
        if (response_.source && version_ < 11)
            response_ = problemResponse(problemOf(505,
                                                  "This is answered in chunks, which HTTP/1.0 does not know: "
                                                  "without them nobody could see that an "
                                                  "answer was cut short. Ask by HTTP/1.1."));
        context_.api.complete(request_, route, response_, entrance_);
        inHand_.record().status = response_.status;
        inHand_.record().route = route;
        inHand_.record().price = response_.price;
        if (entrance_ == Entrance::Probes) {  // who does not read may go for the next probe
            answering_ = false;
            place_.idle();
        }
        keepAlive_ = keepAlive_ && !leaving_;
        const auto body = response_.body();
        texts_.resize(request_.body.size() + response_.text.size());
        if (response_.source) return writeStreamed();
        watchWriting(body.size());
        auto onWritten =
            handler([](HttpConnection& self, error_code ec, std::size_t n) { self.onWritten(ec, n); });
        const bool neverHasBody = response_.status == 304 || response_.status == 204;
        if (request_.method == "HEAD" || neverHasBody) {
            bodyless_.emplace(http::int_to_status(unsigned(response_.status)), version_);
            fill(*bodyless_);
            if (!neverHasBody && !response_.bodyUnknown)
                bodyless_->content_length(response_.bodyBytes.value_or(body.size()));
            http::async_write(stream_, *bodyless_, std::move(onWritten));
        } else {
            message_.emplace(http::int_to_status(unsigned(response_.status)), version_);
            fill(*message_);
            message_->body() = {body.data(), body.size()};
            message_->content_length(body.size());
            http::async_write(stream_, *message_, std::move(onWritten));
        }
    }

    void watchWriting(std::size_t bytes) {
        if (writing_.begin(stream_.tcp().socket().native_handle(), weak_from_this(),
                           [this] { endSlowReader(); }))
            stream_.tcp().expires_never();
        else
            stream_.tcp().expires_after(context_.limits.writeTimeout + std::chrono::seconds(bytes / 65536));
    }

    // ---- an answer whose body is made while it is sent: a chunk for each part, the next one in the making

    struct Body {
        std::shared_ptr<BodySource> source;
        std::shared_ptr<const BodyPart> now, next;  ///< being written; waiting for that
        std::string head, tail;                     ///< around `now`
        bool writing = false;
        std::uint64_t sent = 0;
    };

    void writeStreamed() {
        bodyless_.emplace(http::int_to_status(unsigned(response_.status)), version_);
        fill(*bodyless_);
        bodyless_->chunked(true);
        headSerializer_.emplace(*bodyless_);
        body_ = std::make_shared<Body>();
        body_->source = std::move(response_.source);
        body_->writing = true;
        watchClient(requests_);
        watchWriting(0);
        http::async_write_header(
            stream_, *headSerializer_,
            handler([](HttpConnection& self, error_code ec, std::size_t n) { self.onPartWritten(ec, n); }));
        askForPart();
    }

    void askForPart() {
        body_->source->next(
            [self = shared_from_this(), request = requests_](Expected<std::shared_ptr<const BodyPart>> part) {
                asio::post(self->stream_.get_executor(), [self, request, part = std::move(part)]() mutable {
                    onBehalfOf(*self, [&] {
                        if (self->body_ && self->requests_ == request) self->onPart(std::move(part));
                    });
                });
            });
    }

    void onPart(Expected<std::shared_ptr<const BodyPart>> part) {
        if (!part) {
            reportFault(part.error());
            return breakOff("broken off: what it comes from could not be read");
        }
        body_->next = std::move(*part);
        if (!body_->writing) writePart();
    }

    void writePart() {
        Body& body = *body_;
        body.now = std::exchange(body.next, nullptr);
        const std::size_t bytes = body.now->bytes.size();
        body.head = bytes > 0 ? fmt::format("{:x}\r\n", bytes) : "";
        body.tail = bytes > 0 ? "\r\n" : "";
        if (body.now->last) {
            body.tail += "0\r\n";
            for (const auto& [name, value] : body.now->trailers) body.tail += name + ": " + value + "\r\n";
            body.tail += "\r\n";
        } else {
            askForPart();
        }
        body.writing = true;
        watchWriting(bytes);
        asio::async_write(
            stream_,
            std::array<asio::const_buffer, 3>{asio::buffer(body.head), asio::buffer(body.now->bytes),
                                              asio::buffer(body.tail)},
            handler([kept = body_](HttpConnection& self, error_code ec, std::size_t n) {
                self.onPartWritten(ec, n);
            }));
    }

    void onPartWritten(error_code ec, std::size_t bytes) {
        writing_.end();
        if (!body_) return;
        body_->sent += bytes;
        if (ec) return breakOff("left");
        body_->writing = false;
        if (body_->now && body_->now->last) return onStreamed();
        body_->now.reset();
        if (body_->next) writePart();
    }

    void onStreamed() {
        watch_.cancel();
        inHand_.answered(body_->sent);
        body_.reset();
        headSerializer_.reset();
        bodyless_.reset();
        response_ = {};
        texts_.resize(0);
        if (keepAlive_) return readHead();
        closeGently();
    }

    template <class Message>
    void fill(Message& message) {
        message.result(unsigned(response_.status));
        message.reason(
            beast::string_view(reasonPhrase(response_.status).data(), reasonPhrase(response_.status).size()));
        for (const auto& [name, value] : response_.headers) message.insert(name, value);
        message.keep_alive(keepAlive_);
    }

    void endSlowReader() {
        context_.metrics.slowReaderEnded();
        std::ignore = contained("The request log", [this] { inHand_.record().note = "read too slowly"; });
        gone_.request_stop();
        body_.reset();
        close();
    }

    void onWritten(error_code ec, std::size_t bytes) {
        writing_.end();
        message_.reset();
        bodyless_.reset();
        response_ = {};
        texts_.resize(0);
        if (ec) return inHand_.left(bytes, "left");
        inHand_.answered(bytes);
        if (keepAlive_) return readHead();
        closeGently();
    }

    // Closing with unread input would reset the connection and could take the answer with it: what the client
    // still sends is read and thrown away for a moment.
    void closeGently() {
        stream_.tcp().expires_after(std::chrono::seconds(2));
        stream_.goodbye(sharedHandler(shared_from_this(), [](HttpConnection& self, error_code) {
            error_code ignored;
            self.stream_.tcp().socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
            self.discard(256 * 1024);
        }));
    }

    void discard(std::size_t allowance) {
        buffer_.clear();
        stream_.tcp().async_read_some(
            buffer_.prepare(context_.limits.maxHeaderBytes),
            handler([allowance](HttpConnection& self, error_code ec, std::size_t n) {
                if (!ec && n < allowance) self.discard(allowance - n);
            }));
    }

    ConnectionRegister::Place place_;  // first: given back when the socket has been closed
    const bool encrypted_;
    NetStream stream_;
    NetContext& context_;
    const Entrance entrance_;
    beast::flat_buffer buffer_;
    std::optional<http::request_parser<http::string_body>> parser_;
    HttpRequest request_;
    RequestLog::Request inHand_;
    unsigned version_ = 11;
    bool keepAlive_ = false;
    bool answering_ = false;
    bool leaving_ = false;
    bool handedOver_ = false;                      // the stream has gone to a session
    std::uint64_t requests_ = 0, unanswered_ = 0;  // numbers; 0 = none
    const std::optional<IpAddress> peer_;
    bool proxied_ = false;  // counted for the client of a proxy
    asio::steady_timer watch_;
    WriteWatch writing_;
    const TransientMemory::Hold buffers_;
    TransientMemory::Hold texts_;
    std::stop_source gone_{std::nostopstate};
    HttpResponse response_;  // kept while it is written: the messages below point into it
    std::optional<http::response<http::span_body<const char>>> message_;
    std::optional<http::response<http::empty_body>> bodyless_;
    std::optional<http::response_serializer<http::empty_body>> headSerializer_;
    std::shared_ptr<Body> body_;  // kept by its write, too, which may be under way when it is broken off
};

}  // namespace

void startHttp(asio::ip::tcp::socket socket, NetContext& context, Entrance entrance) {
    const auto peer = peerOf(socket);
    auto place = context.registerOf(entrance).enter(context.peerOf(peer));
    if (!place) {
        return refuseConnection(std::move(socket), peer ? peer->client() : std::string(), place.error(),
                                context, entrance);
    }
    std::make_shared<HttpConnection>(std::move(socket), peer, context, entrance)->run(std::move(*place));
}

}  // namespace scancast
