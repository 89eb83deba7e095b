// One TCP connection that speaks HTTP/1.1: reads a request's head within limits, has the API answer it,
// writes, and goes on to the next; hands itself over to a stream connection when the client upgrades.
//
// Lives on the strand of its socket, kept alive by its own pending operation. Pipeline: listener → **http
// connection** → api, stream connection.
#pragma once

#include <boost/asio/ip/tcp.hpp>

#include "server/net/net_context.hpp"

namespace scancast {

/// Takes over the socket, whose executor must be a strand, or refuses it where there is no place. The context outlives
/// the connection.
void startHttp(boost::asio::ip::tcp::socket socket, NetContext& context, Entrance entrance);

}  // namespace scancast
