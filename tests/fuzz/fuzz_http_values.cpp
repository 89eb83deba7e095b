// What an HTTP client may write into a target or a header. Nothing may crash, and what is let in must be what
// the rules say: a Host that a loopback server answers to is a loopback name, however it is spelled.
#include <algorithm>
#include <cstdlib>

#include "server/net/api/http_message.hpp"
#include "server/net/api/negotiate.hpp"
#include "server/net/api/router.hpp"
#include "server/net/origin_check.hpp"

namespace {

void require(bool condition) {
    if (!condition) std::abort();
}

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
    require(!matchesAny(text, "\"0123456789abcdef\"") || text.find("0123456789abcdef") != std::string::npos ||
            text.find('*') != std::string::npos);
    accepts(text, "image/jpeg");
    // One spelling of one coding frames a body; whatever else it is, it is refused.
    const HttpRequest coded{"POST", "/", {{"transfer-encoding", text}}};
    require(framingFault(coded, 11).empty() == (lower(text) == "chunked"));
    require(!framingFault(coded, 10).empty());
    return 0;
}
