// JSON looks from outside: whatever is accepted must print to something that means the same.
#include <cstdlib>

#include "protocol/json_text.hpp"
#include "protocol/look.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const auto value = parseJson({reinterpret_cast<const char*>(data), size});
    if (!value) return 0;
    const auto look = applyLook(Look{}, *value);
    if (!look) return 0;
    const auto canonical = toJson(*look);
    if (look->views.empty() || look->outline.empty()) {
        if (validate(*look)) std::abort();
        return 0;
    }
    const auto again = applyLook(Look{}, canonical);
    if (!validate(*look) || !again || printJson(toJson(*again)) != printJson(canonical)) std::abort();
    for (const LookView& view : look->views)
        for (const double aspect : {0.1, 1.0, 16.0 / 9}) static_cast<void>(cameraFor(*look, view, aspect));
    return 0;
}
