// `scancast-client points`: the points of a server's cloud, or of a part of it, as a file that other programs read.
#include "client/cpp/program/command.hpp"
#include "client/cpp/program/points/points_flags.hpp"
#include "protocol/flags/region_flags.hpp"

namespace scancast::client {
namespace {

struct PointsFlags {
    CloudFlags cloud;
    RegionFlags region;
    std::string output, format;
    bool normals = false;
};

Expected<void> run(const PointsFlags& flags) {
    const auto format = formatOfPoints(flags.format, flags.output);
    if (!format) return passOn(format);
    if (!*format)
        return fail(ErrorCode::InvalidArgument, "points are no picture; scancast-client snapshot draws one");
    auto region = flags.region.region();
    if (!region) return passOn(region);
    const auto cloud = flags.cloud.choose();
    if (!cloud) return passOn(cloud);
    auto file = OutputFile::create(flags.output);
    if (!file) return passOn(file);
    const PointsRequest request{**format, std::move(*region), flags.normals};
    const auto answer = cloud->server.points(cloud->id, request, into(*file));
    if (!answer) return passOn(answer);
    if (auto ok = file->finish(); !ok) return ok;
    tellOfPoints(flags.output, *answer);
    return {};
}

}  // namespace

void addPoints(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<PointsFlags>();
    auto& command = *app.add_subcommand("points", "Fetch the points of a cloud, or of a part of it");
    flags->cloud.addTo(command);
    command
        .add_option("-o,--output", flags->output,
                    "The file to write: LAS (.las), PLY (.ply), CSV (.csv) or text (.txt, .xyz); - for "
                    "standard output")
        ->type_name("FILE")
        ->required();
    command.add_option("--format", flags->format, "Default: what the file's name says")
        ->check(CLI::IsMember({"las", "ply", "csv", "txt"}))
        ->type_name("las|ply|csv|txt");
    flags->region.addTo(command);
    command.add_flag("--normals", flags->normals,
                     "Also the normals that were estimated; a scan's own always come");
    command.footer(
        "Every point comes once, exactly as the server's cloud file has it; what that has not kept is said "
        "at the "
        "end. The file is there when it is whole, or not at all.\n"
        "Examples:\n"
        "  scancast-client points http://127.0.0.1:8080/ -o town.las\n"
        "  scancast-client points http://127.0.0.1:8080/ town --classes 6 --clip "
        "389400,5819700,40,389500,5819800,90 -o roofs.ply\n"
        "  scancast-client points http://127.0.0.1:8080/ --polygon "
        "'389400,5819700;389500,5819720;389480,5819800' "
        "--format csv -o - | head");
    command.callback([flags, &exitCode] { exitCode = report(run(*flags)); });
}

}  // namespace scancast::client
