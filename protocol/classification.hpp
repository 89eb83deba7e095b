// What the ASPRS calls its point classes (LAS 1.4 R15, table 17): one table for `info`, the API and messages.
// Pure function; any thread.
#pragma once

#include <cstdint>
#include <string_view>

namespace scancast {

/// "ground", "low vegetation" …; "reserved" for 19 to 63, "user defined" from 64 on. Never empty.
std::string_view className(std::uint8_t classification);

}  // namespace scancast
