// Queries from outside: whatever is decoded must survive being printed and read again, and no word may crash.
#include <cstdlib>

#include "protocol/view/view_words.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const auto words = parseQuery({reinterpret_cast<const char*>(data), size});
    if (!words) return 0;
    const auto printed = printQuery(*words);
    // Escaping may make a query longer than what is accepted; everything else must come back.
    if (const auto again = parseQuery(printed); printed.size() <= size && (!again || *again != *words))
        std::abort();
    const auto view = applyWords(View{}, *words);
    if (view && !validate(*view)) std::abort();
    return 0;
}
