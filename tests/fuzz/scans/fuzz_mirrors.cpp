// Any bytes at all as a file of mirrors: an error, or mirrors that are planes of a size.
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>

#include "renderer/cloud/import/mirror_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const auto mirrors = parseMirrors({reinterpret_cast<const char*>(data), size}, "fuzz.mirrors.json");
    if (!mirrors) {
        if (mirrors.error().message.empty()) std::abort();
        return 0;
    }
    if (mirrors->size() > mostMirrors) std::abort();
    for (const Mirror& mirror : *mirrors) {
        const auto unit = [](const glm::dvec3& v) { return std::abs(glm::length(v) - 1) < 1e-9; };
        if (!unit(mirror.normal) || !unit(mirror.up)) std::abort();
        if (!(std::abs(glm::dot(mirror.normal, mirror.up)) < 1e-9)) std::abort();
        if (!(mirror.width > 0) || !(mirror.height > 0) || !std::isfinite(mirror.width + mirror.height))
            std::abort();
    }
    // What is printed is read back.
    const auto again = parseMirrors(printMirrors(*mirrors), "again");
    if (!again || again->size() != mirrors->size()) std::abort();
    return 0;
}
