// What is true of several clouds that are shown together. Pure functions. Place: **facts** → together.
#pragma once

#include "renderer/together/together.hpp"

namespace scancast {

/// Its points have colours, be they all the same one.
bool hasColors(const CloudFacts& facts);

/// Of the members and their paints. Origin, CRS, scanner, stations and photos are the own cloud's (moved with it), even where that is hidden;
/// bounds, ranges and mirrors are all shown clouds'. What a method needs of every sample - surfels, normals, curvatures -
/// is there where all have it; what is only a colour, where one has it. The look is the own cloud's, and looks at all.
/// The revision is another whenever samples or places are.
CloudFacts factsTogether(const Together& together);

}  // namespace scancast
