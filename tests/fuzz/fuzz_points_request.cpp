// Requests for points and profiles from outside: whatever is accepted must print to something that means the same, and can be
// asked of places.
#include <cstdlib>

#include "protocol/json_text.hpp"
#include "protocol/points/points_request.hpp"
#include "renderer/cloud/export/corridor.hpp"
#include "renderer/cloud/export/region.hpp"

namespace {

void ask(const scancast::PointsRegion& region) {
    const scancast::RegionTest test(region);
    for (const double x : {-1e6, 0.0, 1.5, 1e6}) {
        static_cast<void>(test.contains({x, x / 3, 1}));
        static_cast<void>(test.of({x, x, 0}, {x + 10, x + 20, 3}));
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    if (const auto request = parsePointsRequest(text)) {
        const auto again = parsePointsRequest(printJson(toJson(*request)));
        if (!again || printJson(toJson(*again)) != printJson(toJson(*request))) std::abort();
        ask(request->region);
    }
    if (const auto request = parseProfileRequest(text)) {
        const auto again = parseProfileRequest(printJson(toJson(*request)));
        if (!again || printJson(toJson(*again)) != printJson(toJson(*request))) std::abort();
        ask(request->region);
        const auto corridor = Corridor::create(request->line, request->width);
        if (!corridor) std::abort();
        for (const double x : {-1e6, 0.0, 1.5, 1e6}) {
            static_cast<void>(corridor->place({x, x / 2}));
            static_cast<void>(corridor->segmentsNear({x, x}, {x + 10, x + 20}));
        }
    }
    static_cast<void>(parsePlanPlaces(text, "line"));
    return 0;
}
