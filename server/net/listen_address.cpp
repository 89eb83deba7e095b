#include "server/net/listen_address.hpp"

#include <fmt/format.h>

#include <charconv>

#include "protocol/nearest_name.hpp"
#include "server/net/clients/ip_address.hpp"

namespace scancast {
namespace {

bool isNameOrV4(std::string_view host) {
    constexpr std::size_t longestName = 253;
    return !host.empty() && host.size() <= longestName &&
           host.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_") ==
               std::string_view::npos;
}

}  // namespace

std::string ListenAddress::text() const {
    const bool v6 = host.find(':') != std::string::npos;
    return fmt::format("{}:{}", v6 ? "[" + host + "]" : host, port);
}

Expected<ListenAddress> parseListenAddress(std::string_view text, std::string_view flag) {
    const auto refuse = [&](std::string_view why) {
        return fail(ErrorCode::InvalidArgument, fmt::format("--{} {}: {}", flag, quoteText(text), why),
                    std::string(flag));
    };
    constexpr std::string_view form = "expected HOST:PORT, such as 127.0.0.1:9090 or [::1]:9090.";
    if (const auto bare = IpAddress::parse(text); bare && !bare->v4)
        return refuse("an address of version 6 stands in brackets, and a port behind them: [::1]:9090.");
    const auto colon = text.rfind(':');
    if (colon == std::string_view::npos || colon == 0) return refuse(form);
    std::string_view host = text.substr(0, colon);
    if (host.front() == '[') {
        if (host.back() != ']') return refuse(form);
        host = host.substr(1, host.size() - 2);
        const auto address = IpAddress::parse(host);
        if (!address || host.find(':') == std::string_view::npos)
            return refuse("in the brackets stands an address of version 6: [::1]:9090.");
    } else if (!isNameOrV4(host)) {
        return refuse(form);
    }
    const std::string_view digits = text.substr(colon + 1);
    std::uint16_t port = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
    if (error != std::errc() || end != digits.data() + digits.size())
        return refuse("the port is a number from 0 to 65535; 0 takes any that is free.");
    return ListenAddress{std::string(host), port};
}

}  // namespace scancast
