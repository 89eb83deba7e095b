// How much of what was written to a connection has arrived at its other end. Pure function of the socket; any thread.
#pragma once

#include <cstdint>
#include <optional>

namespace scancast {

struct BytesTaken {
    std::uint64_t taken = 0;  ///< acknowledged by the other end since the connection began
    bool waiting = false;     ///< there is more that has not been
};

/// nullopt: not a TCP connection, or this kernel does not tell (Linux does from 4.1 on).
std::optional<BytesTaken> bytesTaken(int socket);

}  // namespace scancast
