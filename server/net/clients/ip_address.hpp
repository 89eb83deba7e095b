// Addresses and ranges of them (CIDR): who has connected, and whom the server was told to trust.
//
// Plain values and pure functions; any thread. Pipeline: socket → **address** → forwarded, connection register.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/error.hpp"

namespace scancast {

struct IpAddress {
    bool v4 = false;
    std::array<std::uint8_t, 16> bytes{};  ///< of version 4 the first four

    static IpAddress ofV4(const std::array<std::uint8_t, 4>& bytes);
    /// An address of version 4 that is written as one of version 6 (::ffff:1.2.3.4) is the former.
    static IpAddress ofV6(const std::array<std::uint8_t, 16>& bytes);
    /// As it is written, without port, brackets or zone.
    static std::optional<IpAddress> parse(std::string_view text);

    std::string text() const;
    /// Whom work is counted for: an address, and of those of version 6 the network, of which a client has as many as it
    /// likes ("2001:db8::/64").
    std::string client() const;
    bool isLoopback() const;
    bool operator==(const IpAddress&) const = default;
};

/// Addresses that begin with the same bits.
class AddressRange {
  public:
    /// "10.0.0.0/8", "fd00::/8", or one address. InvalidArgument for what is neither, and for bits behind the prefix:
    /// 10.1.0.0/8 may be meant to be 10.0.0.0/8 or 10.1.0.0/16, and trust is not guessed.
    static Expected<AddressRange> parse(std::string_view text);
    bool contains(const IpAddress& address) const;

  private:
    AddressRange(const IpAddress& first, unsigned bits) : first_(first), bits_(bits) {}

    IpAddress first_;
    unsigned bits_;
};

}  // namespace scancast
