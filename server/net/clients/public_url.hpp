// Where a server is for whoever asks, as answers have it that must name whole addresses (capabilities of maps). A pure function of
// header values, outside bytes; any thread. Pipeline: http connection → **public URL** → server/net/maps.
#pragma once

#include <string>

#include "server/net/api/http_message.hpp"

namespace scancast {

/// "https://scans.example.org/town", without a slash at its end: by the Host header (which checkHost() judges), and TLS. Of a proxy that is
/// `trusted`, by its X-Forwarded-Proto and X-Forwarded-Prefix, too, where they are a scheme and a path.
std::string publicUrl(const HttpRequest& request, bool encrypted, bool trusted);

}  // namespace scancast
