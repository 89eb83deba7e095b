#include "renderer/image/jpeg_stripes.hpp"

#include <optional>

namespace scancast {
namespace {

using Span = std::span<const std::uint8_t>;

constexpr std::uint8_t startOfFrame = 0xC0, startOfScan = 0xDA, endOfImage = 0xD9, restartInterval = 0xDD,
                       firstRestart = 0xD0;
constexpr std::size_t mostRestarts = 8, largestInterval = 0xffff;

/// Where what is changed of a picture stands.
struct Layout {
    std::size_t frame = 0;  ///< the frame header's segment: behind its marker and length
    std::size_t scan = 0;   ///< the scan header's marker
    Span entropy;           ///< the scan without header and end of image
};

std::size_t wordAt(Span bytes, std::size_t at) {
    return std::size_t(bytes[at]) << 8 | bytes[at + 1];
}

std::optional<Layout> layoutOf(Span bytes) {
    Layout layout;
    for (std::size_t at = 2; at + 4 <= bytes.size();) {
        const std::size_t length = wordAt(bytes, at + 2);
        if (bytes[at] != 0xFF || length < 2 || at + 2 + length + 2 > bytes.size()) return std::nullopt;
        if (bytes[at + 1] == startOfFrame && length >= 2 + 6 + 3) layout.frame = at + 4;
        if (bytes[at + 1] == startOfScan) {
            const Span end = bytes.last(2);
            if (layout.frame == 0 || end[0] != 0xFF || end[1] != endOfImage) return std::nullopt;
            layout.scan = at;
            const std::size_t begin = at + 2 + length;
            layout.entropy = bytes.subspan(begin, bytes.size() - 2 - begin);
            return layout;
        }
        at += 2 + length;
    }
    return std::nullopt;
}

void append(std::vector<std::uint8_t>& bytes, Span more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
}

tl::unexpected<Error> wrong(const char* what) {
    return fail(ErrorCode::Internal, std::string("JPEG: ") + what);
}

}  // namespace

Expected<std::vector<std::uint8_t>> joinJpegStripes(std::span<const Span> stripes, int height, int rows) {
    if (stripes.empty()) return wrong("there are no stripes");
    const Span first = stripes.front();
    if (stripes.size() == 1) return std::vector<std::uint8_t>(first.begin(), first.end());
    const auto head = layoutOf(first);
    if (!head) return wrong("a stripe is no baseline picture");

    // Blocks of 8 px that a smallest coded unit has, by the first component's sampling factors.
    const std::size_t factors = first[head->frame + 7];
    const std::size_t unitWidth = 8 * (factors >> 4), unitHeight = 8 * (factors & 15);
    const std::size_t width = wordAt(first, head->frame + 3);
    if (unitWidth == 0 || unitHeight == 0 || std::size_t(rows) % unitHeight != 0)
        return wrong("stripes do not end with a block");
    const std::size_t interval = (width + unitWidth - 1) / unitWidth * (std::size_t(rows) / unitHeight);
    if (interval > largestInterval) return wrong("a stripe has too many blocks");

    std::vector<std::uint8_t> joined;
    std::size_t size = 16;
    for (const Span stripe : stripes) size += stripe.size();
    joined.reserve(size);
    append(joined, first.first(head->scan));
    joined[head->frame + 1] = std::uint8_t(height >> 8);
    joined[head->frame + 2] = std::uint8_t(height & 255);
    append(joined,
           std::initializer_list<std::uint8_t>{0xFF, restartInterval, 0, 4, std::uint8_t(interval >> 8),
                                               std::uint8_t(interval & 255)});
    append(joined, first.subspan(head->scan, std::size_t(head->entropy.data() - first.data()) - head->scan));
    append(joined, head->entropy);
    for (std::size_t i = 1; i < stripes.size(); ++i) {
        const auto layout = layoutOf(stripes[i]);
        if (!layout) return wrong("a stripe is no baseline picture");
        joined.push_back(0xFF);
        joined.push_back(std::uint8_t(firstRestart + (i - 1) % mostRestarts));
        append(joined, layout->entropy);
    }
    joined.push_back(0xFF);
    joined.push_back(endOfImage);
    return joined;
}

}  // namespace scancast
