#include "client/cpp/program/points/points_flags.hpp"

#include <cstdio>

#include "client/cpp/program/say.hpp"

namespace scancast::client {

void RegionFlags::addTo(CLI::App& app) {
    app.add_option("--clip", clip, "Only points inside this box, its faces included, in the file's coordinates")
        ->type_name("X0,Y0,Z0,X1,Y1,Z1");
    app.add_option("--clips", clips,
                   "Only points that these shapes leave, up to eight: box:CX,CY,CZ,SX,SY,SZ[,YAW[,PITCH,ROLL]], "
                   "-box:... for what is outside, plane:PX,PY,PZ,NX,NY,NZ")
        ->type_name("SHAPE;SHAPE;...");
    app.add_option("--polygon", polygon,
                   "Only points inside this polygon in plan, corner by corner; what it goes round twice is "
                   "outside")
        ->type_name("X,Y;X,Y;X,Y;...");
    app.add_option("--z", z, "Only points between these heights, both included")->type_name("LOW,HIGH");
    app.add_option("--classes", classes, "Only these classifications: 2,6")->type_name("N,N,...");
}

Expected<PointsRegion> RegionFlags::region() const {
    PointsRegion region;
    for (const auto& [word, text] : {std::pair("clip", &clip), std::pair("clips", &clips),
                                     std::pair("classes", &classes)})
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

Expected<std::optional<PointsFormat>> formatOfPoints(const std::string& given, const std::string& output) {
    std::string word = given;
    if (word.empty()) {
        const auto dot = output.rfind('.');
        if (dot != std::string::npos) word = output.substr(dot + 1);
        for (char& c : word)
            if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
        if (word == "xyz") word = "txt";
    }
    if (word == "png") return std::optional<PointsFormat>();
    if (const auto format = pointsFormatOf(word)) return std::optional(*format);
    if (word == "laz")
        return fail(ErrorCode::Unsupported,
                    output + ": servers do not write LAZ. Ask for LAS, and compress it: pdal translate out.las out.laz");
    return fail(ErrorCode::InvalidArgument,
                "the name " + output + " does not tell the format; end it in .las, .ply, .csv, .txt or .xyz, or give "
                                       "--format");
}

TakeBytes into(OutputFile& file) {
    return [&file](std::span<const std::byte> bytes) { return file.write(bytes); };
}

void tellOfPoints(const std::string& output, const PointsAnswer& answer) {
    const std::string points = answer.points ? std::to_string(*answer.points) + " points, " : "";
    sayOn(stderr, "%s: %s%llu bytes\n", output == "-" ? "standard output" : output.c_str(), points.c_str(),
          static_cast<unsigned long long>(answer.bytes));
    for (const std::string& loss : answer.losses) sayOn(stderr, "Not as the scan was: %s.\n", loss.c_str());
}

}  // namespace scancast::client
