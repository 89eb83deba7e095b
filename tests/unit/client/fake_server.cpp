#include "tests/unit/client/fake_server.hpp"

#include <utility>  // first: Asio 1.74 forgets it under C++20

#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <mutex>
#include <sstream>
#include <thread>

namespace scancast::client::test {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = boost::asio::ip::tcp;
using Code = boost::system::error_code;

class Peer : public FakePeer {
  public:
    explicit Peer(websocket::stream<tcp::socket>& socket) : socket_(socket) {}
    bool readText(std::string& text) override {
        beast::flat_buffer buffer;
        Code error;
        socket_.read(buffer, error);
        text = beast::buffers_to_string(buffer.data());
        return !error;
    }
    bool sendText(const std::string& text) override {
        socket_.text(true);
        Code error;
        socket_.write(boost::asio::buffer(text), error);
        return !error;
    }
    bool sendBinary(const Bytes& bytes) override {
        socket_.binary(true);
        Code error;
        socket_.write(boost::asio::buffer(bytes), error);
        return !error;
    }
    void close(std::uint16_t code, const std::string& reason) override {
        Code ignored;
        socket_.close(websocket::close_reason(static_cast<websocket::close_code>(code), reason), ignored);
    }
    void ping() override {
        Code ignored;
        socket_.ping({}, ignored);
    }
    std::uint16_t closeCode() const override { return socket_.reason().code; }

  private:
    websocket::stream<tcp::socket>& socket_;
};

/// So that a client that hangs cannot hang the test.
void limitWaiting(tcp::socket& socket) {
    const timeval limit{20, 0};
    setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    setsockopt(socket.native_handle(), SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
}

}  // namespace

class FakeServer::Impl {
  public:
    explicit Impl(Script script)
        : script_(std::move(script)),
          acceptor_(io_, tcp::endpoint(boost::asio::ip::address_v4::loopback(), 0)),
          thread_([this] { run(); }) {}

    ~Impl() {
        stopped_ = true;
        thread_.join();
    }

    std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

    std::vector<std::string> requests() const {
        const std::lock_guard lock(mutex_);
        return requests_;
    }

  private:
    void run() {
        while (!stopped_) {
            pollfd waiting{acceptor_.native_handle(), POLLIN, 0};
            if (poll(&waiting, 1, 20) <= 0) continue;
            Code error;
            tcp::socket socket(io_);
            acceptor_.accept(socket, error);
            if (error) continue;
            limitWaiting(socket);
            if (script_.atOnce)
                served_.emplace_back([this, one = std::move(socket)]() mutable { serve(std::move(one)); });
            else
                serve(std::move(socket));
        }
        for (std::thread& one : served_) one.join();
    }

    void serve(tcp::socket socket) {
        Code ignored;
        if (script_.silent) {
            // Until the client gives up: reading ends when it closes.
            char byte[4096];
            Code error;
            while (!error) socket.read_some(boost::asio::buffer(byte), error);
            return;
        }
        beast::flat_buffer buffer;
        http::request<http::string_body> request;
        Code error;
        http::read(socket, buffer, request, error);
        if (error) return;
        remember(request);
        if (!script_.raw.empty()) {
            boost::asio::write(socket, boost::asio::buffer(script_.raw), ignored);
            socket.shutdown(tcp::socket::shutdown_both, ignored);
        } else if (script_.session && websocket::is_upgrade(request)) {
            upgrade(std::move(socket), request);
        } else {
            answer(socket, request);
        }
    }

    void upgrade(tcp::socket socket, const http::request<http::string_body>& request) {
        websocket::stream<tcp::socket> stream(std::move(socket));
        stream.set_option(websocket::stream_base::decorator([this](websocket::response_type& response) {
            if (!script_.subprotocol.empty())
                response.set(http::field::sec_websocket_protocol, script_.subprotocol);
        }));
        Code error;
        stream.accept(request, error);
        if (error) return;
        Peer peer(stream);
        script_.session(peer);
    }

    void answer(tcp::socket& socket, const http::request<http::string_body>& request) {
        const std::string target(request.target());
        const auto found = script_.answers.find(target.substr(0, target.find('?')));
        const auto said =
            found == script_.answers.end() ? FakeAnswer{404, "text/plain", "no", ""} : found->second;
        http::response<http::string_body> response(static_cast<http::status>(said.status), 11);
        response.set(http::field::content_type, said.contentType);
        if (!said.etag.empty()) {
            response.set(http::field::etag, said.etag);
            if (request[http::field::if_none_match] == said.etag) response.result(http::status::not_modified);
        }
        if (response.result() != http::status::not_modified) response.body() = said.body;
        response.prepare_payload();
        Code ignored;
        http::write(socket, response, ignored);
        socket.shutdown(tcp::socket::shutdown_send, ignored);
    }

    void remember(const http::request<http::string_body>& request) {
        std::ostringstream text;
        text << request.base();
        const std::lock_guard lock(mutex_);
        requests_.push_back(text.str());
    }

    Script script_;
    boost::asio::io_context io_;
    tcp::acceptor acceptor_;
    mutable std::mutex mutex_;
    std::vector<std::string> requests_;
    std::atomic<bool> stopped_ = false;
    std::vector<std::thread> served_;  // the thread's own
    std::thread thread_;
};

FakeServer::FakeServer(Script script) : impl_(std::make_unique<Impl>(std::move(script))) {}
FakeServer::~FakeServer() = default;

ServerUrl FakeServer::url() const {
    return {"127.0.0.1", impl_->port()};
}
std::vector<std::string> FakeServer::requests() const {
    return impl_->requests();
}

ServerUrl nobodysUrl() {
    // Bound and let go again: the kernel hands such a port out to nobody else for a while.
    boost::asio::io_context io;
    const tcp::acceptor acceptor(io, tcp::endpoint(boost::asio::ip::address_v4::loopback(), 0));
    return {"127.0.0.1", acceptor.local_endpoint().port()};
}

}  // namespace scancast::client::test
