// Bodies of POST …/measure: what is accepted survives being printed and read again, and arithmetic over it stays finite or says why.
#include <cmath>
#include <cstdlib>

#include "protocol/json_text.hpp"
#include "protocol/measure/measure_request.hpp"
#include "protocol/measure/vertices.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const auto request = parseMeasureRequest(text);
    if (!request) return 0;
    const std::string printed = printJson(toJson(*request));
    const auto again = parseMeasureRequest(printed);
    if (!again || printJson(toJson(*again)) != printed) std::abort();
    if (request->kind == MeasureKind::Distance && !std::isfinite(measurePolyline(request->points).length))
        std::abort();
    if (request->kind == MeasureKind::Angle)
        for (const auto& angle : measureAngles(request->points))
            if (angle.space && !(*angle.space >= 0 && *angle.space <= 180)) std::abort();
    if (request->kind == MeasureKind::Area && !(measureArea(request->points).plane >= 0)) std::abort();
    return 0;
}
