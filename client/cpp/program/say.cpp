#include "client/cpp/program/say.hpp"

#include <cstdarg>
#include <string>

#include "protocol/text/plain_text.hpp"

namespace scancast::client {

void sayOn(std::FILE* out, const char* format, ...) {
    std::va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    const int length = std::vsnprintf(nullptr, 0, format, arguments);
    va_end(arguments);
    if (length > 0) {
        std::string text(static_cast<std::size_t>(length), '\0');
        std::vsnprintf(text.data(), text.size() + 1, format, again);
        const std::string plain = plainText(text);
        (void)std::fwrite(plain.data(), 1, plain.size(), out);  // nobody need hear it
    }
    va_end(again);
}

}  // namespace scancast::client
