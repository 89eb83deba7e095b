#include <algorithm>
#include <cmath>

#include "renderer/image/stroke_text.hpp"
#include "renderer/map/map_legend.hpp"

namespace scancast {
namespace {

/// px.
constexpr int legendEdge = 8, titleLine = 20, legendLine = 17, swatchWidth = 18, swatchHeight = 11,
              swatchGap = 7, rampWidth = 220, rampHeight = 14, endsGap = 15;
constexpr double titleHeight = 10.5, textHeight = 9;
/// As far as a legend goes: titles and descriptions may be long.
constexpr int widestLegend = 640;
constexpr Rgb8 darkInk{24, 27, 31}, lightInk{236, 239, 243};

bool isDark(const Rgb8& color) {
    return 0.299 * color[0] + 0.587 * color[1] + 0.114 * color[2] < 128;
}

void fillBox(Frame& frame, int left, int top, int width, int height, const Rgb8& color) {
    for (int y = top; y < std::min(top + height, frame.height); ++y)
        for (int x = left; x < std::min(left + width, frame.width); ++x)
            std::ranges::copy(std::array<std::uint8_t, 4>{color[0], color[1], color[2], 255},
                              frame.rgba.own().begin() + (std::ptrdiff_t(y) * frame.width + x) * 4);
}

int roomOf(std::string_view text, double height) {
    return int(std::ceil(strokeTextWidth(text, height)));
}

int rampRoom(const MapLegend& legend) {
    const int texts =
        roomOf(legend.ends[0], textHeight) + 2 * legendEdge + roomOf(legend.ends[1], textHeight);
    return std::max(rampWidth, texts);
}

}  // namespace

LegendSize legendSize(const MapLegend& legend) {
    int width = roomOf(legend.title, titleHeight), height = titleLine;
    if (!legend.ramp.empty()) {
        width = std::max(width, rampRoom(legend));
        height += rampHeight + endsGap + 4;
    }
    for (const MapLegend::Row& row : legend.rows) {
        width = std::max(width, roomOf(row.text, textHeight) + (row.color ? swatchWidth + swatchGap : 0));
        height += legendLine;
    }
    return {std::min(width + 2 * legendEdge, widestLegend), height + 2 * legendEdge - 4};
}

Frame drawLegend(const MapLegend& legend, const std::optional<Rgb8>& background) {
    const LegendSize size = legendSize(legend);
    Frame frame;
    frame.width = size.width;
    frame.height = size.height;
    frame.rgba = std::vector<std::uint8_t>(std::size_t(size.width) * std::size_t(size.height) * 4);
    if (background) fillBox(frame, 0, 0, size.width, size.height, *background);
    const Rgb8 ink = background && isDark(*background) ? lightInk : darkInk;
    int top = legendEdge;
    drawStrokeText(frame, legend.title, legendEdge, top + titleHeight, titleHeight, ink);
    top += titleLine;
    if (!legend.ramp.empty()) {
        const int width = rampRoom(legend);
        for (int x = 0; x < width; ++x) {
            const auto at =
                std::size_t(std::lround(double(x) / (width - 1) * double(legend.ramp.size() - 1)));
            fillBox(frame, legendEdge + x, top, 1, rampHeight, legend.ramp[at]);
        }
        const double foot = top + rampHeight + 4 + textHeight;
        drawStrokeText(frame, legend.ends[0], legendEdge, foot, textHeight, ink);
        drawStrokeText(frame, legend.ends[1],
                       legendEdge + width - strokeTextWidth(legend.ends[1], textHeight), foot, textHeight,
                       ink);
        top += rampHeight + endsGap + 4;
    }
    for (const MapLegend::Row& row : legend.rows) {
        int left = legendEdge;
        if (row.color) {
            fillBox(frame, left, top, swatchWidth, swatchHeight, *row.color);
            left += swatchWidth + swatchGap;
        }
        drawStrokeText(frame, row.text, left, top + (swatchHeight + textHeight) / 2, textHeight, ink);
        top += legendLine;
    }
    return frame;
}

}  // namespace scancast
