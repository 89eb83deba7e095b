#include "server/net/api/picture_headers.hpp"

#include <algorithm>
#include <cstdio>

namespace scancast {

std::string serverTiming(const EncodedPicture& picture) {
    double select = 0;
    for (const StageTime& stage : picture.stats.stages) {
        if (stage.name == "select") select += stage.milliseconds;
    }
    char text[128];
    std::snprintf(text, sizeof text, "select;dur=%.2f, render;dur=%.2f, encode;dur=%.2f", select,
                  picture.renderMs - select, picture.encodeMs);
    return text;
}

/// Nobody shall keep it as the picture of its view, or ask by a tag whether it is still the same.
void forbidKeeping(HttpResponse& response) {
    std::erase_if(response.headers, [](const auto& header) { return header.first == "ETag"; });
    for (auto& [name, value] : response.headers)
        if (name == "Cache-Control") value = "no-store";
}

/// A picture that lacks blocks is no picture of its view.
void sayDamaged(HttpResponse& response, std::uint32_t blocks) {
    forbidKeeping(response);
    response.set("Scancast-Damaged", std::to_string(blocks));
}

}  // namespace scancast
