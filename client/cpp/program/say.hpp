// What the program writes on a terminal. Much of it was said by a server, which is not trusted: titles, ids, errors, headers.
// So everything that is printed goes through here, and a terminal obeys nothing of it.
//
// Free functions; any thread.
#pragma once

#include <cstdio>

namespace scancast::client {

/// As std::fprintf, with '?' for what a terminal would obey (protocol/text/plain_text.hpp): no carriage returns either. JSON
/// has gone through printJson() before.
[[gnu::format(printf, 2, 3)]] void sayOn(std::FILE* out, const char* format, ...);

}  // namespace scancast::client
