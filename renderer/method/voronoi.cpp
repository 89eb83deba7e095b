#include "renderer/method/voronoi.hpp"

#include "renderer/method/parameters.hpp"
#include "renderer/method/surfels.hpp"

namespace scancast {
namespace {

PassList voronoiPasses(const PassRequest& request) {
    const Splat splat = surfelSplat(Footprint::Disc, request.values);
    const bool lit = request.shading == Shading::Phong;
    PassList list;
    if (booleanOf(request.values, "silhouette")) {
        SilhouettePass silhouette{splat};
        silhouette.facing = Facing::Back;
        list.push_back(silhouette);
    }
    NearestPass nearest{splat};
    nearest.payload = Payload::Sample;
    list.push_back(nearest);
    CellPass cell{splat};
    cell.tolerance = static_cast<float>(numberOf(request.values, "tolerance"));
    list.push_back(cell);
    ResolvePass resolve;
    resolve.normals = lit;
    resolve.sums = booleanOf(request.values, "smooth");
    if (resolve.sums) {
        SumPass sum{splat};
        sum.normals = lit;
        list.push_back(sum);
    }
    list.push_back(resolve);
    addShading(request, list);
    return list;
}

}  // namespace

Method voronoiMethod() {
    Method m;
    m.name = "voronoi";
    m.title = "Voronoi cells";
    m.summary =
        "Discs cut where they meet, each point its own cell of the surface: sharp creases, also where points "
        "are sparse; smooth or faceted.";
    m.source = "Voronoi Rasterization of Sparse Point Sets, 2005";
    m.parameters = surfelParameters();
    m.parameters.push_back(booleanParameter(
        "smooth", true, "Blend colours and normals between the cells; off shows every cell in its own."));
    m.parameters.push_back(numberParameter(
        "tolerance", 1, 0.05, 4, "",
        "How far from the visible surface a disc still takes part, in its radii; less separates thin sheets, "
        "more closes cracks."));
    m.parameters.push_back(booleanParameter("silhouette", false,
                                            "Clip the scalloped outline by discs that face away; refused "
                                            "where no surface knows its front side."));
    m.defaultDetail = 2;
    m.defaultShading = Shading::Phong;
    m.needs = Needs::Surfels;
    m.passes = voronoiPasses;
    return m;
}

}  // namespace scancast
