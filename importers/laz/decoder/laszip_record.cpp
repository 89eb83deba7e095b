#include "importers/laz/decoder/laszip_record.hpp"

#include <array>
#include <optional>
#include <string>

#include "files/bytes.hpp"

namespace scancast::laz {

namespace {

constexpr std::size_t laszipHeadBytes = 34, itemEntryBytes = 6;
constexpr std::size_t mostItems = 32;
// A model each is learnt for every one of them; real files have a dozen.
constexpr std::uint32_t mostExtraBytes = 4096;

struct ItemRule {
    ItemKind kind;
    const char* name;
    std::uint32_t bytes;  // 0 = as many as there are
    std::array<int, 2> versions;
};

// Version 2 of the layered items is that of a prototype, and the same as 3.
constexpr ItemRule rules[] = {
    {ItemKind::Bytes, "BYTE", 0, {1, 2}},
    {ItemKind::Point10, "POINT10", 20, {1, 2}},
    {ItemKind::GpsTime11, "GPSTIME11", 8, {1, 2}},
    {ItemKind::Rgb12, "RGB12", 6, {1, 2}},
    {ItemKind::WavePacket13, "WAVEPACKET13", 29, {1, 1}},
    {ItemKind::Point14, "POINT14", 30, {2, 4}},
    {ItemKind::Rgb14, "RGB14", 6, {2, 4}},
    {ItemKind::RgbNir14, "RGBNIR14", 8, {2, 4}},
    {ItemKind::WavePacket14, "WAVEPACKET14", 29, {3, 4}},
    {ItemKind::Bytes14, "BYTE14", 0, {2, 4}},
};

const ItemRule* ruleOf(ItemKind kind) {
    for (const ItemRule& rule : rules)
        if (rule.kind == kind) return &rule;
    return nullptr;
}

/// What a record of a point format is made of, without extra bytes; Bytes: nothing more.
std::array<ItemKind, 4> itemsOf(int pointFormat) {
    using enum ItemKind;
    switch (pointFormat) {
        case 0:
            return {Point10};
        case 1:
            return {Point10, GpsTime11};
        case 2:
            return {Point10, Rgb12};
        case 3:
            return {Point10, GpsTime11, Rgb12};
        case 4:
            return {Point10, GpsTime11, WavePacket13};
        case 5:
            return {Point10, GpsTime11, Rgb12, WavePacket13};
        case 6:
            return {Point14};
        case 7:
            return {Point14, Rgb14};
        case 8:
            return {Point14, RgbNir14};
        case 9:
            return {Point14, WavePacket14};
        default:
            return {Point14, RgbNir14, WavePacket14};
    }
}

std::string describe(const std::vector<Item>& items) {
    std::string text;
    for (const Item& item : items) {
        const ItemRule* const rule = ruleOf(item.kind);
        text += (text.empty() ? "" : ", ") +
                (rule ? rule->name : "kind " + std::to_string(static_cast<int>(item.kind))) + " version " +
                std::to_string(item.version);
    }
    return text;
}

Expected<std::vector<Item>> parseItems(std::span<const std::byte> content) {
    const std::size_t count = loadLe<std::uint16_t>(content.data() + 32);
    if (count > mostItems || laszipHeadBytes + itemEntryBytes * count > content.size())
        return fail(ErrorCode::Malformed, "its LASzip record is damaged: " + std::to_string(count) +
                                              " items in " + std::to_string(content.size()) + " bytes");
    std::vector<Item> items;
    for (std::size_t i = 0; i < count; ++i) {
        const std::byte* const at = content.data() + laszipHeadBytes + itemEntryBytes * i;
        items.push_back({static_cast<ItemKind>(loadLe<std::uint16_t>(at)), loadLe<std::uint16_t>(at + 2),
                         loadLe<std::uint16_t>(at + 4)});
    }
    return items;
}

/// Whether they are those of the point format, and then extra bytes, together of a record's length.
bool describes(const std::vector<Item>& items, int pointFormat, std::uint32_t recordBytes) {
    const bool layered = pointFormat >= 6;
    std::size_t at = 0;
    std::uint32_t bytes = 0;
    for (const ItemKind kind : itemsOf(pointFormat)) {
        if (kind == ItemKind::Bytes) break;
        if (at == items.size() || items[at].kind != kind || items[at].bytes != ruleOf(kind)->bytes)
            return false;
        bytes += items[at++].bytes;
    }
    for (; at < items.size(); ++at) {
        if (items[at].kind != (layered ? ItemKind::Bytes14 : ItemKind::Bytes) || items[at].bytes == 0)
            return false;
        bytes += items[at].bytes;
    }
    return bytes == recordBytes;
}

Expected<void> checkItems(const std::vector<Item>& items, int pointFormat, std::uint32_t recordBytes) {
    if (!describes(items, pointFormat, recordBytes))
        return fail(ErrorCode::Malformed, "its LASzip record (" + describe(items) +
                                              ") does not describe the records of " +
                                              std::to_string(recordBytes) + " bytes of point format " +
                                              std::to_string(pointFormat));
    for (const Item& item : items) {
        const auto [least, most] = ruleOf(item.kind)->versions;
        if (item.version < least || item.version > most)
            return fail(ErrorCode::Unsupported,
                        "it is LAZ with items that cannot be decoded here (" + describe(items) +
                            "; versions " + (pointFormat >= 6 ? "3 and 4" : "1 and 2") +
                            " can): write it again with the LASzip that made it, as LAS");
    }
    const std::uint32_t extra = recordBytes - leastRecordBytes(pointFormat);
    if (extra > mostExtraBytes)
        return fail(ErrorCode::ResourceLimit, "its records have " + std::to_string(extra) +
                                                  " extra bytes; up to " + std::to_string(mostExtraBytes) +
                                                  " can be decoded");
    return {};
}

}  // namespace

std::uint32_t leastRecordBytes(int pointFormat) {
    constexpr std::array<std::uint32_t, 11> bytes = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
    return bytes[static_cast<std::size_t>(pointFormat)];
}

Expected<LaszipRecord> parseLaszipRecord(std::span<const std::byte> content, int pointFormat,
                                         std::uint32_t recordBytes) {
    if (content.size() < laszipHeadBytes)
        return fail(ErrorCode::Malformed, "its LASzip record has " + std::to_string(content.size()) +
                                              " bytes; " + std::to_string(laszipHeadBytes) + " are needed");
    const int compressor = loadLe<std::uint16_t>(content.data());
    const int coder = loadLe<std::uint16_t>(content.data() + 2);
    if (compressor < 1 || compressor > 3)
        return fail(ErrorCode::Unsupported,
                    "LAZ compressor " + std::to_string(compressor) +
                        " is not known here; 1 (point by point), 2 and 3 (chunks) are");
    if (coder != 0)
        return fail(ErrorCode::Unsupported,
                    "LAZ coder " + std::to_string(coder) + " is not known here; 0 (arithmetic) is");
    LaszipRecord record;
    record.compressor = static_cast<Compressor>(compressor);
    if ((pointFormat >= 6) != (record.compressor == Compressor::Layered))
        return fail(ErrorCode::Malformed, "its LASzip record says compressor " + std::to_string(compressor) +
                                              ", which point format " + std::to_string(pointFormat) +
                                              " never has");
    auto items = parseItems(content);
    if (!items) return passOn(items);
    record.items = std::move(*items);
    if (const auto ok = checkItems(record.items, pointFormat, recordBytes); !ok) return passOn(ok);
    // Both 0 and all bits set mean that the table says how many points each chunk has; COPC files are written with either.
    record.chunkPoints = loadLe<std::uint32_t>(content.data() + 12);
    if (record.chunkPoints == 0) record.chunkPoints = variableChunks;
    return record;
}

}  // namespace scancast::laz
