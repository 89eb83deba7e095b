// One WebSocket: carries a stream session's messages and frames, keeps its time, and connects it with the
// scheduler.
//
// Lives on the strand of its socket, kept alive by its own pending read. Writes one message at a time from a
// bounded queue. Pipeline: http connection → **stream connection** → session, scheduler.
#pragma once

#include <utility>  // before Beast: Boost 1.74 forgets it

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

#include "server/net/net_context.hpp"
#include "transport/net_stream.hpp"

namespace scancast {

/// Accepts the upgrade that `request` asks for (Host, Origin and token are checked already).
void startStream(NetStream stream, boost::beast::http::request<boost::beast::http::empty_body> request,
                 NetContext& context, ConnectionRegister::Place place, Grant grant, RequestRecord record);

}  // namespace scancast
