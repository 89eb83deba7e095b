// `scancast render`: a picture of a scan without a server, and the stopwatch of the renderer.

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <nlohmann/json.hpp>

#include "files/output_file.hpp"
#include "protocol/flags/exit_codes.hpp"
#include "protocol/flags/view_flags.hpp"
#include "protocol/text/plain_text.hpp"
#include "protocol/view/view_words.hpp"
#include "renderer/image/encode.hpp"
#include "renderer/look/decide_look.hpp"
#include "renderer/plan.hpp"
#include "renderer/render.hpp"
#include "renderer/together/together.hpp"
#include "server/base/byte_size.hpp"
#include "server/commands/command.hpp"
#include "server/commands/importer_flags.hpp"
#include "server/commands/look_file.hpp"
#include "server/commands/open_any.hpp"
#include "server/commands/program_folder.hpp"
#include "server/commands/scans/scan_arguments.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct RenderArguments {
    std::vector<std::string> files;
    std::string output, stats, look;
    DeviceOptions device;
    RenderOptions render;
    ViewFlags view;
    int repeat = 1;
    std::string memoryLimit, gpuMemoryLimit, assumeCrs;
    bool noSurfels = false, native = false, verbose = false;
    double orbit = 0;  ///< degrees around the target between repeated frames
};

/// What each repetition cost, stage by stage.
struct Timings {
    std::vector<double> whole;
    std::vector<std::string> order;
    std::map<std::string, std::vector<double>> stages;

    void add(double wholeMs, const FrameStats& stats) {
        whole.push_back(wholeMs);
        for (const auto& stage : stats.stages) {
            if (!stages.contains(stage.name)) order.push_back(stage.name);
            stages[stage.name].push_back(stage.milliseconds);
        }
    }
};

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::string statsJson(const Timings& timings, const Frame& frame, const Cloud& cloud) {
    nlohmann::ordered_json json;
    json["frames"] = timings.whole.size();
    json["medianMs"] = median(timings.whole);
    json["points"] = cloud.points;
    json["samples"] = frame.stats.samplesDrawn;
    json["spacingPx"] = frame.stats.spacingReached;
    json["device"] = frame.stats.device;
    json["method"] = frame.stats.method;
    if (!frame.stats.methodReason.empty()) json["methodReason"] = frame.stats.methodReason;
    json["color"] = frame.stats.color;
    json["exposure"] = frame.stats.exposure;
    json["mirrors"] = frame.stats.mirrorsDrawn;
    json["bytesUploaded"] = frame.stats.bytesUploaded;
    json["deviceBytes"] = frame.stats.deviceBytes;
    if (frame.stats.mirrorsLeftOut > 0) json["mirrorsLeftOut"] = frame.stats.mirrorsLeftOut;
    json["stages"] = nlohmann::ordered_json::array();
    for (const auto& name : timings.order) {
        json["stages"].push_back({{"name", name}, {"medianMs", median(timings.stages.at(name))}});
    }
    return plainJson(json.dump());
}

/// The eye turned about the axis through the target that points up.
void orbitBy(Camera& camera, double degrees) {
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1), glm::radians(degrees), camera.up);
    camera.eye = camera.target + glm::dvec3(turn * glm::dvec4(camera.eye - camera.target, 0));
}

std::string endingOf(const fs::path& file) {
    std::string ending = file.extension().string();
    for (char& c : ending)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return ending;
}

bool isJpeg(const fs::path& file) {
    return endingOf(file) == ".jpg" || endingOf(file) == ".jpeg";
}

Expected<Bytes> encode(const Frame& frame, const View& view, const fs::path& file, int threads) {
    if (isJpeg(file)) return encodeJpeg(frame, view.quality.jpegQuality, view.quality.subsampling, threads);
    return encodePng(frame, view.style.background.kind == Background::Kind::Transparent);
}

/// All that can be wrong with the command line by itself: reading a scan takes minutes. The words of the view that it has.
Expected<WordValues> checkArguments(const RenderArguments& arguments) {
    const fs::path output(arguments.output);
    if (!arguments.output.empty() && !isJpeg(output) && endingOf(output) != ".png") {
        return fail(ErrorCode::InvalidArgument,
                    "the picture's name must end in .png, .jpg or .jpeg, not '" + arguments.output + "'");
    }
    if (arguments.output.empty() && arguments.stats.empty()) {
        return fail(ErrorCode::InvalidArgument,
                    "nothing to do: name a picture (-o FILE.png) or ask for --stats json");
    }
    auto words = arguments.view.words();
    if (!words) return words;
    View view;
    for (const auto& [word, value] : *words)
        if (word == "method" || word.starts_with("param."))
            if (auto ok = applyWord(view, word, value); !ok) return passOn(ok);
    if (auto ok = checkMethod(view.style); !ok) return passOn(ok);
    if (!arguments.look.empty())
        if (const auto look = readLookFile(arguments.look); !look) return passOn(look);
    if (const auto limit = parseGpuMemoryLimit(arguments.gpuMemoryLimit); !limit) return passOn(limit);
    return words;
}

