// Letters for signs: strokes of even width (protocol/text/letter_strokes.hpp), sharp at any density of points.
#pragma once

#include <string_view>

namespace scancast {

/// Width of a line of text in units of its letter height.
double textWidth(std::string_view text);

/// Whether a place is inked. x runs along the line from its left end, y up from its foot, both in units of
/// the letter height. Of what is known small letters are drawn as capitals.
bool textInk(std::string_view text, double x, double y, double boldness = 1);

}  // namespace scancast
