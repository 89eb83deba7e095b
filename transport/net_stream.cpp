#include "transport/net_stream.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <variant>

namespace scancast {

namespace asio = boost::asio;
namespace beast = boost::beast;

struct NetStream::Below {
    using Tls = beast::ssl_stream<beast::tcp_stream>;
    explicit Below(beast::tcp_stream tcp) : stream(std::move(tcp)) {}
    Below(beast::tcp_stream tcp, std::shared_ptr<asio::ssl::context> by)
        : context(std::move(by)), stream(std::in_place_type<Tls>, std::move(tcp), *context) {}
    Tls* tls() { return std::get_if<Tls>(&stream); }

    std::shared_ptr<asio::ssl::context> context;  // before the stream, which refers to it
    std::variant<beast::tcp_stream, Tls> stream;
};

NetStream::NetStream(beast::tcp_stream stream) : below_(std::make_unique<Below>(std::move(stream))) {}
NetStream::NetStream(beast::tcp_stream stream, std::shared_ptr<asio::ssl::context> context)
    : below_(std::make_unique<Below>(std::move(stream), std::move(context))) {}
NetStream::NetStream(NetStream&&) noexcept = default;
NetStream& NetStream::operator=(NetStream&&) noexcept = default;
NetStream::~NetStream() = default;

beast::tcp_stream& NetStream::tcp() {
    return std::visit([](auto& stream) -> beast::tcp_stream& { return beast::get_lowest_layer(stream); },
                      below_->stream);
}

void NetStream::read(const List<asio::mutable_buffer>& buffers, IoHandler handler) {
    std::visit([&](auto& stream) { stream.async_read_some(buffers, std::move(handler)); }, below_->stream);
}

void NetStream::write(const List<asio::const_buffer>& buffers, IoHandler handler) {
    std::visit([&](auto& stream) { stream.async_write_some(buffers, std::move(handler)); }, below_->stream);
}

void NetStream::handshake(Side side, std::function<void(ErrorCode)> handler) {
    if (auto* tls = below_->tls()) {
        return tls->async_handshake(
            side == Side::Server ? asio::ssl::stream_base::server : asio::ssl::stream_base::client,
            std::move(handler));
    }
    asio::post(get_executor(), [handler = std::move(handler)] { handler(ErrorCode()); });
}

void NetStream::goodbye(std::function<void(ErrorCode)> handler) {
    if (auto* tls = below_->tls()) return tls->async_shutdown(std::move(handler));
    asio::post(get_executor(), [handler = std::move(handler)] { handler(ErrorCode()); });
}

bool NetStream::expectHost(const std::string& host) {
    auto* tls = below_->tls();
    if (tls == nullptr) return true;
    ErrorCode error;
    tls->set_verify_callback(asio::ssl::host_name_verification(host), error);
    // A name tells a server with many of them which certificate is meant; addresses do not go there (RFC
    // 6066, 3).
    ErrorCode notAnAddress;
    asio::ip::make_address(host, notAnAddress);
    const bool named = !notAnAddress || SSL_set_tlsext_host_name(tls->native_handle(), host.c_str()) == 1;
    return !error && named;
}

void NetStream::tearDown(beast::role_type role, ErrorCode& error) {
    using beast::websocket::teardown;
    std::visit([&](auto& stream) { teardown(role, stream, error); }, below_->stream);
}

void NetStream::asyncTearDown(beast::role_type role, IoHandler handler) {
    using beast::websocket::async_teardown;
    auto done = [handler = std::move(handler)](ErrorCode error) mutable { handler(error, 0); };
    std::visit([&](auto& stream) { async_teardown(role, stream, std::move(done)); }, below_->stream);
}

}  // namespace scancast
