// Files that are built in, as answers: in the encoding that a client likes best, with a tag for each, and for how long they
// may be kept.
//
// Pure functions; any thread. Pipeline: api → **file answer** → http connection.
#pragma once

#include "server/net/api/http_message.hpp"
#include "server/net/page/page.hpp"

namespace scancast {

/// 200, or 304 where the client has these bytes. `no-cache`, or, of what is there for ever, a year without asking again.
HttpResponse fileAnswer(const HttpRequest& request, const ServedAsset& asset);

}  // namespace scancast
