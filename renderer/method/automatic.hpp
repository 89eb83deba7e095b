// `auto`: the method for a cloud and a view, chosen by what the samples carry and how far apart they are on
// screen. A pure function, so the same request gets the same picture; frames say what was chosen and why.
//
// The reasons, from the papers and from this program's own table (docs/methods.md):
//   samples at most 2 px apart     the picture is as fine as the screen: paraboloids, sharp and the fastest;
//   further apart, with surfels    gaps show: ellipses close and blend them;
//   without colours, with surfels  shape is all there is: lit discs, or lit ellipses where gaps show;
//   without colours and surfels    shape again, from depth alone: the pyramid, while gaps are small.
#pragma once

#include <string>
#include <string_view>

#include "renderer/method/method.hpp"

namespace scancast {

/// The method's name in requests.
inline constexpr std::string_view automaticName = "auto";

struct AutomaticChoice {
    const Method* method = nullptr;
    std::string reason;  ///< a sentence for people
};

/// `spacingPx`: typical distance of neighbouring samples on screen, as fine as the cloud has them; > 0.
AutomaticChoice chooseMethod(const CloudTraits& cloud, double spacingPx);

/// The entry among the methods: it takes no parameters, and its passes are those for a dense picture.
Method automaticMethod();

}  // namespace scancast
