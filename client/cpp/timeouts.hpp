// How long a client waits. Plain values.
#pragma once

#include <chrono>

namespace scancast::client {

struct Timeouts {
    /// From looking up the host to an open connection.
    std::chrono::milliseconds connect{5'000};
    /// For each answer: a list, a snapshot, the next frame. Large clouds at full quality on few cores take a
    /// while.
    std::chrono::milliseconds answer{60'000};
};

}  // namespace scancast::client
