#include "renderer/cloud/native/copc/copc_head.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "files/bytes.hpp"

namespace scancast {

namespace {

// What stands before the points: of COPC, some kilobytes.
constexpr std::uint64_t longestHead = 1 << 20;
// The coordinate reference system may stand behind the points, with the hierarchy: looked for among the first of what is there.
constexpr std::uint32_t mostExtended = 16;
constexpr std::size_t atFormat = 104, vlrHeadBytes = 54;
constexpr std::uint8_t formatBits = 0x3f, compressionBits = 0xc0;

Expected<void> readAll(const RandomReader& reader, std::uint64_t offset, std::span<std::byte> into) {
    const auto got = reader.readAt(offset, into);
    if (!got) return passOn(got);
    if (*got == into.size()) return {};
    return fail(ErrorCode::Truncated, fmt::format("it ends at byte {}, within its head", offset + *got));
}

std::vector<std::byte> laszipRecord(std::span<const std::byte> vlrs, std::uint32_t count) {
    constexpr char user[16] = "laszip encoded";
    for (std::uint32_t i = 0; i < count && vlrs.size() >= vlrHeadBytes; ++i) {
        const std::size_t length = loadLe<std::uint16_t>(vlrs.data() + 20);
        if (length > vlrs.size() - vlrHeadBytes) break;
        const auto content = vlrs.subspan(vlrHeadBytes, length);
        if (std::memcmp(vlrs.data() + 2, user, sizeof user) == 0 &&
            loadLe<std::uint16_t>(vlrs.data() + 18) == 22204)
            return {content.begin(), content.end()};
        vlrs = vlrs.subspan(vlrHeadBytes + length);
    }
    return {};
}

Expected<void> takeExtended(const RandomReader& reader, LasReader& las) {
    std::uint64_t at = las.las().evlrOffset;
    const std::uint32_t count = std::min(las.las().evlrs, mostExtended);
    for (std::uint32_t i = 0; i < count && at > 0 && at <= reader.size() - evlrHeadBytes; ++i) {
        std::array<std::byte, evlrHeadBytes> bytes{};
        if (auto ok = readAll(reader, at, bytes); !ok) return ok;
        const EvlrHead head = parseEvlrHead(bytes);
        at += evlrHeadBytes;
        if (head.length > reader.size() - at) break;
        if (head.isWanted()) {
            std::vector<std::byte> content(std::size_t(head.length));
            if (auto ok = readAll(reader, at, content); !ok) return ok;
            las.takeEvlr(head, content);
        }
        at += head.length;
    }
    return {};
}

}  // namespace

Expected<CopcHead> readCopcHead(const RandomReader& reader) {
    std::vector<std::byte> bytes(std::size_t(std::min<std::uint64_t>(reader.size(), copcStartBytes)));
    if (auto ok = readAll(reader, 0, bytes); !ok) return passOn(ok);
    if (!isCopc(bytes))
        return fail(ErrorCode::Unsupported, "it is not COPC: its octree's record does not stand first");
    const auto info = parseCopcInfo(bytes);
    if (!info) return passOn(info);
    // For whoever reads LAS, packed records are none.
    const auto format = std::to_integer<std::uint8_t>(bytes[atFormat]);
    if ((format & compressionBits) == 0)
        return fail(ErrorCode::Malformed, "byte 104: it is COPC, and not compressed");
    bytes[atFormat] = std::byte(format & formatBits);
    auto las = LasReader::create(bytes, {});
    if (!las) return passOn(std::move(las));
    const LasHeader& header = las->las();
    if (header.pointOffset > longestHead || header.pointOffset < copcStartBytes ||
        header.pointOffset > reader.size())
        return fail(ErrorCode::Malformed,
                    fmt::format("byte 96: its points cannot begin at byte {}", header.pointOffset));
    if (!std::isfinite(header.grid().reach()))
        return fail(ErrorCode::Malformed, "byte 131: its points may be infinitely far away");
    bytes.resize(std::size_t(header.pointOffset));
    if (auto ok = readAll(reader, copcStartBytes, std::span(bytes).subspan(copcStartBytes)); !ok)
        return passOn(ok);
    const auto vlrs = std::span<const std::byte>(bytes).subspan(header.headerBytes);
    ChunkShape shape{std::uint32_t(header.pointFormat), header.recordBytes, laszipRecord(vlrs, header.vlrs)};
    if (shape.laszip.empty())
        return fail(ErrorCode::Malformed, "it has no LASzip record (user \"laszip encoded\", number 22204)");
    las->takeVlrs(vlrs);
    if (auto ok = takeExtended(reader, *las); !ok) return passOn(ok);
    las->understand();
    const std::uint64_t digest = XXH3_64bits(bytes.data(), bytes.size());
    return CopcHead{*info, std::move(*las), std::move(shape), digest};
}

}  // namespace scancast