/// Errors: those of changedLook(); InvalidArgument for a cloud that has none to change.
Expected<std::shared_ptr<const Cloud>> withChangedLook(std::shared_ptr<const Cloud> cloud,
                                                       const std::string& file) {
    auto look = changedLook(cloud->look.value_or(Look()), file);
    if (!look) return passOn(look);
    auto changed = std::make_shared<Cloud>(*cloud);
    changed->look = std::move(*look);
    return changed;
}

/// What the words say of clouds that are shown together; each is opened as the first one is, by its file's name.
Expected<std::shared_ptr<const Cloud>> withOthers(std::shared_ptr<const Cloud> cloud, const std::string& file,
                                                  const WordValues& words, const OpenOptions& open) {
    View view;
    for (const auto& [word, value] : words)
        if (word == "with" || word == "color")
            if (auto ok = applyWord(view, word, value); !ok) return passOn(ok);
    if (auto sound = validate(view); !sound) return passOn(sound);
    if (view.with.empty()) return cloud;
    auto members = membersOf(view.with, {.name = file, .cloud = std::move(cloud)},
                             [&](const ViewedCloud& one) { return openAny({one.cloud}, open); });
    if (!members) return passOn(std::move(members));
    return putTogether(std::move(*members), view.style.color == ColorSource::Cloud, open.cache);
}

/// A lost device is replaced by the cpu device, which draws the picture instead.
Expected<Frame> renderOrReplace(std::unique_ptr<Device>& device, const Cloud& cloud, const View& view,
                                const RenderArguments& arguments) {
    auto drawn = render(*device, cloud, view, arguments.render);
    if (drawn || drawn.error().code != ErrorCode::DeviceLost) return drawn;
    tell("The device {} was lost: {} Drawing with --backend=cpu instead.\n", title(device->info()),
         drawn.error().message);
    DeviceOptions options;
    options.backend = "cpu";
    options.threads = arguments.device.threads;
    auto other = createDevice(options);
    if (!other) return passOn(other);
    device = std::move(*other);
    return render(*device, cloud, view, arguments.render);
}

Expected<void> runRender(const RenderArguments& arguments, const WordValues& words) {
    DeviceOptions options = arguments.device;
    options.programFolder = programFolder();
    const auto gpuMemoryLimit = parseGpuMemoryLimit(arguments.gpuMemoryLimit);
    if (!gpuMemoryLimit) return passOn(gpuMemoryLimit);
    options.gpuMemoryLimit = *gpuMemoryLimit;
    auto device = createDevice(options);
    if (!device) return passOn(device);
    OpenOptions open{.threads = arguments.device.threads,
                     .surfels = !arguments.noSurfels,
                     .assumeCrs = arguments.assumeCrs,
                     .memoryLimit = arguments.memoryLimit,
                     .native = arguments.native,
                     .verbose = arguments.verbose};
    const auto cache = cacheFor(open);
    if (!cache) return passOn(cache);
    open.cache = *cache;
    auto cloud = openAny(arguments.files, open);
    if (!cloud) return passOn(cloud);
    cloud = withLook(std::move(*cloud));
    if (!arguments.look.empty()) {
        cloud = withChangedLook(std::move(*cloud), arguments.look);
        if (!cloud) return passOn(cloud);
    }
    cloud = withOthers(std::move(*cloud), arguments.files.front(), words, open);
    if (!cloud) return passOn(cloud);
    auto view = applyWords(defaultView(**cloud), words);
    if (!view) return passOn(view);

    Timings timings;
    Frame frame;
    Bytes bytes;
    for (int i = 0; i < arguments.repeat; ++i) {
        const auto start = Clock::now();
        auto drawn = renderOrReplace(*device, **cloud, *view, arguments);
        if (!drawn) return passOn(drawn);
        frame = std::move(*drawn);
        const auto rendered = Clock::now();
        auto encoded =
            encode(frame, *view, arguments.output.empty() ? fs::path("x.jpg") : fs::path(arguments.output),
                   arguments.device.threads);
        if (!encoded) return passOn(encoded);
        bytes = std::move(*encoded);
        const auto end = Clock::now();
        frame.stats.add("encode", std::chrono::duration<double, std::milli>(end - rendered).count());
        timings.add(std::chrono::duration<double, std::milli>(end - start).count(), frame.stats);
        if (arguments.orbit != 0 && i + 1 < arguments.repeat) orbitBy(view->camera, arguments.orbit);
    }
    if (!arguments.output.empty()) {
        if (auto ok = writeWholeFile(arguments.output, std::as_bytes(std::span(bytes))); !ok) return ok;
    }
    if (arguments.stats.empty()) return {};
    return print(statsJson(timings, frame, **cloud) + "\n");
}

}  // namespace

