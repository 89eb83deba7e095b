// The query of a URL, taken apart and put together.
//
// Pure functions; any thread. Pipeline: URL → **parseQuery** → applyWords → the view.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

/// Words with their values, in the order in which they were given.
using WordValues = std::vector<std::pair<std::string, std::string>>;
inline constexpr std::size_t mostWords = 256;

/// Splits `a=1&b=%2C` (without the question mark) and decodes %XX; `+` stays a plus. InvalidArgument for an
/// escape that is none, control characters, more than 256 words or more than 16 KiB.
Expected<WordValues> parseQuery(std::string_view query);

/// "%2F" → "/". InvalidArgument for an escape that is none, and for control characters; `of` is what the text
/// is a piece of, "the query".
Expected<std::string> percentDecode(std::string_view text, std::string_view of);

/// The other direction: everything but letters, digits and `-._~,:` is escaped.
std::string printQuery(const WordValues& words);

}  // namespace scancast
