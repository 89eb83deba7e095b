#include "renderer/cloud/native/copc/copc_layout.hpp"

#include <cmath>
#include <cstring>
#include <glm/vec3.hpp>
#include <string>

#include "files/bytes.hpp"

namespace scancast {

namespace {

constexpr std::size_t atHead = 375, atInfo = 429;
constexpr std::uint16_t infoBytes = 160;

glm::dvec3 loadPoint(const std::byte* from) {
    return {loadLe<double>(from), loadLe<double>(from + 8), loadLe<double>(from + 16)};
}

}  // namespace

bool isCopc(std::span<const std::byte> start) {
    constexpr char user[16] = "copc";
    if (start.size() < copcStartBytes || std::memcmp(start.data(), "LASF", 4) != 0) return false;
    return std::memcmp(start.data() + atHead + 2, user, sizeof user) == 0 &&
           loadLe<std::uint16_t>(start.data() + atHead + 18) == 1;
}

Expected<CopcInfo> parseCopcInfo(std::span<const std::byte> start) {
    if (start.size() < copcStartBytes)
        return fail(ErrorCode::Truncated, "it ends within the record that says that it is COPC");
    const std::byte* const at = start.data() + atInfo;
    if (loadLe<std::uint16_t>(start.data() + atHead + 20) != infoBytes)
        return fail(ErrorCode::Malformed,
                    "byte 395: the record that says that it is COPC has another length");
    CopcInfo info;
    info.cube.center = loadPoint(at);
    info.cube.halfSize = loadLe<double>(at + 24);
    info.pageOffset = loadLe<std::uint64_t>(at + 40);
    info.pageBytes = loadLe<std::uint64_t>(at + 48);
    const double reach =
        std::abs(info.cube.center.x) + std::abs(info.cube.center.y) + std::abs(info.cube.center.z);
    if (!std::isfinite(reach) || !std::isfinite(info.cube.halfSize) || !(info.cube.halfSize > 0))
        return fail(ErrorCode::Malformed, "byte 429: the cube of its octree is none");
    return info;
}

CopcEntry decodeCopcEntry(std::span<const std::byte, copcEntryBytes> bytes) {
    CopcEntry entry;
    entry.key.level = loadLe<std::int32_t>(bytes.data());
    for (std::size_t a = 0; a < 3; ++a) entry.key.at[a] = loadLe<std::int32_t>(bytes.data() + 4 + 4 * a);
    entry.offset = loadLe<std::uint64_t>(bytes.data() + 16);
    entry.bytes = loadLe<std::int32_t>(bytes.data() + 24);
    entry.points = loadLe<std::int32_t>(bytes.data() + 28);
    return entry;
}

const char* wrongCopcEntry(const CopcEntry& entry) {
    if (entry.key.level < 0 || entry.key.level > deepestVoxel) return "its level is none, or too deep";
    for (const std::int32_t at : entry.key.at)
        if (at < 0 || at >> entry.key.level != 0) return "it lies outside the octree";
    if (entry.points < -1 || entry.bytes < 0) return "its numbers are negative";
    if ((entry.points == -1 || entry.points > 0) && entry.bytes == 0) return "it has no bytes";
    return nullptr;
}

}  // namespace scancast
