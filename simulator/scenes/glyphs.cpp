#include "simulator/scenes/glyphs.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "protocol/text/letter_strokes.hpp"

namespace scancast {
namespace {

constexpr double columns = 4, rows = letterRows;  ///< the lattice on which strokes run
constexpr double advance = 6.2 / rows;            ///< from letter to letter, in letter heights
constexpr double halfStroke = 0.52 / rows;

double distanceToStroke(double x, double y, double ax, double ay, double bx, double by) {
    const double dx = bx - ax, dy = by - ay, length2 = dx * dx + dy * dy;
    const double along = length2 > 0 ? std::clamp(((x - ax) * dx + (y - ay) * dy) / length2, 0.0, 1.0) : 0;
    return std::hypot(x - ax - along * dx, y - ay - along * dy);
}

}  // namespace

double textWidth(std::string_view text) {
    return text.empty() ? 0 : double(text.size() - 1) * advance + columns / rows;
}

bool textInk(std::string_view text, double x, double y, double boldness) {
    const double width = halfStroke * boldness;
    if (y < -width || y > 1 + width || x < -width) return false;
    const auto place = std::size_t(std::max(0.0, (x + width) / advance));
    if (place >= text.size()) return false;
    const char raw = text[place], letter = raw >= 'a' && raw <= 'z' ? char(raw - 'a' + 'A') : raw;
    const double localX = x - double(place) * advance;
    const std::string_view runs = letterStrokes(static_cast<unsigned char>(letter));
    const auto coordinate = [&](std::size_t at) { return double(runs[at] - '0') / rows; };
    for (std::size_t i = 0; i + 3 < runs.size(); i += 2) {
        if (runs[i + 2] == ' ') {
            ++i;
            continue;
        }
        if (distanceToStroke(localX, y, coordinate(i), coordinate(i + 1), coordinate(i + 2),
                             coordinate(i + 3)) < width)
            return true;
    }
    return false;
}

}  // namespace scancast
