#include "renderer/method/automatic.hpp"

#include <cstdio>

namespace scancast {
namespace {

/// Up to here, samples leave no gaps that splats of their size would show, px.
constexpr double densePx = 2;
/// Up to here, depth alone tells a surface from what lies behind it, px.
constexpr double pyramidPx = 8;

std::string sentence(const char* has, double spacingPx, const char* therefore) {
    char text[160];
    std::snprintf(text, sizeof text, "%s, about %.1f px apart: %s", has, spacingPx, therefore);
    return text;
}

PassList passesOfChosen(const PassRequest& request) {
    const Method& chosen = *chooseMethod(request.cloud, 1).method;
    const ParameterValues defaults = resolveParameters(chosen, {}).value_or(ParameterValues());
    return chosen.passes(
        {chosen, defaults, request.shading, request.cloud, request.detail, request.light, request.height});
}

}  // namespace

AutomaticChoice chooseMethod(const CloudTraits& cloud, double spacingPx) {
    const bool dense = spacingPx <= densePx;
    // Near and far alike: blended, what was photographed would lose its texture, and a change would be seen.
    if (cloud.colors)
        return {findMethod("paraboloid"),
                sentence("coloured points", spacingPx, "paraboloids close the gaps and keep texture sharp")};
    if (cloud.surfels && dense)
        return {findMethod("disc"),
                sentence("points without colours", spacingPx, "lit discs show the shape")};
    if (cloud.surfels)
        return {findMethod("ewa"), sentence("surfels", spacingPx, "ellipses close the gaps and blend them")};
    if (spacingPx <= pyramidPx)
        return {findMethod("pyramid"), sentence("points without colours and surfels", spacingPx,
                                                "normals from depth show the shape")};
    return {findMethod("paraboloid"),
            sentence("points without surfels", spacingPx, "paraboloids close the gaps")};
}

Method automaticMethod() {
    Method m;
    m.name = automaticName;
    m.title = "Automatic";
    m.summary =
        "Chooses among the others by what the scan carries and how dense it is on screen, and says in the "
        "frame's statistics which and why.";
    m.source = "this program's own comparison, docs/methods.md";
    m.passes = passesOfChosen;
    return m;
}

}  // namespace scancast
