// How long work tells how far it is. Reported from any thread, at most a few times a second; the receiver
// decides whether it becomes a bar on a terminal, a line in a log or a number in an answer.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

namespace scancast {

struct Progress {
    std::string_view stage;  ///< "reading", "sorting", "averaging"
    std::uint64_t done = 0;
    std::uint64_t total = 0;  ///< 0 = not known
    std::string_view unit = "points";
};

/// May be called from several threads at once; must be thread-safe. An empty function is allowed everywhere.
using ProgressSink = std::function<void(const Progress&)>;

}  // namespace scancast
