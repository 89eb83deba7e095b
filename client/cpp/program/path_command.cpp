// `scancast-client path`: along key frames of a file, or the saved views of a project's tour, every step a picture.
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "client/cpp/camera_path.hpp"
#include "client/cpp/program/film.hpp"
#include "client/cpp/program/tour/tour_flight.hpp"
#include "files/input_file.hpp"
#include "protocol/flags/view_flags.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast::client {
namespace {

struct PathFlags {
    CloudFlags cloud;
    ViewFlags view;
    FilmFlags film;
    std::string file, project, tour;
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

/// The pictures of a flight of so many seconds: its first moment, and each frame after it.
Expected<int> framesOf(double seconds, const PathFlags& flags) {
    const double frames = std::floor(seconds * flags.film.framesPerSecond + 1e-6) + 1;
    if (frames > 1e6)
        return fail(ErrorCode::ResourceLimit, (flags.project.empty() ? flags.file : flags.project) +
                                                  ": more than a million frames; are times in seconds?");
    return static_cast<int>(frames);
}

Expected<void> filmPath(const Server& server, const CloudInfo& cloud, const PathFlags& flags) {
    const auto path = readPath(flags, cloud.view);
    if (!path) return passOn(path);
    const auto frames = framesOf(path->seconds(), flags);
    if (!frames) return passOn(frames);
    return film(server, cloud.id, flags.film, *frames,
                [&](int i) { return path->at(path->begin() + i / flags.film.framesPerSecond); });
}

Expected<void> filmTour(const Server& server, const CloudInfo& cloud, const PathFlags& flags,
                        const ProjectTours& project) {
    const auto words = flags.view.words();
    if (!words) return passOn(words);
    const auto& [low, high] = cloud.bounds;
    const auto flight = project.tour(flags.tour).and_then([&](const ProjectTour& tour) {
        return TourFlight::create(cloud.view, project, tour, *words,
                                  {(low + high) / 2.0, glm::distance(low, high) / 2});
    });
    if (!flight) {
        auto error = flight.error();
        error.message = flags.project + ": " + error.message;
        return tl::unexpected(error);
    }
    const auto frames = framesOf(flight->seconds(), flags);
    if (!frames) return passOn(frames);
    return film(server, cloud.id, flags.film, *frames,
                [&](int i) { return flight->at(i / flags.film.framesPerSecond); });
}

Expected<ProjectTours> readProject(const std::string& file) {
    auto project = readTextFile(file, longestProject).and_then([](const std::string& text) {
        return parseProjectTours(text);
    });
    if (!project) project.error().message = file + ": " + project.error().message;
    return project;
}

Expected<void> run(const PathFlags& flags) {
    if (flags.file.empty() == flags.project.empty())
        return fail(ErrorCode::InvalidArgument,
                    flags.file.empty()
                        ? "give either FILE, with key frames, or --project"
                        : "give either FILE, with key frames, or --project, and not both; if " + flags.file +
                              " is a cloud, say --cloud " + flags.file);
    if (flags.project.empty() && !flags.tour.empty())
        return fail(ErrorCode::InvalidArgument, "--tour names a tour of --project; FILE has none");
    std::optional<ProjectTours> project;
    if (!flags.project.empty()) {
        auto read = readProject(flags.project);
        if (!read) return passOn(read);
        project = std::move(*read);
    }
    const auto from = flags.cloud.choose(project ? project->cloud : std::string());
    if (!from) return passOn(from);
    const auto cloud = from->info();
    if (!cloud) return passOn(cloud);
    return project ? filmTour(from->server, *cloud, flags, *project) : filmPath(from->server, *cloud, flags);
}

}  // namespace

void addPath(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<PathFlags>();
    auto& command = *app.add_subcommand("path", "Fly along key frames: numbered JPEGs, or a video");
    flags->cloud.server.addTo(command);
    command.add_option("FILE", flags->file, "Key frames as JSON");
    flags->cloud.addCloudTo(command, "that of the project, or the server's first one");
    command
        .add_option("--project", flags->project,
                    "Fly along the saved views of a project file of the page's, in place of FILE")
        ->type_name("FILE");
    command.add_option("--tour", flags->tour, "Which of its tours. Default: the first")->type_name("NAME");
    flags->film.addTo(command);
    flags->view.addTo(command);
    command.footer(
        "FILE gives the camera at certain times, in seconds; it moves smoothly between them:\n"
        "  {\"view\": {\"method\": \"disc\"},\n"
        "   \"keys\": [{\"time\": 0, \"camera\": {\"eye\": [0, -50, 20], \"target\": [0, 0, 0]}},\n"
        "            {\"time\": 4, \"camera\": {\"eye\": [50, 0, 20]}}]}\n"
        "Whatever a camera leaves out stays as in the key before it. With --project, the camera flies along "
        "the\n"
        "saved views of a tour, smoothly, rests at each as long as the tour says, and takes each one's "
        "style. Examples:\n"
        "  scancast-client path http://127.0.0.1:8080/ flight.json town -o flight.mp4\n"
        "  scancast-client path http://127.0.0.1:8080/ --project town.project.json --tour Walk -o walk.mp4");
    command.callback([flags, &exitCode] { exitCode = report(run(*flags)); });
}

}  // namespace scancast::client
