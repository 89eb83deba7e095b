// What an HTTP client may write into a target or a header. Nothing may crash, and what is let in must be what
// the rules say: a Host that a loopback server answers to is a loopback name, however it is spelled.
#include <algorithm>

#include "server/net/api/http_message.hpp"
#include "server/net/api/negotiate.hpp"
#include "server/net/api/router.hpp"
#include "server/net/clients/trusted_proxies.hpp"
#include "server/net/listen_address.hpp"
#include "server/net/log/request_ids.hpp"
#include "server/net/log/shown_target.hpp"
#include "server/net/origin_check.hpp"
#include "server/net/page/error_page.hpp"
#include "server/net/page/page.hpp"
#include "tests/fuzz/require.hpp"

namespace {

bool isControl(char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
    return text;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const std::string text(reinterpret_cast<const char*>(data), size);

    if (const auto routed = route(text)) {
        require(text.size() <= maxTargetLength && routed->path.front() == '/');
        require(std::none_of(routed->path.begin(), routed->path.end(), isControl));
        require(std::none_of(routed->id.begin(), routed->id.end(), isControl));
    }

    const OriginRules rules{"127.0.0.1", {"https://viewer.example"}};
    if (checkHost({text}, rules)) {
        const std::string host = lower(text);
        const auto is = [&](const std::string& name) {
            if (host.rfind(name, 0) != 0) return false;
            const std::string rest = host.substr(name.size());
            return rest.empty() || rest[0] == ':' || rest == "." || rest.rfind(".:", 0) == 0;
        };
        require(is("localhost") || is("viewer.example") || host.rfind("127.", 0) == 0 ||
                host.rfind("[", 0) == 0);
    }
    // Same origin means the very same host and port, so another host must never pass for "localhost:8080".
    if (checkOrigin({text}, "localhost:8080", rules)) {
        const std::string origin = lower(text);
        require(origin.find("localhost") != std::string::npos ||
                origin.find("viewer.example") != std::string::npos);
        require(origin.rfind("http", 0) == 0 && origin.find('/', 8) == std::string::npos);
    }
    // Whatever a proxy passes on, somebody is counted: the proxy itself, or an address that stands in the text and is no
    // proxy's, unless all are. And whoever is no proxy is himself.
    static const std::vector<std::string> ranges{"10.0.0.0/8", "fd00::/8"};
    static const TrustedProxies proxies = *TrustedProxies::parse(ranges);
    const IpAddress peer = *IpAddress::parse("10.0.0.1"), other = *IpAddress::parse("192.0.2.7");
    for (const char* header : {"forwarded", "x-forwarded-for"}) {
        const HttpRequest request{"GET", "/", {{header, text}}};
        const CountedClient found = proxies.clientOf(request, peer);
        require(found.client == peer.client() || AddressRange::parse(found.client).has_value());
        require(proxies.clientOf(request, other) == CountedClient{other.client(), true});
        // A proxy that appends what it knows is believed, whatever its client had written before.
        const HttpRequest appended{"GET", "/", {{"x-forwarded-for", text + ", 203.0.113.9"}}};
        require(proxies.clientOf(appended, peer) == CountedClient{"203.0.113.9", true});
    }
    if (const auto range = AddressRange::parse(text))
        require(range->contains(*IpAddress::parse(text.substr(0, text.find('/')))));
    if (checkAllowedHost(text))
        require(checkHost({text.find(':') == std::string::npos || text[0] == '[' ? text : "[" + text + "]"},
                          {"127.0.0.1", {}, {text}})
                    .has_value());
    if (const auto address = parseListenAddress(text, "admin-listen"))
        require(parseListenAddress(address->text(), "admin-listen")->port == address->port);

    require(!matchesAny(text, "\"0123456789abcdef\"") || text.find("0123456789abcdef") != std::string::npos ||
            text.find('*') != std::string::npos);
    accepts(text, "image/jpeg");
    // Who names no HTML reads JSON; and nothing that anybody writes is markup in the page that he gets.
    require(!prefersPage(text) || lower(text).find("text/") != std::string::npos);
    require(htmlText(text).find_first_of("<>\"'") == std::string::npos);
    if (preferredCoding(text) != ContentCoding::Identity)
        require(lower(text).find("gzip") != std::string::npos ||
                lower(text).find("br") != std::string::npos || text.find('*') != std::string::npos);
    if (const auto file = findAsset(text)) require(file->file != nullptr && text.front() == '/');
    // Ids and what is shown of a target go into a line of the log, and ids into a header, too: none begins another
    // line, and no session's key and no word that nobody knows gets there.
    const RequestIds ids = RequestIds::of(text, text);
    require(isRequestId(ids.request) && (!isRequestId(text) || ids.request == text));
    if (ids.trace) {
        require(text.substr(0, 2) != "ff" && text.substr(3, 32) == ids.trace->trace &&
                text.substr(36, 16) == ids.trace->parent);
        require(ids.trace->trace.find_first_not_of("0123456789abcdef") == std::string::npos);
    }
    const std::string shown = shownTarget(text), hidden = shownTarget("/a?token=" + text);
    require(shown.size() <= 720 && std::none_of(shown.begin(), shown.end(), isControl));
    require(hidden.starts_with("/a?token=*") &&
            (text.find('&') != std::string::npos || hidden == "/a?token=*"));
    // One spelling of one coding frames a body; whatever else it is, it is refused.
    const HttpRequest coded{"POST", "/", {{"transfer-encoding", text}}};
    require(framingFault(coded, 11).empty() == (lower(text) == "chunked"));
    require(!framingFault(coded, 10).empty());
    return 0;
}
