#include "transport/bytes_taken.hpp"

#include <linux/sockios.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <cstddef>

namespace scancast {

std::optional<BytesTaken> bytesTaken(int socket) {
    tcp_info info{};
    socklen_t length = sizeof info;
    constexpr std::size_t needed = offsetof(tcp_info, tcpi_bytes_acked) + sizeof info.tcpi_bytes_acked;
    if (::getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &length) != 0 || length < needed)
        return std::nullopt;
    int unacknowledged = 0;
    if (::ioctl(socket, SIOCOUTQ, &unacknowledged) != 0) return std::nullopt;
    return BytesTaken{info.tcpi_bytes_acked, unacknowledged > 0};
}

}  // namespace scancast
