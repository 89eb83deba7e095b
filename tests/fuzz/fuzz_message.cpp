// Control messages of both sides: whatever is accepted must survive being printed and read again.
#include <cstdlib>

#include "protocol/messages.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    if (const auto message = parseClientMessage(text)) {
        const auto again = parseClientMessage(printMessage(*message));
        if (!again || *again != *message) std::abort();
    }
    if (const auto message = parseServerMessage(text)) {
        const auto again = parseServerMessage(printMessage(*message));
        if (!again || *again != *message) std::abort();
    }
    return 0;
}
