// Who may talk to this server from a browser. A website must not be able to drive a server on somebody's
// loopback: neither directly (Origin) nor by a name of its own that it points at 127.0.0.1 (DNS rebinding,
// Host).
//
// Pure functions of header values; any thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

struct OriginRules {
    std::string bindHost = "127.0.0.1";  ///< as given by --host
    std::vector<std::string>
        allowedOrigins;  ///< "https://viewer.example.org"; their hosts are allowed as Host too
    std::vector<std::string> allowedHosts{};  ///< "scans.example.org": further names of this server
};

/// Host: required, once. Allowed are the bind address, the loopback names, allowed hosts and those of allowed origins, and,
/// when the server listens on other addresses, any IP address - rebinding needs a *name*. The port may be
/// any: it is another one behind a forwarded port, and no page can choose it against the browser's will.
Expected<void> checkHost(const std::vector<std::string>& hostHeaders, const OriginRules& rules);

/// Origin: absent (no browser, or a same-origin GET), the same host and port as Host, or allowed by name.
/// "null" is refused.
Expected<void> checkOrigin(const std::vector<std::string>& originHeaders, std::string_view host,
                           const OriginRules& rules);

/// Whether `origin` is one of the allowed ones, so that the answer may say so (Access-Control-Allow-Origin).
bool isAllowedOrigin(std::string_view origin, const OriginRules& rules);

/// Who may show the page in a frame, as `frame-ancestors` of a Content-Security-Policy lists them: pages of the server
/// itself and of allowed origins. Those whose host is an address of version 6 are left out: a policy cannot name them.
std::string frameAncestors(const OriginRules& rules);

/// For the command line: InvalidArgument unless it is SCHEME://HOST[:PORT] with http or https.
Expected<void> checkAllowedOrigin(std::string_view origin);
/// The same of a name of this server: one name or address, without scheme or port; no pattern.
Expected<void> checkAllowedHost(std::string_view host);

}  // namespace scancast
