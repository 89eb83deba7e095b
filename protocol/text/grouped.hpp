// Numbers in sentences for people. Pure functions; any thread. Place: messages, notes, tables.
#pragma once

#include <string>

namespace scancast {

/// "1,234,567".
std::string grouped(unsigned long long number);

}  // namespace scancast
