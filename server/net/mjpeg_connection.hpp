// One stream of pictures over plain HTTP (multipart/x-mixed-replace): what `curl` and an <img> understand.
// Its session is that of a WebSocket, greeted on the client's behalf; POST /sessions/{id}/view drives it.
//
// A frame counts as acknowledged when it has been written, and only then the next one is drawn: a slow reader
// gets fewer pictures, never old ones. Lives on the strand of its socket, kept alive by its pending read.
// Pipeline: http connection → **mjpeg connection** → session, scheduler.
#pragma once

#include "server/net/net_context.hpp"
#include "transport/net_stream.hpp"

namespace scancast {

/// Answers an admitted GET, with a stream or a problem; the connection ends with the answer.
void startMjpeg(NetStream stream, HttpRequest request, Routed routed, NetContext& context,
                ConnectionRegister::Place place, RequestRecord record);

}  // namespace scancast
