// Values of a view as text, where JSON and words spell them alike: names of choices, colours, backgrounds.
//
// Inside the protocol room only. Pure functions; any thread. Errors are sentences without a path: the caller
// knows it.
#pragma once

#include <string>
#include <string_view>

#include "protocol/view.hpp"

namespace scancast::values {

/// Each returns what the text says, or a sentence on what it should say.
template <class T>
using Parsed = tl::expected<T, std::string>;

Parsed<Projection> projection(std::string_view text);
Parsed<Shading> shading(std::string_view text);
Parsed<Subsampling> subsampling(std::string_view text);
Parsed<std::string> colormap(std::string_view text);

/// "#rrggbb", or without the hash, which URLs and shells make awkward.
Parsed<Rgb8> rgb(std::string_view text);
std::string print(Rgb8 color);

struct Color {
    ColorSource source = ColorSource::Rgb;
    Rgb8 flat{255, 255, 255};  ///< Flat only
};
/// A colour source's name, or one colour for everything.
Parsed<Color> color(std::string_view text);

/// "transparent", one colour, or "TOP,BOTTOM".
Parsed<Background> background(std::string_view text);

}  // namespace scancast::values
