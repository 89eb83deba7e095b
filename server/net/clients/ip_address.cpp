#include "server/net/clients/ip_address.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "protocol/nearest_name.hpp"

namespace scancast {
namespace {

constexpr std::array<std::uint8_t, 12> mappedV4{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};
constexpr unsigned mappedBits = 96;

IpAddress masked(IpAddress address, unsigned bits) {
    for (unsigned i = 0; i < address.bytes.size(); ++i) {
        const unsigned kept = std::clamp(int(bits) - int(8 * i), 0, 8);
        address.bytes[i] &= std::uint8_t(0xff00U >> kept);
    }
    return address;
}

}  // namespace

IpAddress IpAddress::ofV4(const std::array<std::uint8_t, 4>& bytes) {
    IpAddress address{true, {}};
    std::copy(bytes.begin(), bytes.end(), address.bytes.begin());
    return address;
}

IpAddress IpAddress::ofV6(const std::array<std::uint8_t, 16>& bytes) {
    if (std::equal(mappedV4.begin(), mappedV4.end(), bytes.begin()))
        return ofV4({bytes[12], bytes[13], bytes[14], bytes[15]});
    return {false, bytes};
}

std::optional<IpAddress> IpAddress::parse(std::string_view text) {
    constexpr std::size_t longest = INET6_ADDRSTRLEN;
    if (text.empty() || text.size() > longest || text.find('\0') != std::string_view::npos)
        return std::nullopt;
    const std::string copy(text);
    std::array<std::uint8_t, 4> four{};
    if (inet_pton(AF_INET, copy.c_str(), four.data()) == 1) return ofV4(four);
    std::array<std::uint8_t, 16> sixteen{};
    if (inet_pton(AF_INET6, copy.c_str(), sixteen.data()) == 1) return ofV6(sixteen);
    return std::nullopt;
}

std::string IpAddress::text() const {
    char buffer[INET6_ADDRSTRLEN] = "";
    inet_ntop(v4 ? AF_INET : AF_INET6, bytes.data(), buffer, sizeof buffer);
    return buffer;
}

std::string IpAddress::client() const {
    if (v4) return text();
    constexpr unsigned networkBits = 64;
    return masked(*this, networkBits).text() + "/64";
}

bool IpAddress::isLoopback() const {
    static constexpr std::array<std::uint8_t, 16> loopback6{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    return v4 ? bytes[0] == 127 : bytes == loopback6;
}

Expected<AddressRange> AddressRange::parse(std::string_view text) {
    const auto slash = text.find('/');
    const std::string_view written = text.substr(0, slash);
    const auto first = IpAddress::parse(written);
    if (!first) {
        return fail(ErrorCode::InvalidArgument,
                    quoteText(text) +
                        " is no range of addresses; it looks like 10.0.0.0/8, 192.168.1.7 or fd00::/8.");
    }
    unsigned most = first->v4 ? 32 : 128;
    if (slash == std::string_view::npos) return AddressRange(*first, most);
    const bool mapped = first->v4 && written.find(':') != std::string_view::npos;
    if (mapped) most = 128;
    const std::string_view digits = text.substr(slash + 1);
    unsigned bits = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), bits);
    if (error != std::errc() || end != digits.data() + digits.size() || bits > most ||
        (mapped && bits < mappedBits)) {
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("{} is no range of addresses: behind the slash stands how many bits they "
                                "have in common, {} to {}.",
                                quoteText(text), mapped ? mappedBits : 0, most));
    }
    if (mapped) bits -= mappedBits;
    if (const IpAddress start = masked(*first, bits); start != *first) {
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("{} has bits behind the {} that count: is {}/{} meant, or {} alone?",
                                quoteText(text), bits, start.text(), bits, first->text()));
    }
    return AddressRange(*first, bits);
}

bool AddressRange::contains(const IpAddress& address) const {
    return address.v4 == first_.v4 && masked(address, bits_) == first_;
}

}  // namespace scancast
