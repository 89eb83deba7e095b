// How many pictures wait, and what for: what the scheduler knows, for /metrics.
#pragma once

#include <cstddef>

namespace scancast {

struct QueueLengths {
    std::size_t views = 0;      ///< in mailboxes, for the device: of clients that move
    std::size_t stills = 0;     ///< the same of clients that rest
    std::size_t snapshots = 0;  ///< for the device
    std::size_t blocks = 0;     ///< pictures that must be complete, for a disk
    std::size_t encodings = 0;  ///< drawn, and encoded or waiting for it
    bool operator==(const QueueLengths&) const = default;
};

}  // namespace scancast
