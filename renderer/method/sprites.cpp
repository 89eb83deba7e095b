#include "renderer/method/sprites.hpp"

#include <algorithm>
#include <utility>

#include "renderer/method/parameters.hpp"

namespace scancast {
namespace {

constexpr auto paper = "High-Quality Point-Based Rendering Using Fast Single-Pass Interpolation, 2015";

}  // namespace

std::vector<Parameter> sizeParameters() {
    return {
        numberParameter("sizePx", 0, 0, 256, "px",
                        "Fixed size of every point on screen; 0 takes the size from the world."),
        numberParameter("scale", 1, 0.01, 100, "",
                        "Factor on the world radius of every point, where sizePx is 0."),
        numberParameter("minPx", 1, 0, 256, "px",
                        "Points never become smaller than this, where sizePx is 0."),
        numberParameter("maxPx", 50, 1, 256, "px",
                        "Points never become larger than this, where sizePx is 0."),
    };
}

namespace {

Parameter gainParameter() {
    return numberParameter(
        "gain", 2, 0, 16, "",
        "How far the border lies behind the centre, in world radii; more separates neighbours on steep "
        "surfaces, 0 gives a flat point.");
}

Parameter smoothParameter() {
    return booleanParameter("smooth", false,
                            "Blends neighbours across their border where a picture has one sample a pixel: "
                            "calmer while the camera moves.");
}

Parameter footprintParameter() {
    return choiceParameter("footprint", {"circle", "square"},
                           "Outline of a point on screen; squares close larger holes.");
}

}  // namespace

SplatSize sizeOf(const ParameterValues& values) {
    SplatSize size;
    size.sizePx = static_cast<float>(numberOf(values, "sizePx"));
    size.scale = static_cast<float>(numberOf(values, "scale"));
    size.minPx = static_cast<float>(numberOf(values, "minPx"));
    size.maxPx = std::max(static_cast<float>(numberOf(values, "maxPx")), size.minPx);
    return size;
}

namespace {

/// Every sprite is one `nearest`, its resolve, and what the shading adds.
PassList spritePasses(NearestPass nearest, const PassRequest& request) {
    ResolvePass resolve;
    // Several samples a pixel do so by themselves, and more exactly; both together would blur.
    if (const auto smooth = request.values.find("smooth"); smooth != request.values.end())
        resolve.smooth = std::get<bool>(smooth->second) && request.samples == 1;
    if (resolve.smooth) nearest.payload = Payload::Sample;
    if (request.shading == Shading::Phong) {
        nearest.payload = Payload::Sample;
        resolve.normals = true;
    }
    PassList list{nearest, resolve};
    addShading(request, list);
    return list;
}

template <Footprint footprint, Profile profile>
PassList passesOf(const PassRequest& request) {
    const ParameterValues& values = request.values;
    NearestPass pass;
    pass.footprint = footprint;
    pass.profile = profile;
    if constexpr (footprint == Footprint::Pixel) {
        pass.size.sizePx = 1;
    } else {
        pass.size = sizeOf(values);
    }
    pass.gain = 0;
    if constexpr (profile != Profile::Flat) pass.gain = static_cast<float>(numberOf(values, "gain"));
    if (const auto choice = values.find("footprint"); choice != values.end()) {
        if (std::get<std::string>(choice->second) == "square") pass.footprint = Footprint::Square;
    }
    return spritePasses(pass, request);
}

template <Footprint footprint, Profile profile>
Method sprite(std::string name, std::string title, std::string summary) {
    Method m;
    m.name = std::move(name);
    m.title = std::move(title);
    m.summary = std::move(summary);
    m.source = paper;
    m.passes = passesOf<footprint, profile>;
    if constexpr (footprint != Footprint::Pixel) m.parameters = sizeParameters();
    if constexpr (profile != Profile::Flat) m.parameters.push_back(gainParameter());
    if constexpr (profile == Profile::Paraboloid || profile == Profile::Cone) {
        m.parameters.push_back(footprintParameter());
    }
    if constexpr (profile == Profile::Paraboloid) m.parameters.push_back(smoothParameter());
    return m;
}

}  // namespace

std::vector<Method> spriteMethods() {
    using enum Footprint;
    return {
        sprite<Circle, Profile::Paraboloid>("paraboloid", "Paraboloids",
                                            "Closes holes and keeps lettering and edges sharp: neighbours "
                                            "meet half-way, along straight lines."),
        sprite<Circle, Profile::Cone>(
            "cone", "Cones",
            "As paraboloids, with pointed centres; borders between neighbours at different "
            "depths are curved."),
        sprite<Circle, Profile::Sphere>("sphere", "Spheres",
                                        "As paraboloids, round: points look like balls from close by."),
        sprite<Circle, Profile::Flat>("circle", "Circles",
                                      "Flat discs facing the viewer: the nearer one hides the other."),
        sprite<Square, Profile::Flat>("square", "Squares",
                                      "Flat squares facing the viewer, as most viewers draw points."),
        sprite<Pixel, Profile::Flat>("point", "Pixels",
                                     "One pixel a point: the fastest, and the scan as it is."),
    };
}

}  // namespace scancast
