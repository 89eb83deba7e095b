#include "client/cpp/program/film.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "client/cpp/program/bench_report.hpp"
#include "client/cpp/program/film_writer.hpp"
#include "client/cpp/program/say.hpp"
#include "client/cpp/stream.hpp"

namespace scancast::client {
namespace {

using Clock = std::chrono::steady_clock;

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

/// Acknowledges everything; returns the frame that shows view `seq` and is good enough.
Expected<ReceivedFrame> frameOf(Stream& stream, std::uint64_t seq, bool anyQuality, FrameWarnings& warning) {
    for (;;) {
        auto frame = stream.receiveFrame();
        if (!frame) return frame;
        if (auto ok = stream.ack(frame->header); !ok) return passOn(ok);
        if (frame->header.seq != seq || !(anyQuality || frame->header.final)) continue;
        warning.look(frame->header);
        return frame;
    }
}

/// Takes the pictures; returns the milliseconds that each took.
Expected<std::vector<double>> takePictures(Stream& stream, FilmWriter& writer, const FilmFlags& flags,
                                           int count, const std::function<View(int)>& at) {
    Progress progress(count, flags.quiet);
    FrameWarnings warning;
    std::vector<double> milliseconds;
    for (int i = 0; i < count; ++i) {
        const auto asked = Clock::now();
        const auto seq = static_cast<std::uint64_t>(i) + 1;
        if (auto ok = stream.sendView(seq, at(i)); !ok) return passOn(ok);
        const auto frame = frameOf(stream, seq, flags.moving, warning);
        if (!frame) return passOn(frame);
        milliseconds.push_back(std::chrono::duration<double, std::milli>(Clock::now() - asked).count());
        if (auto ok = writer.add(frame->jpeg); !ok) return passOn(ok);
        progress.step(i + 1);
    }
    return milliseconds;
}

}  // namespace

void FilmFlags::addTo(CLI::App& command) {
    command
        .add_option(
            "-o,--output", output,
            "A folder for frame-001.jpg, frame-002.jpg …, or, with ffmpeg, a video: .mp4, .mkv, .webm")
        ->type_name("FOLDER|VIDEO")
        ->check([](const std::string& name) {
            const auto ok = checkFilmName(name);
            return ok ? std::string() : ok.error().message;
        })
        ->required();
    command.add_option("--fps", framesPerSecond, "Frames per second of the video")
        ->type_name("N")
        ->check(CLI::Range(0.1, 240.0))
        ->capture_default_str();
    command.add_flag("--moving", moving,
                     "Take the first frame of each step, as seen while moving, instead of the final still");
    command.add_flag("--quiet", quiet, "No progress on standard error");
}

Expected<void> film(const Server& server, const std::string& cloud, const FilmFlags& flags, int count,
                    const std::function<View(int)>& at) {
    const auto first = at(0);
    if (isVideo(flags.output) && flags.moving)
        return fail(ErrorCode::InvalidArgument,
                    "moving frames differ in size: a video is made of finals, without --moving");
    auto writer = FilmWriter::create(flags.output, count, flags.framesPerSecond);
    if (!writer) return passOn(writer);
    messages::Hello hello;
    hello.cloud = cloud;
    hello.width = first.width;
    hello.height = first.height;
    auto stream = Stream::open(server.url(), hello, server.timeouts(), server.credentials());
    if (!stream) return passOn(stream);
    const auto begin = Clock::now();
    const auto milliseconds = takePictures(*stream, *writer, flags, count, at);
    if (!milliseconds) return passOn(milliseconds);
    const std::chrono::duration<double> seconds = Clock::now() - begin;
    if (auto ok = stream->close(); !ok) return ok;
    if (auto ok = writer->finish(); !ok) return ok;
    sayOn(stdout, "%d frames of %s in %.2f s: %.1f frames/s, median %.1f ms, slowest %.1f ms, %dx%d, in %s\n",
          count, cloud.c_str(), seconds.count(), count / seconds.count(), percentile(*milliseconds, 50),
          percentile(*milliseconds, 100), first.width, first.height, flags.output.c_str());
    return {};
}

}  // namespace scancast::client
