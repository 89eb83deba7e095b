#include "renderer/method/hqs.hpp"

#include "renderer/method/parameters.hpp"
#include "renderer/method/sprites.hpp"

namespace scancast {
namespace {

PassList hqsPasses(const PassRequest& request) {
    Splat splat;
    splat.footprint = Footprint::Circle;
    splat.profile = Profile::Flat;
    splat.size = sizeOf(request.values);
    splat.gain = 0;
    const bool normals = request.shading == Shading::Phong;
    NearestPass nearest{splat};
    SumPass sum{splat};
    sum.normals = normals;
    ResolvePass resolve;
    resolve.sums = true;
    resolve.normals = normals;
    PassList list{nearest, sum, resolve};
    addShading(request, list);
    return list;
}

}  // namespace

Method hqsMethod() {
    Method m;
    m.name = "hqs";
    m.title = "Blended circles";
    m.summary =
        "Neighbouring points are blended into each other: removes the noise of colours, and softens "
        "lettering "
        "and edges.";
    m.source =
        "High-Quality Point-Based Rendering Using Fast Single-Pass Interpolation, 2015, its comparator";
    m.parameters = sizeParameters();
    m.defaultDetail = 2;
    m.passes = hqsPasses;
    return m;
}

}  // namespace scancast
