// What commands say to whoever started them: words on standard error, results on standard output. Who read
// them may be gone
// (`scancast info town.scan | head`), or the disk that they went to full: that is nobody's fault. What is said may come from a file that
// somebody made, so what a terminal would obey becomes '?' (protocol/text/plain_text.hpp; JSON has gone through plainJson()
// before). Any thread.
#pragma once

#include <fmt/format.h>

#include <string_view>

#include "protocol/error.hpp"

namespace scancast {

/// To standard error. That nobody hears it is no reason to stop working.
void tellText(std::string_view text);

template <class... Values>
void tell(fmt::format_string<Values...> format, Values&&... values) {
    tellText(fmt::format(format, std::forward<Values>(values)...));
}

/// To standard output, at once. Io when it cannot be written: what was asked for is not there then.
Expected<void> print(std::string_view text);

}  // namespace scancast
