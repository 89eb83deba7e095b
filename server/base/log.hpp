// The log: lines on standard error, for people or for machines. Set up once, by a subcommand, before any
// thread starts.
#pragma once

#include <string>

#include "protocol/error.hpp"

namespace scancast {

/// `level`: debug, info, warn, error or off. `format`: text, or json for one object a line. InvalidArgument
/// otherwise. Each message is one line of which a terminal obeys nothing, whatever is in it.
Expected<void> setUpLog(const std::string& level, const std::string& format);

}  // namespace scancast
