// `scancast-client lonlat`: where in the world a cloud's places are, by HTTP.
#include <charconv>
#include <cmath>
#include <cstdio>

#include "client/cpp/program/command.hpp"
#include "client/cpp/program/say.hpp"

namespace scancast::client {
namespace {

struct LonLatFlags {
    CloudFlags cloud;
    std::string to = "lonlat";
    std::vector<std::string> points;
};

/// "13.4,52.5", and a height, which has no part in it; nullopt: it is none.
std::optional<glm::dvec2> placeIn(const std::string& text) {
    double numbers[3] = {};
    const char* at = text.data();
    const char* const end = at + text.size();
    for (int i = 0; i < 3; ++i) {
        const auto [next, wrong] = std::from_chars(at, end, numbers[i]);
        if (wrong != std::errc() || !std::isfinite(numbers[i])) return std::nullopt;
        if (next == end) return i > 0 ? std::optional(glm::dvec2(numbers[0], numbers[1])) : std::nullopt;
        if (*next != ',') return std::nullopt;
        at = next + 1;
    }
    return std::nullopt;
}

Expected<void> run(const LonLatFlags& flags) {
    LonLatRequest request;
    request.toFile = flags.to == "file";
    for (const std::string& point : flags.points)
        if (const auto place = placeIn(point)) request.points.push_back(*place);
    const auto cloud = flags.cloud.choose();
    if (!cloud) return passOn(cloud);
    const auto places = cloud->server.lonLat(cloud->id, request);
    if (!places) return passOn(places);
    for (const auto& place : *places) {
        if (place)
            sayOn(stdout, "%.*f,%.*f\n", request.toFile ? 4 : 9, place->x, request.toFile ? 4 : 9, place->y);
        else
            sayOn(stdout, "nowhere\n");
    }
    return {};
}

}  // namespace

void addLonLat(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<LonLatFlags>();
    auto& command =
        *app.add_subcommand("lonlat", "Tell longitudes and latitudes of places, or the other way round");
    flags->cloud.addTo(command);
    command
        .add_option("--point", flags->points,
                    "A place: X,Y in file coordinates, or, with --to file, longitude and latitude in "
                    "degrees; may be repeated")
        ->type_name("X,Y")
        ->allow_extra_args(false)
        ->check([](const std::string& text) {
            return placeIn(text) ? std::string()
                                 : "'" + text + "' is not two numbers with a comma between them";
        })
        ->required();
    command
        .add_option(
            "--to", flags->to,
            "What places become: lonlat, longitude and latitude (WGS 84), or file, coordinates of the cloud")
        ->type_name("WHICH")
        ->check(CLI::IsMember({"lonlat", "file"}))
        ->capture_default_str();
    command.footer(
        "One line a place: longitude,latitude or x,y. The server must know the cloud's coordinate reference "
        "system. Examples:\n"
        "  scancast-client lonlat http://127.0.0.1:8080/ town --point 389499,5819799 --point "
        "389512.5,5819799\n"
        "  scancast-client lonlat http://127.0.0.1:8080/ town --to file --point 13.3715,52.5171");
    command.callback([flags, &exitCode] { exitCode = report(run(*flags)); });
}

}  // namespace scancast::client
