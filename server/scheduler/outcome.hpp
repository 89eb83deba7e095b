// How pictures end that nobody gets to see. Pure functions; any thread.
#pragma once

#include <optional>

#include "protocol/error.hpp"
#include "server/base/metrics.hpp"
#include "server/scheduler/turns.hpp"

namespace scancast {

Error cancelled();
Error tooLate();

/// Of a request that ended without a picture: what who asked is told.
Error errorOf(const Turns::Request& request);
/// As what it is counted; nullopt = not at all.
std::optional<DropReason> dropReason(Turns::End end);

}  // namespace scancast
