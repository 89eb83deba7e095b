#include "protocol/flags/region_flags.hpp"

#include <utility>

namespace scancast {

void RegionFlags::addTo(CLI::App& app) {
    app.add_option("--clip,--box", clip,
                   "Only points inside this box, its faces included, in the file's coordinates")
        ->type_name("X0,Y0,Z0,X1,Y1,Z1");
    app.add_option("--clips", clips,
                   "Only points that these shapes leave, up to eight: "
                   "box:CX,CY,CZ,SX,SY,SZ[,YAW[,PITCH,ROLL]], -box:... for what is outside, "
                   "plane:PX,PY,PZ,NX,NY,NZ for the side that its normal points to")
        ->type_name("SHAPE;SHAPE;...");
    app.add_option("--polygon", polygon,
                   "Only points inside this polygon in plan, corner by corner; what it goes round twice is "
                   "outside")
        ->type_name("X,Y;X,Y;X,Y;...");
    app.add_option("--z", z, "Only points between these heights, both included")->type_name("LOW,HIGH");
    app.add_option("--classes", classes, "Only these classifications: 2,6")->type_name("N,N,...");
    app.add_option(
           "--filter", filter,
           "Only points whose values of a kept column, of intensity or of classification lie in these "
           "ranges, up to four, their ends included: return_number:1..1;gps_time:3600..")
        ->type_name("NAME:LOW..HIGH;...");
}

Expected<PointsRegion> RegionFlags::region() const {
    PointsRegion region;
    for (const auto& [word, text] : {std::pair("clip", &clip), std::pair("clips", &clips),
                                     std::pair("classes", &classes), std::pair("filter", &filter)})
        if (!text->empty())
            if (auto ok = applyRegionWord(region, word, *text); !ok) return passOn(ok);
    if (!polygon.empty()) {
        auto corners = parsePlanPlaces(polygon, "polygon");
        if (!corners) return passOn(corners);
        if (auto ok = checkPolygon(*corners); !ok) return passOn(ok);
        region.polygon = std::move(*corners);
    }
    if (!z.empty()) {
        const auto heights = parseHeights(z);
        if (!heights) return passOn(heights);
        region.z = *heights;
    }
    return region;
}

}  // namespace scancast
