// How hard a token is to guess, estimated from the text alone: who sets a server up learns that "letmein-0123456789" will not
// do before somebody else finds out. Pure functions; any thread. Used where files with secrets are read (token_file.hpp).
#pragma once

#include <string>
#include <string_view>

namespace scancast {

/// A token of this server is held to be guessed in vain from here on.
inline constexpr double leastTokenBits = 96;

/// An estimate from above of what somebody must try, as a power of two; the rules stand in docs/configuration.md:
/// each character counts as log2 of the alphabet that the token seems to be written in, and of no more than twice as many
/// different ones as it has; 2 bits after a letter of the same case, as words have them, unless all are hexadecimal digits; nothing inside a run (aaa, abc, 321)
/// or of four and more that stood there before.
double estimatedBits(std::string_view token);

/// "about 23 bits are estimated, and 96 are needed; scancast token NAME makes a good one, …": never the token itself.
std::string weaknessText(double bits);

}  // namespace scancast
