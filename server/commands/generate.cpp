// `scancast generate`: a simulated scan, streamed to a file or to standard output.
#include <unistd.h>

#include <atomic>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>

#include "protocol/text/grouped.hpp"
#include "renderer/cloud/import/mirror_file.hpp"
#include "server/commands/command.hpp"
#include "server/commands/generate_frames.hpp"
#include "server/terminal/progress_bar.hpp"
#include "server/terminal/terminal.hpp"
#include "simulator/scene.hpp"
#include "simulator/write/point_count.hpp"
#include "simulator/write/point_writer.hpp"

namespace scancast {
namespace {

struct GenerateArguments {
    std::string scene, points = "1M", output, format, order = "scan", origin;
    std::uint64_t seed = 1;
    double noise = 1;
    int threads = 0;
    bool quiet = false;
    std::optional<std::uint64_t> frames;
    FrameSeries series{};
};

/// Ctrl-C, or the end of its terminal, ends the loop, so that the unfinished file is removed as after any
/// other failure.
std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void onInterrupt(int) {
    interrupted = true;
}

Expected<glm::dvec3> parseOrigin(const std::string& text) {
    glm::dvec3 origin(0);
    const char *at = text.data(), *end = text.data() + text.size();
    for (int axis = 0; axis < 3; ++axis) {
        const auto [next, problem] = std::from_chars(at, end, origin[axis]);
        const bool separated = axis == 2 ? next == end : next != end && *next == ',';
        if (problem != std::errc() || !separated)
            return fail(ErrorCode::InvalidArgument,
                        "--origin: '" + text + "' is not X,Y,Z; for example --origin 389500,5819800,34",
                        "origin");
        at = next + 1;
    }
    return origin;
}

Expected<WrittenFormat> chooseFormat(const GenerateArguments& arguments, std::uint64_t points) {
    WrittenFormat format = WrittenFormat::Ply;
    if (arguments.format == "las14") return WrittenFormat::Las14;
    if (arguments.format == "las") {
        format = WrittenFormat::Las12;
    } else if (arguments.format.empty() && arguments.output != "-") {
        const auto named = formatOfName(arguments.output);
        if (!named && arguments.output.rfind("/dev/", 0) != 0)
            return fail(ErrorCode::InvalidArgument,
                        "The name '" + arguments.output +
                            "' does not tell the format; end it in .ply or .las, or give --format.",
                        "format");
        format = named.value_or(WrittenFormat::Ply);
    }
    if (format == WrittenFormat::Las12 && points > UINT32_MAX) format = WrittenFormat::Las14;
    return format;
}

Expected<void> writeMirrors(const SceneOptions& options, const std::string& scan) {
    const std::vector<Mirror> mirrors = sceneMirrors(options);
    if (mirrors.empty() || scan == "-" || scan.rfind("/dev/", 0) == 0) return {};
    auto file = OutputFile::create(mirrorsFileOf(scan).string());
    if (!file) return passOn(file);
    const std::string text = printMirrors(mirrors);
    if (auto ok = file->write(std::as_bytes(std::span(text))); !ok) return ok;
    return file->finish();
}

Expected<SceneOptions> sceneOptions(const GenerateArguments& arguments) {
    SceneOptions options;
    options.scene = arguments.scene;
    options.seed = arguments.seed;
    options.noise = arguments.noise;
    options.threads = arguments.threads;
    options.order = arguments.order == "random" ? PointOrder::Random : PointOrder::Scan;
    const auto points = parsePointCount(arguments.points);
    if (!points) return passOn(points);
    options.points = *points;
    if (!arguments.origin.empty()) {
        const auto origin = parseOrigin(arguments.origin);
        if (!origin) return passOn(origin);
        options.origin = *origin;
    }
    return options;
}

/// Moves all points from the source to the writer; returns how many.
Expected<std::uint64_t> pump(PointSource& source, PointWriter& writer, std::uint64_t total,
                             const ProgressSink& progress) {
    PointBatch batch;
    std::uint64_t done = 0;
    progress({"generating", 0, total, "points"});
    while (true) {
        const auto more = source.read(batch);
        if (!more) return passOn(more);
        if (!*more) return done;
        if (auto ok = writer.write(batch); !ok) return passOn(ok);
        done += batch.size();
        progress({"generating", done, total, "points"});
        if (interrupted) return fail(ErrorCode::Cancelled, "Interrupted; the unfinished file was removed.");
    }
}

Expected<void> generateFrames(const GenerateArguments& arguments) {
    const auto options = sceneOptions(arguments);
    if (!options) return passOn(options);
    auto source = simulate(*options);
    if (!source) return passOn(source);
    FrameSeries series = arguments.series;
    series.frames = *arguments.frames;
    const auto written = writeFrames(**source, arguments.output, series, [] { return interrupted.load(); });
    if (!written) return passOn(written);
    if (!arguments.quiet) tell("{} of {}\n", counted(*written, "frame"), counted(options->points, "point"));
    return {};
}

Expected<void> generate(const GenerateArguments& arguments) {
    if (arguments.output == "-" && isatty(STDOUT_FILENO))
        return fail(ErrorCode::InvalidArgument,
                    "A scan is binary data, not for a terminal; give a file with -o FILE or pipe it on.",
                    "output");
    if (arguments.frames) return generateFrames(arguments);
    const auto options = sceneOptions(arguments);
    if (!options) return passOn(options);
    const auto format = chooseFormat(arguments, options->points);
    if (!format) return passOn(format);
    const auto start = std::chrono::steady_clock::now();
    auto source = simulate(*options);
    if (!source) return passOn(source);
    auto output = OutputFile::create(arguments.output);
    if (!output) return passOn(output);
    auto writer = createPointWriter(*format, std::move(*output), (*source)->header());
    if (!writer) return passOn(writer);

    ProgressBar bar(stderr, arguments.quiet ? ProgressBar::Style::Quiet : ProgressBar::Style::Automatic);
    const auto points = pump(**source, **writer, options->points, bar.sink());
    if (!points) return passOn(points);
    if (auto ok = (*writer)->finish(); !ok) return ok;
    if (auto ok = writeMirrors(*options, arguments.output); !ok) return ok;
    bar.clear();
    if (!arguments.quiet) {
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        tell("{}: {}, {:.1f} MB, {:.1f} s\n", arguments.output == "-" ? "standard output" : arguments.output,
             counted(*points, "point"), double((*writer)->bytesWritten()) / 1e6, took.count());
    }
    return {};
}

constexpr const char* generateExamples =
    "Examples:\n"
    "  scancast generate town --points 20M -o town.las         # points about 6 cm apart\n"
    "  scancast generate room --points 3M -o room.ply          # and room.ply.mirrors.json\n"
    "  scancast generate statue --points 4M -o statue.ply      # points about 2 mm apart\n"
    "  scancast generate sphere --points 1.5e6 --order random --noise 0 -o sphere.ply\n"
    "  scancast generate town --points 1G --format las -o - | gzip > town.las.gz\n"
    "  scancast generate statue --points 100k --frames 0 -o - | scancast serve --live statue=-\n";

}  // namespace

void addGenerate(CLI::App& app, int& exitCode) {
    const auto arguments = std::make_shared<GenerateArguments>();
    CLI::App* command = app.add_subcommand(
        "generate", "Simulate a scan of any size, as a PLY or LAS file, or the frames of a live one");
    std::string sceneHelp = "What is scanned:";
    for (const SceneInfo& scene : scenes()) sceneHelp += fmt::format("\n  {}: {}", scene.name, scene.summary);
    command->add_option("scene", arguments->scene, sceneHelp)->required()->type_name("SCENE");
    command->add_option("-n,--points", arguments->points, "Number of points: 20M, 500k, 1.5e6, 2_000_000")
        ->capture_default_str()
        ->type_name("N");
    command->add_option("-o,--output", arguments->output, "File to write; - for standard output")
        ->required()
        ->type_name("FILE");
    command
        ->add_option("--format", arguments->format,
                     "ply, las (1.2, point format 2) or las14 (1.4, point format 7). Default: what the "
                     "file's name says; ply on standard output")
        ->check(CLI::IsMember({"ply", "las", "las14"}))
        ->type_name("FORMAT");
    command->add_option("--seed", arguments->seed, "Another seed gives other points of the same scene")
        ->capture_default_str();
    command->add_option("--order", arguments->order, "scan: as the scanner turns; random: shuffled")
        ->check(CLI::IsMember({"scan", "random"}))
        ->capture_default_str()
        ->type_name("ORDER");
    command
        ->add_option("--noise", arguments->noise,
                     "Multiple of the scene's own noise (2 mm); 0 = exact surfaces")
        ->check(CLI::Range(0.0, 1000.0))
        ->capture_default_str()
        ->type_name("FACTOR");
    command
        ->add_option("--origin", arguments->origin,
                     "Added to all coordinates. Default: 0,0,0; for the town, a place in UTM")
        ->type_name("X,Y,Z");
    command
        ->add_option("--threads", arguments->threads,
                     "Number of threads; 0 = all cores. The file is the same whatever the number")
        ->check(CLI::Range(0, 4096))
        ->capture_default_str()
        ->type_name("N");
    CLI::Option* frames = command->add_option(
        "--frames", arguments->frames,
        "Write this many frames of the turning scene, as a live source would (serve --live): point streams, "
        "one after another; 0 = for as long as somebody reads them");
    frames->type_name("N");
    command->add_option("--rate", arguments->series.rate, "Frames per second; 0 = as fast as they are read")
        ->check(CLI::Range(0.0, 1000.0))
        ->needs(frames)
        ->capture_default_str()
        ->type_name("FPS");
    command->add_option("--turn", arguments->series.turn, "Degrees between frames")
        ->check(CLI::Range(-180.0, 180.0))
        ->needs(frames)
        ->capture_default_str()
        ->type_name("DEGREES");
    command->add_flag("-q,--quiet", arguments->quiet, "No progress on standard error");
    command->footer(generateExamples);
    command->callback([arguments, &exitCode] {
        std::signal(SIGINT, onInterrupt);
        std::signal(SIGTERM, onInterrupt);
        // Its terminal went away; nohup has it ignored, and it stays so.
        if (std::signal(SIGHUP, onInterrupt) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
        const auto done = generate(*arguments);
        exitCode = done ? 0 : 1;
        if (!done) tell("scancast generate: {}\n", done.error().message);
    });
}

}  // namespace scancast
