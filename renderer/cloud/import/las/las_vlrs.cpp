#include "renderer/cloud/import/las/las_vlrs.hpp"

#include <cstring>
#include <string_view>

#include "files/bytes.hpp"

namespace scancast {

namespace {

constexpr std::size_t vlrHeaderBytes = 54;
constexpr int extraBytesRecord = 4;
constexpr std::string_view projectionUser("LASF_Projection\0", 16);
constexpr std::string_view specUser("LASF_Spec\0\0\0\0\0\0\0", 16);

bool is(std::span<const std::byte> userId, std::string_view wanted) {
    return userId.size() >= wanted.size() && std::memcmp(userId.data(), wanted.data(), wanted.size()) == 0;
}

}  // namespace

bool isWantedVlr(std::span<const std::byte> userId, int recordId) {
    return is(userId, projectionUser) || (is(userId, specUser) && recordId == extraBytesRecord);
}

void readVlr(std::span<const std::byte> userId, int recordId, std::span<const std::byte> content,
             LasVlrs& vlrs) {
    if (is(userId, projectionUser)) readProjectionRecord(recordId, content, vlrs.crs);
    if (is(userId, specUser) && recordId == extraBytesRecord && vlrs.extraBytes.empty() &&
        content.size() <= longestVlr)
        vlrs.extraBytes.assign(content.begin(), content.end());
}

EvlrHead parseEvlrHead(std::span<const std::byte, evlrHeadBytes> bytes) {
    // reserved (2), user id (16), record id (2), length after this header (8), description (32)
    EvlrHead head;
    std::memcpy(head.userId.data(), bytes.data() + 2, head.userId.size());
    head.recordId = loadLe<std::uint16_t>(bytes.data() + 18);
    head.length = loadLe<std::uint64_t>(bytes.data() + 20);
    return head;
}

void readEvlrs(std::span<const std::byte> bytes, LasVlrs& vlrs) {
    for (std::uint32_t i = 0; i < mostEvlrs && bytes.size() >= evlrHeadBytes; ++i) {
        const EvlrHead head = parseEvlrHead(bytes.first<evlrHeadBytes>());
        bytes = bytes.subspan(evlrHeadBytes);
        if (head.length > bytes.size()) return;
        if (head.isWanted()) readVlr(head.userId, head.recordId, bytes.first(head.length), vlrs);
        bytes = bytes.subspan(head.length);
    }
}

void readVlrs(std::span<const std::byte> bytes, std::uint64_t count, LasVlrs& vlrs) {
    for (std::uint64_t i = 0; i < count && bytes.size() >= vlrHeaderBytes; ++i) {
        // reserved (2), user id (16), record id (2), length after this header (2), description (32)
        const int recordId = loadLe<std::uint16_t>(bytes.data() + 18);
        const std::size_t length = loadLe<std::uint16_t>(bytes.data() + 20);
        const auto userId = bytes.subspan(2, 16);
        bytes = bytes.subspan(vlrHeaderBytes);
        if (length > bytes.size())
            return;  // runs into the points: its length is wrong, and so is all that follows
        readVlr(userId, recordId, bytes.first(length), vlrs);
        bytes = bytes.subspan(length);
    }
}

}  // namespace scancast
