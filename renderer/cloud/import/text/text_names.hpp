// The words by which programs call the columns of a text of points. Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "renderer/cloud/import/text/text_columns.hpp"

namespace scancast {

/// The names that stand in a line such as "//X,Y,Z,R,G,B", "# x y z" or "x;y;z;Intensity", as they are
/// written; empty when fewer than `axes` of x, y and z are among them.
std::vector<std::string> namesIn(std::string_view line, std::ptrdiff_t axes);

/// Gives the columns with a known name their place in the layout. Errors (without the file's name): Malformed
/// when x, y or z is missing, or when a word stands twice.
Expected<void> assignByNames(const std::vector<std::string>& names, TextLayout& layout);

}  // namespace scancast
