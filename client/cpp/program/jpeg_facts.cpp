#include "client/cpp/program/jpeg_facts.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>

namespace scancast::client {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Table = std::array<int, 64>;

/// Annex K of the JPEG standard, in the zigzag order in which files have it; encoders scale it by quality.
constexpr Table standardLuminance{16, 11, 12,  14,  12,  10, 16, 14,  13,  14,  18,  17,  16, 19,  24,  40,
                                  26, 24, 22,  22,  24,  49, 35, 37,  29,  40,  58,  51,  61, 60,  57,  51,
                                  56, 55, 64,  72,  92,  78, 64, 68,  87,  69,  55,  56,  80, 109, 81,  87,
                                  95, 98, 103, 104, 103, 62, 77, 113, 121, 112, 100, 120, 92, 101, 103, 99};

int distance(const Table& table, int quality) {
    const int scale = quality < 50 ? 5000 / quality : 200 - 2 * quality;
    int sum = 0;
    for (std::size_t i = 0; i < table.size(); ++i)
        sum += std::abs(table[i] - std::clamp((standardLuminance[i] * scale + 50) / 100, 1, 255));
    return sum;
}

int nearestQuality(const Table& table) {
    int best = 1;
    for (int quality = 2; quality <= 100; ++quality)
        if (distance(table, quality) < distance(table, best)) best = quality;
    return best;
}

/// The first table of a DQT segment, when it is number 0, luminance; 8 bits an entry.
std::optional<Table> luminanceTable(Bytes segment) {
    if (segment.size() < 65 || segment[0] != 0) return std::nullopt;
    Table table;
    std::copy_n(segment.begin() + 1, table.size(), table.begin());
    return table;
}

std::string subsamplingOf(Bytes frame) {
    if (frame.size() < 9 || frame[5] < 3) return "grey";
    switch (frame[7]) {
        case 0x11:
            return "4:4:4";
        case 0x21:
            return "4:2:2";
        case 0x22:
            return "4:2:0";
        default:
            return std::to_string(frame[7] >> 4) + "x" + std::to_string(frame[7] & 15);
    }
}

bool isFrameMarker(std::uint8_t marker) {
    return marker >= 0xC0 && marker <= 0xC2;
}

}  // namespace

Expected<JpegFacts> jpegFacts(Bytes bytes) {
    const auto word = [&](std::size_t at) { return bytes[at] << 8 | bytes[at + 1]; };
    if (bytes.size() < 4 || word(0) != 0xFFD8) return fail(ErrorCode::Malformed, "this is no JPEG");
    JpegFacts facts;
    for (std::size_t at = 2; at + 4 <= bytes.size();) {
        const auto marker = bytes[at + 1];
        const auto length = static_cast<std::size_t>(word(at + 2));
        if (bytes[at] != 0xFF || length < 2) return fail(ErrorCode::Malformed, "this JPEG is damaged");
        if (at + 2 + length > bytes.size()) break;
        const auto segment = bytes.subspan(at + 4, length - 2);
        if (marker == 0xDB && facts.quality == 0)
            if (const auto table = luminanceTable(segment)) facts.quality = nearestQuality(*table);
        if (isFrameMarker(marker) && segment.size() >= 6) {
            facts.height = segment[1] << 8 | segment[2];
            facts.width = segment[3] << 8 | segment[4];
            facts.subsampling = subsamplingOf(segment);
            return facts;
        }
        at += 2 + length;
    }
    return fail(ErrorCode::Truncated, "this JPEG ends before its picture begins");
}

}  // namespace scancast::client
