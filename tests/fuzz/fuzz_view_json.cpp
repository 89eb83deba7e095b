// JSON views from outside: whatever is accepted must be sound and print to something that means the same.
#include <cstdlib>

#include "protocol/json_text.hpp"
#include "protocol/view/view_json.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const auto value = parseJson({reinterpret_cast<const char*>(data), size});
    if (!value) return 0;
    const auto view = applyJson(View{}, *value);
    if (!view) return 0;
    const auto canonical = toJson(*view);
    const auto again = applyJson(View{}, canonical);
    if (!validate(*view) || !again || printJson(toJson(*again)) != printJson(canonical)) std::abort();
    return 0;
}
