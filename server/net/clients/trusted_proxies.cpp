#include "server/net/clients/trusted_proxies.hpp"

#include <algorithm>
#include <optional>

namespace scancast {
namespace {

std::string_view trimmed(std::string_view text) {
    const auto blank = [](char c) { return c == ' ' || c == '\t'; };
    while (!text.empty() && blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && blank(text.back())) text.remove_suffix(1);
    return text;
}

bool isDigit(char c) {
    return c >= '0' && c <= '9';
}

bool isLetter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// RFC 9110, 5.6.2.
bool isTokenCharacter(char c) {
    return isDigit(c) || isLetter(c) || std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}

/// RFC 7239, 6.3: what stands for an address or a port that is not told.
bool isInvented(std::string_view name) {
    return name.size() > 1 && name.front() == '_' && std::all_of(name.begin() + 1, name.end(), [](char c) {
               return isDigit(c) || isLetter(c) || c == '.' || c == '_' || c == '-';
           });
}

bool isNodePort(std::string_view text) {
    return isInvented(text) ||
           (!text.empty() && text.size() <= 5 && std::all_of(text.begin(), text.end(), isDigit));
}

/// One node on the way of a request.
struct Hop {
    enum class Kind : std::uint8_t { Address, Hidden, Malformed } kind = Kind::Malformed;
    IpAddress address{};
};

/// An address with or without port, [version 6] with or without port, version 6 bare, `unknown` or an invented name.
Hop hopOf(std::string_view node) {
    if (const auto bare = IpAddress::parse(node)) return {Hop::Kind::Address, *bare};
    std::string_view name = node, port;
    if (!node.empty() && node.front() == '[') {
        const auto close = node.find(']');
        if (close == std::string_view::npos) return {};
        name = node.substr(1, close - 1);
        port = node.substr(close + 1);
        if (name.find(':') == std::string_view::npos) return {};
    } else if (const auto colon = node.find(':'); colon != std::string_view::npos) {
        name = node.substr(0, colon);
        port = node.substr(colon);
    }
    if (!port.empty() && (port.front() != ':' || !isNodePort(port.substr(1)))) return {};
    if (const auto address = IpAddress::parse(name)) return {Hop::Kind::Address, *address};
    if (lowerCase(name) == "unknown" || isInvented(name)) return {Hop::Kind::Hidden, {}};
    return {};
}

/// The hops of one line of X-Forwarded-For, as far as they go: the commas are all that is sure of it.
std::vector<Hop> hopsOfList(std::string_view line) {
    std::vector<Hop> hops;
    while (true) {
        const auto comma = line.find(',');
        hops.push_back(hopOf(trimmed(line.substr(0, comma))));
        if (comma == std::string_view::npos) return hops;
        line.remove_prefix(comma + 1);
    }
}

/// Reads RFC 7239, section 4, from front to back.
class ForwardedReader {
  public:
    explicit ForwardedReader(std::string_view line) : rest_(line) {}

    /// Of one line; a line that does not follow the grammar is one malformed hop, because a quote that a client opened
    /// may have swallowed what a proxy wrote.
    std::vector<Hop> hops() {
        std::vector<Hop> hops;
        do {
            const auto hop = element();
            if (!hop) return {Hop{}};
            hops.push_back(*hop);
        } while (take(','));
        return rest_.empty() ? hops : std::vector<Hop>{Hop{}};
    }

  private:
    void skipBlanks() { rest_ = trimmed(rest_); }
    bool take(char c) {
        skipBlanks();
        if (rest_.empty() || rest_.front() != c) return false;
        rest_.remove_prefix(1);
        skipBlanks();
        return true;
    }

    std::optional<Hop> element() {
        std::optional<Hop> hop;
        do {
            const std::string name = lowerCase(token());
            if (name.empty() || !take('=')) return std::nullopt;
            const auto text = value();
            if (!text) return std::nullopt;
            if (name != "for") continue;
            if (hop) return std::nullopt;  // RFC 7239, 4: once in each element
            hop = hopOf(*text);
        } while (take(';'));
        return hop ? hop : Hop{Hop::Kind::Hidden, {}};
    }

    std::string_view token() {
        skipBlanks();
        std::size_t length = 0;
        while (length < rest_.size() && isTokenCharacter(rest_[length])) ++length;
        const std::string_view found = rest_.substr(0, length);
        rest_.remove_prefix(length);
        return found;
    }

    std::optional<std::string> value() {
        if (rest_.empty() || rest_.front() != '"') {
            // Addresses of version 4 with a port should be quoted, and often are not.
            std::size_t length = 0;
            while (length < rest_.size() && (isTokenCharacter(rest_[length]) || rest_[length] == ':'))
                ++length;
            std::string text(rest_.substr(0, length));
            rest_.remove_prefix(length);
            return text.empty() ? std::nullopt : std::optional(std::move(text));
        }
        std::string text;
        for (std::size_t i = 1; i < rest_.size(); ++i) {
            if (rest_[i] == '"') {
                rest_.remove_prefix(i + 1);
                return text;
            }
            if (rest_[i] == '\\' && ++i == rest_.size()) break;
            text += rest_[i];
        }
        return std::nullopt;
    }

    std::string_view rest_;
};

/// What one of the two headers says; nothing where it is not there.
template <class HopsOf>
std::optional<Hop> originOf(const HttpRequest& request, std::string_view header,
                            const TrustedProxies& proxies, HopsOf hopsOf) {
    std::optional<Hop> last;
    // Each proxy adds a line, or to the last one: what is furthest to the right was written by the peer.
    for (auto field = request.headers.rbegin(); field != request.headers.rend(); ++field) {
        if (field->first != header) continue;
        const std::vector<Hop> hops = hopsOf(field->second);
        for (auto hop = hops.rbegin(); hop != hops.rend(); ++hop) {
            last = *hop;
            if (hop->kind != Hop::Kind::Address || !proxies.trusts(hop->address)) return last;
        }
    }
    return last;
}

}  // namespace

Expected<TrustedProxies> TrustedProxies::parse(std::span<const std::string> ranges) {
    TrustedProxies proxies;
    for (const std::string& text : ranges) {
        auto range = AddressRange::parse(text);
        if (!range) {
            return fail(ErrorCode::InvalidArgument, "--trusted-proxy: " + range.error().message,
                        "trusted-proxy");
        }
        proxies.ranges_.push_back(*range);
    }
    return proxies;
}

bool TrustedProxies::trusts(const IpAddress& address) const {
    return std::ranges::any_of(ranges_, [&](const AddressRange& range) { return range.contains(address); });
}

CountedClient TrustedProxies::clientOf(const HttpRequest& request, const IpAddress& peer) const {
    if (!trusts(peer)) return {peer.client(), true};
    const auto standard = originOf(request, "forwarded", *this,
                                   [](std::string_view line) { return ForwardedReader(line).hops(); });
    const auto usual = originOf(request, "x-forwarded-for", *this, hopsOfList);
    if (!standard && !usual) return {peer.client(), false};
    const Hop& said = standard ? *standard : *usual;
    if (standard && usual && (standard->kind != usual->kind || standard->address != usual->address))
        return {peer.client(), true};
    switch (said.kind) {
        case Hop::Kind::Address:
            return {said.address.client(), true};
        case Hop::Kind::Hidden:
            return {peer.client(), false};
        case Hop::Kind::Malformed:
            break;
    }
    return {peer.client(), true};
}

}  // namespace scancast
