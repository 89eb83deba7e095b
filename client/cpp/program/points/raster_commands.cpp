// `scancast-client dem` and `scancast-client ortho`: a cloud in plan as a GeoTIFF, made by the server.
#include <cstdio>

#include "client/cpp/program/command.hpp"
#include "client/cpp/program/points/points_flags.hpp"
#include "client/cpp/program/say.hpp"
#include "protocol/flags/raster_flags.hpp"

namespace scancast::client {
namespace {

struct RasterCommand {
    explicit RasterCommand(RasterKind kind) : words(kind) {}
    CloudFlags cloud;
    RasterFlags words;
    std::string output;
};

Expected<void> runRaster(const RasterCommand& flags) {
    const auto request = flags.words.request();
    if (!request) return passOn(request);
    const auto cloud = flags.cloud.choose();
    if (!cloud) return passOn(cloud);
    auto file = OutputFile::create(flags.output);
    if (!file) return passOn(file);
    const auto facts = cloud->server.raster(cloud->id, *request, into(*file));
    if (!facts) return passOn(facts);
    if (auto ok = file->finish(); !ok) return ok;
    sayOn(stderr, "%s: %llu x %llu cells of %g from x %.12g, y %.12g, %llu bytes\n",
          flags.output == "-" ? "standard output" : flags.output.c_str(),
          static_cast<unsigned long long>(facts->columns), static_cast<unsigned long long>(facts->rows),
          facts->cell, facts->left, facts->top, static_cast<unsigned long long>(facts->bytes));
    return {};
}

void addRaster(CLI::App& app, int& exitCode, RasterKind kind, const char* name, const char* what,
               const char* footer) {
    const auto flags = std::make_shared<RasterCommand>(kind);
    auto& command = *app.add_subcommand(name, what);
    flags->cloud.addTo(command);
    command.add_option("-o,--output", flags->output, "The GeoTIFF to write; - for standard output")
        ->type_name("FILE.tif")
        ->required();
    flags->words.addTo(command);
    command.footer(footer);
    command.callback([flags, &exitCode] { exitCode = report(runRaster(*flags)); });
}

}  // namespace

void addRasters(CLI::App& app, int& exitCode) {
    addRaster(app, exitCode, RasterKind::Elevation, "dem", "Fetch elevations in plan, as a GeoTIFF",
              "The file is there when it is whole, or not at all. Packed (the default), it comes when the "
              "server has all of it.\n"
              "Examples:\n"
              "  scancast-client dem http://127.0.0.1:8080/ --cell 0.5 -o town.tif\n"
              "  scancast-client dem http://127.0.0.1:8080/ town --classes 2 --value mean --fill 4 "
              "-o ground.tif\n");
    addRaster(app, exitCode, RasterKind::Orthophoto, "ortho", "Fetch an orthophoto, as a GeoTIFF",
              "Drawn from straight above, by any method and in any colour; transparent where nothing is.\n"
              "Examples:\n"
              "  scancast-client ortho http://127.0.0.1:8080/ --cell 0.1 -o town.tif\n"
              "  scancast-client ortho http://127.0.0.1:8080/ town --bbox "
              "389400,5819700,389500,5819800 --color "
              "elevation -o part.tif\n");
}

}  // namespace scancast::client
