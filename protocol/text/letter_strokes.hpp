// Letters as strokes, from a small built-in table: what signs in simulated scenes and legends of maps are written with. Pure function; any
// thread. Place: **letters** → simulator/scenes/glyphs.hpp, renderer/image/stroke_text.hpp.
#pragma once

#include <string_view>

namespace scancast {

/// Rows of the lattice that strokes run on: feet stand on 0, capitals reach up to it, small letters to 4, tails down to -2. Columns: 0 to 4.
inline constexpr int letterRows = 6;

/// Strokes of a character: runs of lattice points, each a column and a row from below - as '0' and so much more, or two less -, separated by
/// blanks. ASCII and ° ² ³ µ × are known; others, blanks among them, have none.
std::string_view letterStrokes(char32_t letter);

}  // namespace scancast
