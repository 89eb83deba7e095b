#include "renderer/image/stroke_text.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <vector>

#include "protocol/text/letter_strokes.hpp"

namespace scancast {
namespace {

/// Of columns of the lattice to its rows; between letters, and of a blank, in columns; half a stroke, in rows.
constexpr double narrow = 0.8, gap = 1.7, blank = 2.2, halfInk = 0.42;

struct InkedStroke {
    glm::dvec2 from, to;  ///< lattice, from the letter's left end
};

struct InkedLetter {
    std::vector<InkedStroke> strokes;
    double width = blank;  ///< columns
};

/// The next character of UTF-8, which it is taken from; what is none becomes '?'.
char32_t nextLetter(std::string_view& text) {
    const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[at]); };
    const unsigned char first = byte(0);
    const std::size_t length = first < 0x80 ? 1 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
    if (length == 1 || first < 0xc0 || length > text.size()) {
        text.remove_prefix(1);
        return first < 0x80 ? first : U'?';
    }
    char32_t letter = first & (0x7fU >> length);
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xc0U) != 0x80) {
            text.remove_prefix(i);
            return U'?';
        }
        letter = letter << 6 | (byte(i) & 0x3fU);
    }
    text.remove_prefix(length);
    return letter;
}

InkedLetter inkedLetter(char32_t letter) {
    InkedLetter made;
    if (letter == U' ' || letter == U'\u00a0') return made;
    if (letter == U'\u2212' || letter == U'\u2013') letter = U'-';  // a minus, a dash
    std::string_view runs = letterStrokes(letter);
    if (runs.empty()) runs = letterStrokes(U'?');
    const auto point = [&](std::size_t at) { return glm::dvec2(runs[at] - '0', runs[at + 1] - '0'); };
    double left = 9, right = 0;
    for (std::size_t i = 0; i + 3 < runs.size(); i += 2) {
        if (runs[i + 2] == ' ') {
            ++i;
            continue;
        }
        made.strokes.push_back({point(i), point(i + 2)});
        left = std::min({left, point(i).x, point(i + 2).x});
        right = std::max({right, point(i).x, point(i + 2).x});
    }
    for (InkedStroke& stroke : made.strokes) {
        stroke.from.x -= left;
        stroke.to.x -= left;
    }
    made.width = right - left;
    return made;
}

double distanceTo(const InkedStroke& stroke, const glm::dvec2& place) {
    const glm::dvec2 along = stroke.to - stroke.from, off = place - stroke.from;
    const double length2 = glm::dot(along, along);
    const double t = length2 > 0 ? std::clamp(glm::dot(off, along) / length2, 0.0, 1.0) : 0;
    return glm::length(off - along * t);
}

void inkPixel(Frame& frame, int x, int y, double cover, const Rgb8& color) {
    std::uint8_t* const pixel =
        frame.rgba.own().data() + (std::size_t(y) * std::size_t(frame.width) + std::size_t(x)) * 4;
    // Over what is there, with straight alpha.
    const double under = pixel[3] / 255.0 * (1 - cover), all = cover + under;
    for (std::size_t c = 0; c < 3; ++c)
        pixel[c] = std::uint8_t(std::lround((color[c] * cover + pixel[c] * under) / all));
    pixel[3] = std::uint8_t(std::lround(255 * all));
}

}  // namespace

double strokeTextWidth(std::string_view text, double height) {
    double width = 0;
    while (!text.empty()) width += inkedLetter(nextLetter(text)).width + (text.empty() ? 0 : gap);
    return width * narrow * height / letterRows;
}

void drawStrokeText(Frame& frame, std::string_view text, double x, double foot, double height,
                    const Rgb8& color) {
    const double row = height / letterRows, column = row * narrow, half = halfInk * row;
    while (!text.empty()) {
        InkedLetter letter = inkedLetter(nextLetter(text));
        for (InkedStroke& stroke : letter.strokes)
            for (glm::dvec2* end : {&stroke.from, &stroke.to})
                *end = {x + end->x * column, foot - end->y * row};
        // Feet two rows below the line, capitals and one row more above it.
        const int left = std::max(0, int(std::floor(x - half - 1))),
                  right = std::min(frame.width - 1, int(std::ceil(x + letter.width * column + half + 1))),
                  top = std::max(0, int(std::floor(foot - height - row - 1))),
                  bottom = std::min(frame.height - 1, int(std::ceil(foot + 2 * row + half + 1)));
        for (int py = top; py <= bottom; ++py) {
            for (int px = left; px <= right; ++px) {
                double nearest = half + 1;
                for (const InkedStroke& stroke : letter.strokes)
                    nearest = std::min(nearest, distanceTo(stroke, {px + 0.5, py + 0.5}));
                const double cover = std::clamp(half + 0.5 - nearest, 0.0, 1.0);
                if (cover > 0) inkPixel(frame, px, py, cover, color);
            }
        }
        x += (letter.width + gap) * column;
    }
}

}  // namespace scancast
