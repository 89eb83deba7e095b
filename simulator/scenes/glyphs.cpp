#include "simulator/scenes/glyphs.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scancast {
namespace {

constexpr double columns = 4, rows = 6;  ///< the lattice on which strokes run
constexpr double advance = 6.2 / rows;   ///< from letter to letter, in letter heights
constexpr double halfStroke = 0.52 / rows;

/// Strokes of a letter: runs of lattice points as pairs of digits (column, row from below), separated by
/// blanks.
constexpr std::string_view strokes(char letter) {
    switch (letter) {
        case 'A':
            return "002640 1232";
        case 'B':
            return "00063645443303 3342413000";
        case 'C':
            return "4536160501103041";
        case 'D':
            return "00062644422000";
        case 'E':
            return "46060040 0333";
        case 'F':
            return "460600 0333";
        case 'G':
            return "45361605011030414323";
        case 'H':
            return "0006 4046 0343";
        case 'I':
            return "2026";
        case 'J':
            return "4641301001";
        case 'K':
            return "0006 460340";
        case 'L':
            return "060040";
        case 'M':
            return "0006234640";
        case 'N':
            return "00064046";
        case 'O':
            return "103041453616050110";
        case 'P':
            return "00063645443303";
        case 'Q':
            return "103041453616050110 2240";
        case 'R':
            return "00063645443303 2340";
        case 'S':
            return "453616050413334241301001";
        case 'T':
            return "0646 2620";
        case 'U':
            return "060110304146";
        case 'V':
            return "062046";
        case 'W':
            return "0610243046";
        case 'X':
            return "0640 0046";
        case 'Y':
            return "062346 2320";
        case 'Z':
            return "06460040";
        case '0':
            return "103041453616050110 0145";
        case '1':
            return "042620 0040";
        case '2':
            return "05163645440040";
        case '3':
            return "0516364544334241301001 1333";
        case '4':
            return "30360242";
        case '5':
            return "460603334241301001";
        case '6':
            return "4536160501103041423303";
        case '7':
            return "064620";
        case '8':
            return "13040516364544334241301001021333";
        case '9':
            return "0110304145361605041343";
        case '-':
            return "1333";
        case '.':
            return "2020";
        case '/':
            return "0046";
        case ':':
            return "2121 2424";
        case '\'':
            return "2625";
        case '&':
            return "40050616261401103042";
        default:
            return "";
    }
}

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
    const std::string_view runs = strokes(letter);
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
