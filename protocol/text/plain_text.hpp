// Text from outside, as it may stand on a terminal or in a log: a title, a file's name, what an importer or a server says. A
// terminal takes some characters for commands - clear, rename the window, type for the user -, shows others in an order that
// is not theirs, and ends a log's line at a line break.
//
// Pure functions; any thread. Place: whoever prints, last before it is printed.
#pragma once

#include <string>
#include <string_view>

namespace scancast {

/// UTF-8 as it is, with line breaks and tabs. A '?' stands for every other control character (of C1, too, which some
/// terminals obey), for what turns the direction of writing, for separators of lines and paragraphs, and for each byte that
/// is no UTF-8. Doing it twice changes nothing.
std::string plainText(std::string_view text);

/// The same in one line: line breaks and tabs become spaces. For logs, where a line is an event.
std::string plainLine(std::string_view text);

/// JSON that means the same, with \u escapes for what plainText() replaces. `json` is valid, so that such a character stands
/// inside a string; its line breaks stay.
std::string plainJson(std::string json);

}  // namespace scancast
