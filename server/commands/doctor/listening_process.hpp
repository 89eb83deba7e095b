// Who listens at a port of this machine, as far as this user may know: asked when it cannot be had. Any thread.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace scancast {

/// Of what /proc/net/tcp and tcp6 hold: the inodes of sockets that listen at this port.
std::vector<std::uint64_t> listeningInodes(const std::string& table, std::uint16_t port);

struct ListeningProcess {
    pid_t id = 0;
    std::string name;  ///< at most 15 characters
};
/// nullopt when nobody does, or it is another user's.
std::optional<ListeningProcess> listeningProcess(std::uint16_t port);

}  // namespace scancast
