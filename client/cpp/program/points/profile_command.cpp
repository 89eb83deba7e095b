// `scancast-client profile`: the points of a corridor along a line, with their stations and offsets, or a picture of it.
#include <cstdio>

#include "client/cpp/program/command.hpp"
#include "client/cpp/program/points/points_flags.hpp"
#include "client/cpp/program/say.hpp"
#include "protocol/flags/region_flags.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast::client {
namespace {

struct ProfileFlags {
    CloudFlags cloud;
    RegionFlags region;
    std::string output, format, line, color, colormap, background;
    double width = 1, exaggeration = 0;
    int pictureWidth = 1600, pictureHeight = 0, pointSize = 0;
    bool normals = false;
};

Expected<ProfileRequest> requestOf(const ProfileFlags& flags) {
    ProfileRequest request;
    const auto format = formatOfPoints(flags.format, flags.output);
    if (!format) return passOn(format);
    request.format = *format;
    auto line = parsePlanPlaces(flags.line, "line");
    if (!line) return passOn(line);
    request.line = std::move(*line);
    request.width = flags.width;
    if (auto ok = checkLine(request.line, request.width); !ok) return passOn(ok);
    auto region = flags.region.region();
    if (!region) return passOn(region);
    request.region = std::move(*region);
    request.estimatedNormals = flags.normals;
    request.picture.width = flags.pictureWidth;
    if (flags.pictureHeight > 0) request.picture.height = flags.pictureHeight;
    if (flags.exaggeration > 0) request.picture.exaggeration = flags.exaggeration;
    if (flags.pointSize > 0) request.picture.pointSize = flags.pointSize;
    View view;
    for (const auto& [word, text] : {std::pair("color", &flags.color), std::pair("colormap", &flags.colormap),
                                     std::pair("background", &flags.background)})
        if (!text->empty())
            if (auto ok = applyWord(view, word, *text); !ok) return passOn(ok);
    request.picture.style = view.style;
    return request;
}

Expected<void> run(const ProfileFlags& flags) {
    const auto request = requestOf(flags);
    if (!request) return passOn(request);
    const auto cloud = flags.cloud.choose();
    if (!cloud) return passOn(cloud);
    auto file = OutputFile::create(flags.output);
    if (!file) return passOn(file);
    if (!request->format) {
        const auto facts = cloud->server.profilePicture(cloud->id, *request, into(*file));
        if (!facts) return passOn(facts);
        if (auto ok = file->finish(); !ok) return ok;
        sayOn(stderr, "%s: %llu points, station %g to %g, height %g to %g\n",
              flags.output == "-" ? "standard output" : flags.output.c_str(),
              static_cast<unsigned long long>(facts->points), facts->left, facts->right, facts->bottom,
              facts->top);
        return {};
    }
    const auto answer = cloud->server.profile(cloud->id, *request, into(*file));
    if (!answer) return passOn(answer);
    if (auto ok = file->finish(); !ok) return ok;
    tellOfPoints(flags.output, *answer);
    return {};
}

void addPictureFlags(CLI::App& command, ProfileFlags& flags) {
    command.add_option("--picture-width", flags.pictureWidth, "Of the picture, px")
        ->check(CLI::Range(1, mostProfileSide))
        ->type_name("PX")
        ->capture_default_str();
    command.add_option("--picture-height", flags.pictureHeight, "The same; default: what the heights take")
        ->check(CLI::Range(1, mostProfileSide))
        ->type_name("PX");
    command
        .add_option("--exaggeration", flags.exaggeration,
                    "Heights are drawn so many times as large as stations. Default: 1, or what fills the "
                    "picture's height")
        ->check(CLI::Range(0.001, 1000.0))
        ->type_name("TIMES");
    command
        .add_option("--point-size", flags.pointSize,
                    "Side of a point's square, px. Default: 1, or as far as points lie apart, 8 at the most")
        ->check(CLI::Range(1, mostProfilePointSize))
        ->type_name("PX");
    for (const auto& [word, to] : {std::pair("color", &flags.color), std::pair("colormap", &flags.colormap),
                                   std::pair("background", &flags.background)})
        command.add_option("--" + std::string(word), *to, "Of the picture, as for snapshot")
            ->type_name("WORD");
}

}  // namespace

void addProfile(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<ProfileFlags>();
    auto& command =
        *app.add_subcommand("profile", "Fetch the points along a line in plan, or a picture of them");
    flags->cloud.addTo(command);
    command.add_option("--line", flags->line, "Corners of the line, in the file's coordinates")
        ->type_name("X,Y;X,Y;...")
        ->required();
    command.add_option("--width", flags->width, "Of the corridor around it: half of it to either side")
        ->type_name("LENGTH")
        ->capture_default_str();
    command
        .add_option("-o,--output", flags->output,
                    "The file to write: CSV (.csv), PLY (.ply), LAS (.las) or text (.txt, .xyz) of points, "
                    "or a picture "
                    "(.png); - for standard output")
        ->type_name("FILE")
        ->required();
    command.add_option("--format", flags->format, "Default: what the file's name says")
        ->check(CLI::IsMember({"las", "ply", "csv", "txt", "png"}))
        ->type_name("las|ply|csv|txt|png");
    flags->region.addTo(command);
    command.add_flag("--normals", flags->normals,
                     "Also the normals that were estimated; a scan's own always come");
    addPictureFlags(command, *flags);
    command.footer(
        "All points of the corridor come, however many there are, each with its distance along the line "
        "(station) and "
        "from it (offset, positive to its right), in the order of the server's cloud file.\n"
        "Examples:\n"
        "  scancast-client profile http://127.0.0.1:8080/ --line '389400,5819700;389500,5819800' --width 0.5 "
        "-o street.csv\n"
        "  scancast-client profile http://127.0.0.1:8080/ town --line "
        "'389400,5819700;389500,5819800' "
        "--exaggeration 2 --color classification -o street.png");
    command.callback([flags, &exitCode] { exitCode = report(run(*flags)); });
}

}  // namespace scancast::client
