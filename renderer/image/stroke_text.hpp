// Text in pictures that the server makes by itself: strokes of even width, smooth at their edges (protocol/text/letter_strokes.hpp). For
// legends; no font is needed for it. Pure functions; any thread; the same bytes everywhere.
#pragma once

#include <string_view>

#include "protocol/view/viewed_clouds.hpp"
#include "renderer/image/frame.hpp"

namespace scancast {

/// Of a line of UTF-8, px; `height`: of capitals. What has no strokes is drawn as '?'.
double strokeTextWidth(std::string_view text, double height);

/// What reaches beyond the frame is cut off. `x`: its left end; `foot`: the line that capitals stand on; px, from the upper left corner.
void drawStrokeText(Frame& frame, std::string_view text, double x, double foot, double height,
                    const Rgb8& color);

}  // namespace scancast
