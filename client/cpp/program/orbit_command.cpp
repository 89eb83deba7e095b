// `scancast-client orbit`: once around a cloud over the live stream, every step a picture.
#include "client/cpp/program/film.hpp"
#include "client/cpp/program/orbit_start.hpp"

namespace scancast::client {
namespace {

struct OrbitFlags {
    CloudFlags cloud;
    ViewFlags view;
    FilmFlags film;
    int frames = 36;
};

Expected<void> run(const OrbitFlags& flags) {
    const auto from = flags.cloud.choose();
    if (!from) return passOn(from);
    const auto cloud = from->info();
    if (!cloud) return passOn(cloud);
    const auto start = orbitStart(flags.view, *cloud);
    if (!start) return passOn(start);
    return film(from->server, cloud->id, flags.film, flags.frames,
                [&](int i) { return start->at(360.0 * i / flags.frames); });
}

}  // namespace

void addOrbit(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<OrbitFlags>();
    auto& command = *app.add_subcommand("orbit", "Circle a cloud once: numbered JPEGs, or a video");
    flags->cloud.addTo(command);
    command.add_option("--frames", flags->frames, "Number of frames in one turn")
        ->type_name("N")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    flags->film.addTo(command);
    flags->view.addTo(command);
    command.footer(
        "The camera circles the vertical axis through the middle of the cloud, or through --target if "
        "given,\n"
        "at the distance and height of --eye. Example:\n"
        "  scancast-client orbit http://127.0.0.1:8080/ town --frames 36 --method paraboloid -o frames/");
    command.callback([flags, &exitCode] { exitCode = report(run(*flags)); });
}

}  // namespace scancast::client
