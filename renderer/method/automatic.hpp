// `auto`: the method for a cloud, chosen by what its samples carry. A pure function of the cloud, so that it looks
// the same from near and from afar, moving and at rest; frames say what was chosen and why.
//
// The reasons (docs/methods.md compares the methods):
//   colours                        texture is what people look at: paraboloids keep it sharp, and are the fastest;
//   no colours, but surfels        shape is all there is: lit Voronoi cells, without seams from near, without rims;
//   neither                        shape again, from depth alone: paraboloids with eye-dome lighting.
#pragma once

#include <string>
#include <string_view>

#include "renderer/method/method.hpp"

namespace scancast {

/// The method's name in requests.
inline constexpr std::string_view automaticName = "auto";

struct AutomaticChoice {
    const Method* method = nullptr;
    Shading shading = Shading::Unlit;  ///< unless view or look say another
    std::string reason;                ///< a sentence for people
};

AutomaticChoice chooseMethod(const CloudTraits& cloud);

/// The entry among the methods: it takes no parameters, and its passes are those of the chosen one.
Method automaticMethod();

}  // namespace scancast
