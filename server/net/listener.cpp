#include <utility>  // before Asio: Boost 1.74 forgets it

#include "server/net/listener.hpp"

#include <fmt/format.h>

#include <boost/asio/post.hpp>
#include <boost/asio/strand.hpp>
#include <thread>
#include <tuple>

#include "server/net/api/handler.hpp"
#include "server/net/http_connection.hpp"

namespace scancast {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

constexpr std::chrono::milliseconds pauseTime{100};

}  // namespace

Expected<asio::ip::tcp::acceptor> listenAt(const asio::any_io_executor& executor,
                                           const ListenAddress& address, Entrance entrance) {
    const bool isPublic = entrance == Entrance::Public;
    error_code ec;
    asio::ip::tcp::resolver resolver(executor);
    const auto found =
        resolver.resolve(address.host, std::to_string(address.port), asio::ip::tcp::resolver::passive, ec);
    if (ec || found.empty()) {
        const std::string flag = isPublic ? "host" : "admin-listen";
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("--{} {}: there is no such address here ({}).", flag,
                                isPublic ? address.host : address.text(), ec.message()),
                    flag);
    }
    const asio::ip::tcp::endpoint endpoint = *found.begin();
    asio::ip::tcp::acceptor acceptor(executor);
    acceptor.open(endpoint.protocol(), ec);
    if (!ec) acceptor.set_option(asio::socket_base::reuse_address(true), ec);
    if (!ec) acceptor.bind(endpoint, ec);
    if (!ec) acceptor.listen(asio::socket_base::max_listen_connections, ec);
    if (!ec) return acceptor;
    return fail(ErrorCode::Io,
                fmt::format("{} {} port {}: {}. Another port may be free: {} 0 takes any that is.",
                            isPublic ? "Cannot listen on" : "--admin-listen: cannot listen on", address.host,
                            address.port, ec.message(), isPublic ? "--port" : "port"));
}

Listener::Listener(asio::io_context& io, NetContext& context, Entrance entrance,
                   asio::ip::tcp::acceptor acceptor)
    : io_(io),
      context_(context),
      entrance_(entrance),
      acceptor_(std::move(acceptor)),
      pause_(acceptor_.get_executor()) {}

Expected<std::shared_ptr<Listener>> Listener::create(asio::io_context& io, const ListenAddress& address,
                                                     NetContext& context, Entrance entrance) {
    auto acceptor = listenAt(asio::make_strand(io), address, entrance);
    if (!acceptor) return passOn(std::move(acceptor));
    const std::shared_ptr<Listener> listener(new Listener(io, context, entrance, std::move(*acceptor)));
    error_code ec;
    listener->port_ = listener->acceptor_.local_endpoint(ec).port();
    if (ec) return fail(ErrorCode::Io, "The system does not say which port this server has: " + ec.message());
    return listener;
}

void Listener::run() {
    asio::post(acceptor_.get_executor(), [self = shared_from_this()] { self->accept(); });
}

void Listener::close() {
    asio::post(acceptor_.get_executor(), [self = shared_from_this()] {
        error_code ignored;
        self->acceptor_.close(ignored);
        self->pause_.cancel();
    });
}

// Whatever becomes of one connection, somebody goes on accepting: without memory even for that, this thread
// waits until there is some.
void Listener::accept() noexcept {
    if (std::exchange(beginning_, true)) return;  // called by the handler of an attempt that failed, below
    while (acceptor_.is_open() && !contained("The listener", [this] { acceptNext(); }))
        std::this_thread::sleep_for(pauseTime);
    beginning_ = false;
}

void Listener::acceptNext() {
    acceptor_.async_accept(asio::make_strand(io_),
                           Handler(shared_from_this(), [](Listener& self, error_code ec, auto socket) {
                               if (!self.acceptor_.is_open()) return;
                               if (ec) return self.pause();
                               std::ignore = contained("The listener", [&] {
                                   error_code ignored;
                                   socket.set_option(asio::ip::tcp::no_delay(true), ignored);
                                   startHttp(std::move(socket), self.context_, self.entrance_);
                               });
                               self.accept();
                           }));
}

// Out of file descriptors, most likely: whoever is idle gives his back, and a pause instead of a spin.
void Listener::pause() {
    std::ignore = contained("The listener", [this] {
        context_.connections.makeRoom();
        Handler goOn(shared_from_this(), [](Listener& self, error_code) { self.accept(); });
        pause_.expires_after(pauseTime);
        pause_.async_wait(std::move(goOn));
    });
}

void Listener::fault() noexcept {
    if (!context_.connections.shuttingDown()) accept();
}

}  // namespace scancast
