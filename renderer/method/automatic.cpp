#include "renderer/method/automatic.hpp"

namespace scancast {
namespace {

PassList passesOfChosen(const PassRequest& request) {
    const Method& chosen = *chooseMethod(request.cloud).method;
    const ParameterValues defaults = resolveParameters(chosen, {}).value_or(ParameterValues());
    return chosen.passes(
        {chosen, defaults, request.shading, request.cloud, request.detail, request.light, request.height});
}

}  // namespace

AutomaticChoice chooseMethod(const CloudTraits& cloud) {
    // Blended, what was photographed would lose its texture.
    if (cloud.colors)
        return {findMethod("paraboloid"), Shading::Unlit,
                "coloured points: paraboloids close the gaps and keep texture sharp"};
    if (cloud.surfels)
        return {findMethod("voronoi"), Shading::Phong,
                "surfels without colours: lit Voronoi cells show the shape, without seams"};
    return {findMethod("paraboloid"), Shading::EyeDome,
            "points without colours and surfels: paraboloids, darker where something stands before them, "
            "show the shape"};
}

Method automaticMethod() {
    Method m;
    m.name = automaticName;
    m.title = "Automatic";
    m.summary =
        "Chooses among the others by what the scan carries - the same from near and from afar -, and says in "
        "the frame's statistics which and why.";
    m.source = "this program's own comparison, docs/methods.md";
    m.passes = passesOfChosen;
    return m;
}

}  // namespace scancast
