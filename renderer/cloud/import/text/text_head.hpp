// The lines before the first point of a text: comments, names of columns, a count. And whether a text holds
// points at all. Pure functions.
// Pipeline: bytes → lines → **head** → columns → rows → points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

struct TextHead {
    std::vector<std::string> names;      ///< of columns, by a header line or a comment; empty = there is none
    std::optional<std::uint64_t> count;  ///< a line with nothing but a whole number: points to come
    std::uint64_t lines = 0;             ///< lines before the first point
    std::uint64_t namesLine = 0;         ///< number of the line with the names
    bool namesInComment = false;
    std::size_t bytes = 0;  ///< where the first point's line begins
};

/// `start`: the beginning of the text. `name` is what messages call the file. Errors: Malformed for a first
/// line that is neither a comment, nor a count, nor names with x, y and z among them, nor numbers; Empty.
Expected<TextHead> readTextHead(std::string_view start, char lineEnd, const std::string& name);

/// Could these first bytes be a text of points? A third of the lines that are no comments have three numbers
/// or more.
bool looksLikePoints(std::string_view start);

/// Could they be a PTX? Columns, rows, then four lines of three numbers and four of four.
bool looksLikePtx(std::string_view start);

/// A line that is nothing but one whole number.
std::optional<std::uint64_t> countIn(std::string_view line);

/// The text up to the first end of line, which is taken off `text` with it; a \r before it belongs to
/// neither.
std::string_view takeLine(std::string_view& text, char lineEnd);

}  // namespace scancast
