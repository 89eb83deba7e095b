// `scancast-client path`: along key frames of a file, every step a picture.
#include <cmath>

#include "client/cpp/camera_path.hpp"
#include "client/cpp/program/film.hpp"
#include "files/input_file.hpp"
#include "protocol/flags/view_flags.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast::client {
namespace {

struct PathFlags {
    ServerFlags server;
    ViewFlags view;
    FilmFlags film;
    std::string file;
};

constexpr std::size_t longestFile = std::size_t(64) << 20;

/// The file's path, with flags having the last word.
Expected<CameraPath> readPath(const PathFlags& flags, const View& base) {
    const auto words = flags.view.words();
    if (!words) return passOn(words);
    const auto text = readTextFile(flags.file, longestFile);
    if (!text) return passOn(text);
    auto path = parseCameraPath(*text, base);
    if (!path) {
        path.error().message = flags.file + ": " + path.error().message;
        return path;
    }
    const auto view = applyWords(path->view, *words);
    if (!view) return passOn(view);
    if (!(view->camera == path->view.camera))
        return fail(ErrorCode::InvalidArgument, "the camera of a path is its file's: change its keys");
    path->view = *view;
    return path;
}

Expected<void> run(const PathFlags& flags) {
    const auto server = flags.server.server();
    if (!server) return passOn(server);
    const auto cloud = chooseCloud(*server, flags.film.cloud).and_then([&](const std::string& id) {
        return server->cloud(id);
    });
    if (!cloud) return passOn(cloud);
    const auto path = readPath(flags, cloud->view);
    if (!path) return passOn(path);
    const double frames = std::floor(path->seconds() * flags.film.framesPerSecond + 1e-6) + 1;
    if (frames > 1e6)
        return fail(ErrorCode::ResourceLimit,
                    flags.file + ": more than a million frames; are times in seconds?");
    return film(*server, cloud->id, flags.film, static_cast<int>(frames),
                [&](int i) { return path->at(path->begin() + i / flags.film.framesPerSecond); });
}

}  // namespace

void addPath(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<PathFlags>();
    auto& command = *app.add_subcommand("path", "Fly along key frames: numbered JPEGs, or a video");
    flags->server.addTo(command);
    command.add_option("FILE", flags->file, "Key frames as JSON")->required();
    flags->film.addTo(command);
    flags->view.addTo(command);
    command.footer(
        "FILE gives the camera at certain times, in seconds; it moves smoothly between them:\n"
        "  {\"view\": {\"method\": \"disc\"},\n"
        "   \"keys\": [{\"time\": 0, \"camera\": {\"eye\": [0, -50, 20], \"target\": [0, 0, 0]}},\n"
        "            {\"time\": 4, \"camera\": {\"eye\": [50, 0, 20]}}]}\n"
        "Whatever a camera leaves out stays as in the key before it. Example:\n"
        "  scancast-client path http://127.0.0.1:8080/ flight.json -o flight.mp4");
    command.callback([flags, &exitCode] { exitCode = report(run(*flags)); });
}

}  // namespace scancast::client
