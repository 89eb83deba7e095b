// Files that people have beside their scans, or take for them, and that Scancast does not read: what each is, and how to come
// from it to something that is read. Pure functions on bytes and names from outside.
// Pipeline: file → **foreign?** → format → reader.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace scancast {

/// One kind of file, in words that make a sentence: "it is `what`: `wayOut`".
struct ForeignFormat {
    std::string_view what;    ///< "a glTF model"
    std::string_view wayOut;  ///< "convert it to PLY, for example …"
};

/// By the first bytes of a file (scan_format.hpp says how many), which are never those of a format that is read. What
/// several programs use for different things - ZIP, gzip, OLE - is told apart by the name: `extension` as in ".slpk",
/// lower case. nullptr = nothing known.
const ForeignFormat* foreignByContent(std::string_view start, std::string_view extension);
/// By the name alone, for content that says nothing.
const ForeignFormat* foreignByName(std::string_view extension);

/// "it is a glTF model: convert …", the end of a sentence.
std::string sentence(const ForeignFormat& format);

/// All of them, once each: for the documentation and its test.
std::span<const ForeignFormat* const> foreignFormats();

}  // namespace scancast
