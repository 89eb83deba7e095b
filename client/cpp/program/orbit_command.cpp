// `scancast-client orbit`: once around a cloud over the live stream, every step written as a JPEG.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "client/cpp/orbit_path.hpp"
#include "client/cpp/program/command.hpp"
#include "client/cpp/program/view_flags.hpp"
#include "client/cpp/stream.hpp"
#include "protocol/view_json.hpp"
#include "protocol/view_words.hpp"

namespace scancast::client {
namespace {

struct OrbitFlags {
    ServerFlags server;
    ViewFlags view;
    std::string cloud, output;
    int frames = 36;
    bool moving = false, quiet = false;
};

/// One line that overwrites itself on a terminal; elsewhere, a line for every tenth of the way.
class Progress {
  public:
    Progress(int total, bool quiet) : total_(total), quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}
    void step(int done) {
        if (quiet_) return;
        if (terminal_)
            std::fprintf(stderr, "\rframe %d of %d%s", done, total_, done == total_ ? "\n" : "");
        else if (done * 10 / total_ != (done - 1) * 10 / total_)
            std::fprintf(stderr, "frame %d of %d\n", done, total_);
    }

  private:
    int total_;
    bool quiet_, terminal_;
};

std::string fileName(const OrbitFlags& flags, int number) {
    const auto digits = std::max<std::size_t>(3, std::to_string(flags.frames).size());
    auto text = std::to_string(number);
    text.insert(0, digits > text.size() ? digits - text.size() : 0, '0');
    return (std::filesystem::path(flags.output) / ("frame-" + text + ".jpg")).string();
}

/// Acknowledges everything; returns the frame that shows view `seq` and is good enough.
Expected<ReceivedFrame> frameOf(Stream& stream, std::uint64_t seq, bool anyQuality) {
    for (;;) {
        auto frame = stream.receiveFrame();
        if (!frame) return frame;
        if (auto sent = stream.ack(frame->header); !sent) return tl::unexpected(sent.error());
        if (frame->header.seq == seq && (anyQuality || frame->header.final)) return frame;
    }
}

struct Start {
    View view;          ///< the first step
    glm::dvec3 center;  ///< walked around
    glm::dvec3 axis;    ///< the cloud's own upward direction, whichever way the picture is held
};

Expected<Start> startOf(const OrbitFlags& flags, const CloudInfo& cloud) {
    const auto words = flags.view.words();
    if (!words) return tl::unexpected(words.error());
    const auto view = applyWords(cloud.view, *words);
    if (!view) return tl::unexpected(view.error());
    if (view->camera.viewMatrix)
        return fail(ErrorCode::InvalidArgument,
                    "an orbit is made of --eye and --target, not of --view-matrix", "viewMatrix");
    const bool targetGiven =
        std::any_of(words->begin(), words->end(), [](const auto& w) { return w.first == "target"; });
    const auto center = targetGiven ? view->camera.target : (cloud.bounds[0] + cloud.bounds[1]) * 0.5;
    Start start{*view, center, cloud.view.camera.viewMatrix ? glm::dvec3(0, 0, 1) : cloud.view.camera.up};
    start.view.camera = orbitedCamera(view->camera, center, start.axis, 0);
    if (auto sound = validate(start.view); !sound) return tl::unexpected(sound.error());
    return start;
}

Expected<void> makeFolder(const std::string& path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error) return fail(ErrorCode::Io, "cannot make the folder " + path + ": " + error.message());
    return {};
}

Expected<void> run(const OrbitFlags& flags) {
    const auto server = flags.server.server();
    if (!server) return tl::unexpected(server.error());
    const auto cloud =
        chooseCloud(*server, flags.cloud).and_then([&](const std::string& id) { return server->cloud(id); });
    if (!cloud) return tl::unexpected(cloud.error());
    const auto start = startOf(flags, *cloud);
    if (!start) return tl::unexpected(start.error());
    if (auto made = makeFolder(flags.output); !made) return made;

    messages::Hello hello;
    hello.cloud = cloud->id;
    hello.width = start->view.width;
    hello.height = start->view.height;
    auto stream = Stream::open(server->url(), hello, server->timeouts(), server->credentials());
    if (!stream) return tl::unexpected(stream.error());

    Progress progress(flags.frames, flags.quiet);
    using Clock = std::chrono::steady_clock;
    std::vector<double> milliseconds;
    const auto begin = Clock::now();
    for (int i = 0; i < flags.frames; ++i) {
        const auto seq = static_cast<std::uint64_t>(i) + 1;
        const auto asked = Clock::now();
        auto view = start->view;
        view.camera = orbitedCamera(start->view.camera, start->center, start->axis, 360.0 * i / flags.frames);
        if (auto sent = stream->sendView(seq, view); !sent) return sent;
        const auto frame = frameOf(*stream, seq, flags.moving);
        if (!frame) return tl::unexpected(frame.error());
        milliseconds.push_back(std::chrono::duration<double, std::milli>(Clock::now() - asked).count());
        if (auto written = writeFile(fileName(flags, i + 1), frame->jpeg); !written) return written;
        progress.step(i + 1);
    }
    const std::chrono::duration<double> seconds = Clock::now() - begin;
    if (auto closed = stream->close(); !closed) return closed;
    std::sort(milliseconds.begin(), milliseconds.end());
    std::printf("%d frames of %s in %.2f s: %.1f frames/s, median %.1f ms, slowest %.1f ms, %dx%d, in %s\n",
                flags.frames, cloud->id.c_str(), seconds.count(), flags.frames / seconds.count(),
                milliseconds[milliseconds.size() / 2], milliseconds.back(), start->view.width,
                start->view.height, flags.output.c_str());
    return {};
}

}  // namespace

void addOrbit(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<OrbitFlags>();
    auto& command = *app.add_subcommand("orbit", "Walk once around a cloud and write every step as a JPEG");
    flags->server.addTo(command);
    command.add_option("-o,--output", flags->output, "The folder to write frame-001.jpg, frame-002.jpg … to")
        ->type_name("FOLDER")
        ->required();
    command.add_option("--frames", flags->frames, "Steps of one turn")
        ->type_name("N")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    command.add_option("--cloud", flags->cloud, "Id of the cloud; the server's first one when not given")
        ->type_name("ID");
    command.add_flag(
        "--moving", flags->moving,
        "Take the first frame of each step, as a viewer does while moving, instead of the final still");
    command.add_flag("--quiet", flags->quiet, "No progress on standard error");
    flags->view.addTo(command);
    command.footer(
        "The way leads around the vertical line through the middle of the cloud, or through --target when it "
        "is\n"
        "given, at the distance and height of --eye. Example:\n"
        "  scancast-client orbit http://127.0.0.1:8080/ --frames 36 --method paraboloid -o frames/");
    command.callback([flags, &exitCode] { exitCode = report(run(*flags)); });
}

}  // namespace scancast::client
