// How many files a server may have open - each connection is one - and how many connections fit. At the start; any
// thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "protocol/error.hpp"

namespace scancast {

/// Raises this process's soft limit of open files (RLIMIT_NOFILE) as far as `wanted`, or as its hard limit allows.
/// Returns the limit that holds then.
std::uint64_t raiseFileLimit(std::uint64_t wanted);

struct ConnectionWish {
    std::size_t sessions = 64;         ///< --max-sessions
    std::optional<std::size_t> asked;  ///< --max-connections
    std::size_t clouds = 0;            ///< that are served: a file or two each

    /// What was asked for, or sessions and room for short requests.
    std::size_t connections() const;
    /// That are open with so many connections: with those who are about to leave, probes, clouds, importers, a device.
    std::uint64_t files(std::size_t connections) const;
};

/// How many connections a server may have: what is wished for. Where nothing was asked for, and no more files may be
/// open, fewer. InvalidArgument where sessions do not fit into connections, or those into `fileLimit`; says what
/// helps.
Expected<std::size_t> fittingConnections(const ConnectionWish& wish, std::uint64_t fileLimit);

}  // namespace scancast
