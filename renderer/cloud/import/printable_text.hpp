// Text out of a file or an importer, made safe to print, log and put into JSON. Pure functions.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "protocol/text/grouped.hpp"

namespace scancast {

/// Printable ASCII and line breaks as they are, everything else as '?'; cut at `longest` bytes and at the
/// first NUL; no white space at either end. Outside text is never trusted to be UTF-8.
std::string printableText(std::string_view text, std::size_t longest);

/// A word of the file in quotation marks, for messages: printable, at most 40 bytes of it.
std::string quotedText(std::string_view text);

}  // namespace scancast
