// What a request for an MJPEG stream asks for: the snapshot's words, and fps and session. Pure functions; any
// thread. Pipeline: router → **mjpeg request** → mjpeg connection.
#pragma once

#include <optional>

#include "protocol/messages.hpp"
#include "server/catalog/visible_clouds.hpp"
#include "server/net/api/http_message.hpp"
#include "server/net/api/router.hpp"

namespace scancast {

inline constexpr std::string_view mjpegMediaType = "multipart/x-mixed-replace; boundary=scancast";

/// As a WebSocket's client would say it.
struct MjpegRequest {
    messages::Hello hello;
    std::optional<messages::ViewChange> view;  ///< empty for one that follows a session
    std::string method, reason;  ///< that draws it at first, and why; empty for one that follows
};

/// Says by which method the stream begins, where that is known.
void sayMethod(HttpResponse& response, const MjpegRequest& asked);

/// Problems: 406; 404 and 503 of the catalog; those of viewOfWords(); 400 for words beside `session` but
/// width, height and fps.
tl::expected<MjpegRequest, Problem> mjpegRequest(const HttpRequest& request, const Routed& routed,
                                                 const VisibleClouds& clouds, std::uint64_t maxPixels);

}  // namespace scancast