void addRender(CLI::App& app, int& exitCode) {
    auto* command = app.add_subcommand("render", "Render one picture of a scan, without a server");
    command->footer(
        "Examples:\n"
        "  scancast render church.las -o church.png\n"
        "  scancast render church.las -o top.jpg --projection orthographic --eye 0,0,100 --target 0,0,0 --up "
        "0,1,0\n"
        "  scancast render church.las -o evening.png --shading phong --light sun=250,20 --light shadow=0.8 "
        "--light occlusion=0.5\n"
        "  scancast render 'flight/*.laz' -o flight.jpg\n"
        "  scancast render s3://scans/town.scan -o town.jpg\n"
        "  scancast render 2024.scan -o both.png --color cloud --with '2019.scan,shift:0:0:0.05'\n"
        "  scancast render church.las --repeat 50 --stats json --samples 1 --method point");
    auto arguments = std::make_shared<RenderArguments>();
    arguments->render.depth = false;  // of what it writes, no format shows it
    addFilesAsOne(*command, arguments->files, arguments->verbose);
    command->add_option("-o,--output", arguments->output, "The picture to write: .png, .jpg or .jpeg");
    command->add_option("--backend", arguments->device.backend, "auto, cpu, egl or osmesa")
        ->capture_default_str();
    command->add_option("--egl-device", arguments->device.eglDevice,
                        "Which GPU, as numbered by scancast --list-backends");
    command
        ->add_option("--threads", arguments->device.threads,
                     "CPU threads; 0 = all. Does not change the picture")
        ->check(CLI::Range(0, 1024));
    command->add_flag("--brute-force", arguments->render.bruteForce,
                      "Draw every point of the scan: no level of detail, no culling");
    command->add_option("--repeat", arguments->repeat, "Render N times, reusing nothing, and report medians")
        ->check(CLI::Range(1, 1000000));
    command->add_option("--orbit", arguments->orbit,
                        "Turn about the target by this many degrees between repetitions");
    command
        ->add_option("--memory-limit", arguments->memoryLimit,
                     "Memory for a cloud file, such as 2G. Default: half of the machine's")
        ->type_name("SIZE");
    command
        ->add_option("--gpu-memory-limit", arguments->gpuMemoryLimit,
                     "GPU memory for points, such as 8G. Default: three quarters of what is free")
        ->type_name("SIZE");
    command->add_flag("--no-surfels", arguments->noSurfels,
                      "Read a scan faster by not estimating the normals and radii that disc, ewa, voronoi "
                      "and shading=phong need. Cloud files stay as they are");
    command->add_flag(
        "--native", arguments->native,
        "Draw a scan in COPC or EPT as it is, without ingest: only the points that the picture wants are read");
    addAssumeCrs(*command, arguments->assumeCrs);
    command->add_option("--stats", arguments->stats, "Print timings on standard output, as JSON")
        ->check(CLI::IsMember({"json"}));
    command
        ->add_option("--look", arguments->look,
                     "Use this look instead of the cloud's own: JSON as scancast look prints it, or only "
                     "what should differ. View flags take precedence")
        ->type_name("FILE");
    arguments->view.addTo(*command);
    command->callback([arguments, &exitCode] {
        const auto words = checkArguments(*arguments);
        if (!words) {
            tell("scancast render: {}\n", words.error().message);
            exitCode = exitUsage;
            return;
        }
        if (auto done = runRender(*arguments, *words); !done) {
            tell("scancast render: {}\n", done.error().message);
            exitCode = exitFailed;
        }
    });
}

}  // namespace scancast
