#include "client/cpp/timed_io.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/error.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/websocket/error.hpp>

#include "files/input_file.hpp"

namespace scancast::client {
namespace {

namespace ssl = boost::asio::ssl;
using tcp = boost::asio::ip::tcp;
using Endpoints = std::vector<tcp::endpoint>;

Expected<Endpoints> resolveUntil(boost::asio::io_context& io, const ServerUrl& url,
                                 Clock::time_point deadline) {
    ErrorCodeOfBoost error;
    if (const auto address = boost::asio::ip::make_address(url.host, error); !error)
        return Endpoints{{address, url.port}};
    tcp::resolver resolver(io);
    Endpoints endpoints;
    error = runUntil(
        io, deadline,
        [&](auto handler) {
            resolver.async_resolve(
                url.host, std::to_string(url.port),
                [&endpoints, handler](ErrorCodeOfBoost e, const tcp::resolver::results_type& found) mutable {
                    for (const auto& entry : found) endpoints.push_back(entry.endpoint());
                    handler(e);
                });
        },
        [&] { resolver.cancel(); });
    if (error) return tl::unexpected(networkError(error, url, "looking up the host"));
    return endpoints;
}

Expected<void> connectTcp(boost::asio::io_context& io, boost::beast::tcp_stream& stream, const ServerUrl& url,
                          Clock::time_point deadline) {
    const auto endpoints = resolveUntil(io, url, deadline);
    if (!endpoints) return passOn(endpoints);
    auto& socket = stream.socket();
    const auto close = [&] {
        ErrorCodeOfBoost ignored;  // closing a socket that never opened cannot be wrong
        socket.close(ignored);
    };
    const auto error = runUntil(
        io, deadline, [&](auto handler) { boost::asio::async_connect(socket, *endpoints, handler); }, close);
    if (error) {
        close();
        return tl::unexpected(networkError(error, url, "connecting"));
    }
    ErrorCodeOfBoost ignored;  // only speed depends on it
    socket.set_option(tcp::no_delay(true), ignored);
    return {};
}

Expected<std::shared_ptr<ssl::context>> clientContext(const Credentials& credentials) {
    ErrorCodeOfBoost error;
    auto context = std::make_shared<ssl::context>(ssl::context::tls_client);
    SSL_CTX_set_min_proto_version(context->native_handle(), TLS1_2_VERSION);
    context->set_verify_mode(ssl::verify_peer, error);
    if (!error && credentials.authority.empty()) context->set_default_verify_paths(error);
    if (!error && !credentials.authority.empty()) {
        // Those of a whole system have less than one MiB.
        constexpr std::size_t longest = std::size_t(16) << 20;
        const auto text = readTextFile(credentials.authority, longest);
        if (!text) return passOn(text);
        context->add_certificate_authority(boost::asio::buffer(*text), error);
    }
    if (!error) return context;
    return fail(
        ErrorCode::Io,
        credentials.authority.empty()
            ? "the system's list of trusted authorities cannot be read: " + error.message()
            : credentials.authority.string() + " holds no certificates in PEM format: " + error.message());
}

Expected<void> agreeOnTls(boost::asio::io_context& io, NetStream& stream, const ServerUrl& url,
                          Clock::time_point deadline) {
    if (!stream.expectHost(url.host))
        return fail(ErrorCode::InvalidArgument, url.host + " cannot be the name in a certificate", "URL");
    const auto error = runUntil(
        io, deadline, [&](auto handler) { stream.handshake(NetStream::Side::Client, handler); },
        [&] { stream.tcp().close(); });
    if (!error) return {};
    if (error.category() != boost::asio::error::get_ssl_category() && error != ssl::error::stream_truncated)
        return tl::unexpected(networkError(error, url, "agreeing on TLS"));
    return fail(ErrorCode::Unsupported,
                url.authority() + " is not trusted, or does not speak TLS (" + error.message() +
                    "); --ca-file names another authority to trust, and http:// speaks in the clear");
}

}  // namespace

Expected<NetStream> connectUntil(boost::asio::io_context& io, const ServerUrl& url,
                                 const Credentials& credentials, Clock::time_point deadline) {
    boost::beast::tcp_stream connection(io);
    Expected<std::shared_ptr<ssl::context>> context = nullptr;
    if (url.tls) context = clientContext(credentials);
    if (!context) return passOn(std::move(context));
    if (auto ok = connectTcp(io, connection, url, deadline); !ok) return passOn(ok);
    if (!url.tls) return NetStream(std::move(connection));
    NetStream stream(std::move(connection), std::move(*context));
    if (auto ok = agreeOnTls(io, stream, url, deadline); !ok) return passOn(ok);
    return stream;
}

Error networkError(const ErrorCodeOfBoost& error, const ServerUrl& url, std::string_view doing) {
    namespace asio = boost::asio;
    namespace beast = boost::beast;
    const auto server = url.authority();
    const auto whileDoing = " while " + std::string(doing);
    if (error == asio::error::connection_refused)
        return {ErrorCode::Io, "nothing listens at " + server + ": start one with `scancast serve FILE`", {}};
    if (error == asio::error::host_not_found || error == asio::error::host_not_found_try_again ||
        error == asio::error::no_data)
        return {ErrorCode::NotFound, "there is no host named " + url.host, {}};
    if (error == asio::error::timed_out || error == beast::error::timeout)
        return {ErrorCode::DeadlineExceeded, server + " did not answer in time" + whileDoing, {}};
    if (error == asio::error::eof || error == asio::error::connection_reset ||
        error == asio::error::broken_pipe || error == asio::ssl::error::stream_truncated ||
        error == beast::http::error::end_of_stream || error == beast::http::error::partial_message)
        return {ErrorCode::Io, server + " closed the connection" + whileDoing, {}};
    if (error == beast::http::error::body_limit || error == beast::http::error::header_limit ||
        error == beast::websocket::error::message_too_big || error == beast::error::timeout)
        return {ErrorCode::ResourceLimit, server + " sent more than this client accepts" + whileDoing, {}};
    if (error.category() == beast::http::make_error_code(beast::http::error::bad_version).category())
        return {ErrorCode::Malformed,
                server + " does not speak HTTP (" + error.message() + "): is it a Scancast server?",
                {}};
    if (error.category() == beast::websocket::make_error_code(beast::websocket::error::closed).category())
        return {ErrorCode::Malformed,
                server + " broke the WebSocket protocol (" + error.message() + ")" + whileDoing,
                {}};
    return {ErrorCode::Io, server + ": " + error.message() + whileDoing, {}};
}

}  // namespace scancast::client
