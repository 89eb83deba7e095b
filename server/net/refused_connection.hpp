// Tells somebody for whom there is no place why, and closes: a plain HTTP answer, before any request is read, without a
// place, a buffer or a handshake. Where TLS is spoken the handshake would be the cost, so there the connection just ends.
//
// Lives on the strand of its socket for two seconds at most, kept alive by its pending read. Pipeline: listener →
// **refused connection**.
#pragma once

#include <boost/asio/ip/tcp.hpp>

#include "server/net/net_context.hpp"

namespace scancast {

/// Takes over the socket, whose executor must be a strand, and tells the log who came. The context outlives it.
void refuseConnection(boost::asio::ip::tcp::socket socket, std::string client, ConnectionRefusal why,
                      NetContext& context, Entrance entrance);

/// The same in words, for somebody who has a connection already: 429 or 503, with Retry-After.
HttpResponse refusalResponse(ConnectionRefusal why, const ConnectionLimits& limits);

}  // namespace scancast
