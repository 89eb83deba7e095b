#include "renderer/method/surfels.hpp"

#include "renderer/method/parameters.hpp"

namespace scancast {

std::vector<Parameter> surfelParameters() {
    return {
        numberParameter("scale", 1, 0.01, 100, "",
                        "Factor on the radius of every surfel; more closes holes, less shows them."),
        numberParameter("maxPx", 256, 1, 1024, "px", "Surfels never become larger than this."),
        booleanParameter("cull", true,
                         "Leave out surfels that face away from the viewer, where the scan knows which side "
                         "is the front."),
    };
}

Splat surfelSplat(Footprint footprint, const ParameterValues& values) {
    Splat splat;
    splat.footprint = footprint;
    splat.profile = Profile::Flat;
    splat.gain = 0;
    splat.size.scale = static_cast<float>(numberOf(values, "scale"));
    splat.size.maxPx = static_cast<float>(numberOf(values, "maxPx"));
    splat.facing = booleanOf(values, "cull") ? Facing::Front : Facing::Any;
    return splat;
}

namespace {

/// Where ellipses are blended, facets hardly show, and what noise leaves of curvatures costs more than it gains
/// (docs/spec/surfels.md §12).
Parameter curvedParameter(bool value) {
    return booleanParameter(
        "curved", value,
        "Light surfels as bent as their surface is, where the cloud knows curvatures; off lights each "
        "as flat.");
}

PassList discPasses(const PassRequest& request) {
    NearestPass nearest{surfelSplat(Footprint::Disc, request.values)};
    ResolvePass resolve;
    resolve.normals = request.shading == Shading::Phong;
    resolve.curved = booleanOf(request.values, "curved");
    if (resolve.normals) nearest.payload = Payload::Sample;
    PassList list{nearest, resolve};
    addShading(request, list);
    return list;
}

PassList ewaPasses(const PassRequest& request) {
    Splat splat = surfelSplat(Footprint::Ellipse, request.values);
    splat.lowPassPx = static_cast<float>(numberOf(request.values, "lowPass"));
    splat.round = choiceOf(request.values, "shape") == "circle";
    NearestPass nearest{splat};
    SumPass sum{splat};
    ResolvePass resolve;
    resolve.sums = true;
    sum.normals = resolve.normals = request.shading == Shading::Phong;
    sum.curved = booleanOf(request.values, "curved");
    PassList list{nearest, sum, resolve};
    addShading(request, list);
    return list;
}

}  // namespace

Method discMethod() {
    Method m;
    m.name = "disc";
    m.title = "Oriented discs";
    m.summary =
        "A disc in the surface for every point: closed surfaces with true slopes and lighting, in one pass.";
    m.source = "Point-based Rendering: normal detection, splatting and mirrors";
    m.parameters = surfelParameters();
    m.parameters.push_back(curvedParameter(true));
    m.defaultDetail = 2;
    m.defaultShading = Shading::Phong;
    m.needs = Needs::Surfels;
    m.passes = discPasses;
    return m;
}

Method ewaMethod() {
    Method m;
    m.name = "ewa";
    m.title = "Blended ellipses";
    m.summary =
        "Ellipses that follow edges, blended and filtered for the screen: the smoothest surfaces, and no "
        "flicker of distant textures.";
    m.source =
        "Achieving a Smooth Interpolation between the Points Using Modified Rendering Algorithm; Surface "
        "Splatting, 2001";
    m.parameters = surfelParameters();
    m.parameters.push_back(numberParameter(
        "lowPass", 0.5, 0, 4, "px",
        "Standard deviation of the filter over the screen; more blurs, 0 lets distant textures alias."));
    m.parameters.push_back(choiceParameter(
        "shape", {"ellipse", "circle"},
        "Outline of a surfel in its surface; circles of the larger half-axis, what ellipses were made to "
        "improve on, hang over edges and corners."));
    m.parameters.push_back(curvedParameter(false));
    m.defaultDetail = 2;
    m.defaultShading = Shading::Phong;
    m.needs = Needs::Surfels;
    m.passes = ewaPasses;
    return m;
}

}  // namespace scancast
