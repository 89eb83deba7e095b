// Accepts connections and hands each to its own strand. Pipeline: **listener** → http connection.
//
// Owned by the server. *Thread safety*: close() may be called from any thread; everything else happens on the
// listener's own strand.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <string>

#include "server/net/listen_address.hpp"
#include "server/net/net_context.hpp"

namespace scancast {

/// Bound and listening, and accepting nothing yet. Errors: InvalidArgument, Io; both name the entrance's flag and say what
/// to do.
Expected<boost::asio::ip::tcp::acceptor> listenAt(const boost::asio::any_io_executor& executor,
                                                  const ListenAddress& address, Entrance entrance);

class Listener : public std::enable_shared_from_this<Listener> {
  public:
    /// Listens, but accepts nothing before run(). Errors: those of listenAt().
    static Expected<std::shared_ptr<Listener>> create(boost::asio::io_context& io,
                                                      const ListenAddress& address, NetContext& context,
                                                      Entrance entrance);
    void run();
    void close();
    std::uint16_t port() const { return port_; }
    /// Accepting failed in between (handler.hpp): it goes on.
    void fault() noexcept;

  private:
    Listener(boost::asio::io_context& io, NetContext& context, Entrance entrance,
             boost::asio::ip::tcp::acceptor acceptor);
    void accept() noexcept;
    void acceptNext();
    void pause();

    boost::asio::io_context& io_;
    NetContext& context_;
    const Entrance entrance_;
    boost::asio::ip::tcp::acceptor acceptor_;
    boost::asio::steady_timer pause_;
    bool beginning_ = false;  // to accept
    std::uint16_t port_ = 0;
};

}  // namespace scancast
