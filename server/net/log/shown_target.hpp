// What of a request's target may be read by whoever reads the log: the path and the words that say what was
// asked for, and nothing that opens a door.
//
// Pure functions of outside bytes; any thread. Pipeline: http connection → **shown target** → request log.
#pragma once

#include <string>
#include <string_view>

namespace scancast {

/// Path and query. Values stand there of a view's words and of a stream's `fps`; of all others, and of words that
/// are too long, a `*`: `token=*`. A word without a value could be a secret itself, and is a `*`. Of a session's id, which is its key, the beginning
/// (shownSession()). At most 720 bytes; "…" stands for what is left out.
std::string shownTarget(std::string_view target);

/// So much of a session's id as tells it from others and lets nobody drive it: "3f2a9c1b…".
std::string shownSession(std::string_view id);

}  // namespace scancast
