// Numbers in sentences for people. Pure functions; any thread. Place: messages, notes, tables.
#pragma once

#include <string>
#include <string_view>

namespace scancast {

/// "1,234,567".
std::string grouped(unsigned long long number);

/// "1 point", "2 points": a noun that takes an s.
std::string counted(unsigned long long number, std::string_view noun);

}  // namespace scancast
