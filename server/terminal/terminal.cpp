#include "server/terminal/terminal.hpp"

#include <cerrno>
#include <cstdio>

#include "files/system_error.hpp"

namespace scancast {

void tellText(std::string_view text) {
    (void)std::fwrite(text.data(), 1, text.size(), stderr);
}

Expected<void> print(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0)
        return {};
    return fail(ErrorCode::Io, "standard output cannot be written: " + systemReason(errno));
}

}  // namespace scancast
