#include "server/terminal/terminal.hpp"

#include <cerrno>
#include <cstdio>
#include <string>

#include "files/system_error.hpp"
#include "protocol/text/plain_text.hpp"

namespace scancast {

void tellText(std::string_view text) {
    const std::string plain = plainText(text);
    (void)std::fwrite(plain.data(), 1, plain.size(), stderr);
}

Expected<void> print(std::string_view text) {
    const std::string plain = plainText(text);
    if (std::fwrite(plain.data(), 1, plain.size(), stdout) == plain.size() && std::fflush(stdout) == 0)
        return {};
    return fail(ErrorCode::Io, "standard output cannot be written: " + systemReason(errno));
}

}  // namespace scancast
