// `scancast-client map`: a map of a cloud from straight above, by HTTP.
#include <algorithm>
#include <cstdio>

#include "client/cpp/program/command.hpp"
#include "client/cpp/program/picture_file.hpp"
#include "client/cpp/program/say.hpp"
#include "protocol/flags/view_flags.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast::client {
namespace {

struct MapFlags {
    CloudFlags cloud;
    ViewFlags view;
    std::string output, legend;
    MapArea area;
    std::vector<double> box;
    bool opaque = false;
};

/// A map has its size, and no camera.
bool isOfMaps(const ViewWord& word) {
    return !word.path.starts_with("camera.") && word.word != "width" && word.word != "height";
}

Expected<void> run(const MapFlags& flags) {
    const auto format = pictureFormatOf(flags.output);  // sound: the flag's check has said so
    if (!format) return passOn(format);
    const auto words = flags.view.words();
    if (!words) return passOn(words);
    const auto cloud = flags.cloud.choose();
    if (!cloud) return passOn(cloud);
    MapArea area = flags.area;
    std::copy_n(flags.box.begin(), area.box.size(), area.box.begin());
    area.transparent = !flags.opaque;
    const auto map = cloud->server.map(cloud->id, area, *words, *format);
    if (!map) return passOn(map);
    if (auto ok = writeFile(flags.output, map->bytes); !ok) return ok;
    sayOn(stdout, "%s: %zu bytes of %s, ETag %s\n", flags.output.c_str(), map->bytes.size(),
          cloud->id.c_str(), map->etag.c_str());
    if (flags.legend.empty()) return {};
    const auto legendFormat = pictureFormatOf(flags.legend);
    if (!legendFormat) return passOn(legendFormat);
    const auto legend = cloud->server.legend(cloud->id, *words, *legendFormat);
    if (!legend) return passOn(legend);
    if (auto ok = writeFile(flags.legend, legend->bytes); !ok) return ok;
    sayOn(stdout, "%s: %zu bytes, what the colours of %s mean\n", flags.legend.c_str(), legend->bytes.size(),
          flags.output.c_str());
    return {};
}

}  // namespace

void addMap(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<MapFlags>();
    auto& command =
        *app.add_subcommand("map", "Fetch a map: the cloud from straight above, in any coordinates");
    flags->cloud.addTo(command);
    addPictureFile(command, "-o,--output", flags->output,
                   "The map to write: JPEG or PNG, by the ending of its name")
        ->required();
    command
        .add_option("--crs", flags->area.crs,
                    "What the map is in: file, the cloud's own coordinates, EPSG:3857, CRS:84, or the number "
                    "that the cloud's have")
        ->type_name("CRS")
        ->capture_default_str();
    command.add_option("--bbox", flags->box, "Its left, lower, right and upper edge")
        ->type_name("X,Y,X,Y")
        ->delimiter(',')
        ->expected(4)
        ->required();
    command.add_option("--width", flags->area.width, "Pixels from left to right")
        ->type_name("PIXELS")
        ->check(CLI::Range(1, maxPictureSide))
        ->required();
    command.add_option("--height", flags->area.height, "Pixels from top to bottom")
        ->type_name("PIXELS")
        ->check(CLI::Range(1, maxPictureSide))
        ->required();
    command.add_flag("--opaque", flags->opaque, "White where no point is; else transparent, of a PNG");
    addPictureFile(command, "--legend", flags->legend,
                   "Where to write what its colours mean, as another picture");
    flags->view.addTo(command, isOfMaps);
    command.footer(
        "Method, colours, what is cut away and the like are words of a view. Example:\n"
        "  scancast-client map http://127.0.0.1:8080/ town --bbox 389400,5819700,389600,5819900 "
        "--width 1000 --height 1000 --color elevation -o town.png");
    command.callback([flags, &exitCode] { exitCode = report(run(*flags)); });
}

}  // namespace scancast::client
