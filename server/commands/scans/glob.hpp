// Patterns of names, as shells have them: `*`, `?`, `[a-z]`, and `**` for any number of folders. Shells expand them where they
// are not quoted, and differ in how; quoted, in a configuration file or too long for a command line they come to us.
//
// The walk goes through folders as they are; matching is pure. Used on one thread. Place: argument → **paths** → scans.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

/// There is a `*`, a `?` or a `[` in it that is not behind a `\`.
bool isPattern(std::string_view text);

/// One name against one component of a pattern, both whole. `*` stands for any characters, `?` for one, `[…]` for one of a set
/// with ranges, `[!…]` for one that is not in it; `\` takes the next one as it is; a `[` without its `]` is itself. Characters
/// are those of UTF-8. A name that begins with a dot needs a pattern that does.
bool matchesName(std::string_view pattern, std::string_view name);

/// Every path that the pattern stands for, in byte order; folders that cannot be read hold none. A component `**` stands for
/// this folder and all beneath it, without hidden ones and links. Error: ResourceLimit, when more than `most` names were
/// looked at.
Expected<std::vector<std::string>> pathsOf(const std::string& pattern, std::size_t most);

}  // namespace scancast
