// `scancast dem` and `scancast ortho`: a cloud file, or a scan, in plan as a GeoTIFF, without a server.
#include "server/commands/rasters/rasters.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>

#include "files/output_file.hpp"
#include "protocol/flags/exit_codes.hpp"
#include "protocol/flags/raster_flags.hpp"
#include "renderer/look/decide_look.hpp"
#include "renderer/raster/raster_plan.hpp"
#include "renderer/raster/raster_tiff.hpp"
#include "renderer/render.hpp"
#include "server/base/byte_size.hpp"
#include "server/commands/importer_flags.hpp"
#include "server/commands/open_any.hpp"
#include "server/commands/program_folder.hpp"
#include "server/commands/scans/scan_arguments.hpp"
#include "server/terminal/interruption.hpp"
#include "server/terminal/progress_bar.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t rasterPart = std::size_t(1) << 20;
constexpr int mostLeavesInHand = 16;

struct RasterArguments {
    explicit RasterArguments(RasterKind kind) : words(kind) {}
    std::vector<std::string> files;
    std::string output, memoryLimit, assumeCrs;
    DeviceOptions device;
    RasterFlags words;
    bool force = false, quiet = false, verbose = false;
};

Expected<RasterRequest> checkedRequest(const RasterArguments& arguments) {
    auto request = arguments.words.request();
    if (!request) return request;
    for (const auto& [word, text] : request->view)
        if (word == "with")
            return fail(
                ErrorCode::InvalidArgument,
                "with: an orthophoto of several clouds is a server's to make: scancast-client ortho --with",
                "with");
    if (arguments.output == "-") {
        if (isatty(STDOUT_FILENO))
            return fail(ErrorCode::InvalidArgument,
                        "A TIFF is binary data, not for a terminal; give a file with -o FILE or pipe it on.",
                        "output");
        return request;
    }
    std::error_code error;
    if (!arguments.force && fs::is_regular_file(arguments.output, error))
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("{} is there already; --force replaces it.", arguments.output), "output");
    return request;
}

/// Packed tiles wait beside what they become.
RasterScratch scratchFor(const std::string& output) {
    std::error_code error;
    const fs::path parent = fs::path(output).parent_path(), folder = parent.empty() ? fs::path(".") : parent;
    if (output == "-" || !fs::is_directory(folder, error) ||
        (fs::exists(output, error) && !fs::is_regular_file(output, error)))
        return {fs::temp_directory_path(error), "TMPDIR"};
    return {folder, "-o FILE"};
}

/// Draws an orthophoto's blocks; a lost device is replaced by the cpu device.
class BlockPainter {
  public:
    static Expected<BlockPainter> create(DeviceOptions options) {
        options.programFolder = programFolder();
        auto device = createDevice(options);
        if (!device) return passOn(device);
        return BlockPainter(std::move(*device), options.threads);
    }

    Expected<std::vector<std::byte>> cells(const Cloud& cloud, const OrthoViews& views,
                                           const CellWindow& block, const std::stop_token& stop) {
        const View view = orthoView(cloud, views, block);
        RenderOptions options;
        options.depth = false;
        auto frame = render(*device_, cloud, view, options, stop);
        if (!frame && frame.error().code == ErrorCode::DeviceLost) {
            tell("The device {} was lost: {} Drawing with --backend=cpu instead.\n", title(device_->info()),
                 frame.error().message);
            DeviceOptions onCpu;
            onCpu.backend = "cpu";
            onCpu.threads = threads_;
            auto other = createDevice(onCpu);
            if (!other) return passOn(other);
            device_ = std::move(*other);
            frame = render(*device_, cloud, view, options, stop);
        }
        if (!frame) return passOn(frame);
        if (frame->stats.nodesDamaged > 0)
            return fail(ErrorCode::Malformed, "Blocks of the cloud that the orthophoto shows are damaged.");
        return cellsOf(views, block, {frame->rgba.data(), frame->rgba.size()});
    }

  private:
    BlockPainter(std::unique_ptr<Device> device, int threads)
        : device_(std::move(device)), threads_(threads) {}
    std::unique_ptr<Device> device_;
    int threads_;
};

Expected<void> writeRaster(const Cloud& cloud, PlannedRaster& raster, std::optional<BlockPainter>& painter,
                           const RasterArguments& arguments, const ProgressSink& progress,
                           const std::stop_token& stop) {
    auto tiff = openTiff(cloud, raster, scratchFor(arguments.output));
    if (!tiff) return passOn(tiff);
    auto file = OutputFile::create(arguments.output);
    if (!file) return passOn(file);
    const auto blocks = std::uint64_t(raster.layout.grid.blocks());
    std::uint64_t done = 0;
    while (!(*tiff)->isDone()) {
        while ((*tiff)->ready() > 0) {
            const auto part = (*tiff)->take(rasterPart);
            if (!part) return passOn(part);
            if (auto ok = file->write(*part); !ok) return ok;
        }
        const auto block = (*tiff)->nextBlock();
        if (!block) continue;
        const auto cells = painter ? painter->cells(cloud, *raster.ortho, *block, stop)
                                   : elevationCells(cloud, raster, *block, stop);
        if (!cells) return passOn(cells);
        if (auto ok = (*tiff)->put(*cells); !ok) return ok;
        progress({"making", ++done, blocks, "blocks"});
    }
    return file->finish();
}

Expected<void> runRaster(const RasterArguments& arguments, const RasterRequest& request) {
    std::optional<tbb::global_control> threads;
    if (arguments.device.threads > 0)
        threads.emplace(tbb::global_control::max_allowed_parallelism, std::size_t(arguments.device.threads));
    std::optional<BlockPainter> painter;
    if (request.kind == RasterKind::Orthophoto) {
        auto opened = BlockPainter::create(arguments.device);
        if (!opened) return passOn(std::move(opened));
        painter.emplace(std::move(*opened));
    }
    auto cloud = openAny(arguments.files, {.threads = arguments.device.threads,
                                           .assumeCrs = arguments.assumeCrs,
                                           .memoryLimit = arguments.memoryLimit,
                                           .verbose = arguments.verbose});
    if (!cloud) return passOn(cloud);
    if (painter) cloud = withLook(std::move(*cloud));
    const auto start = std::chrono::steady_clock::now();
    auto raster = planRaster(**cloud, request);
    if (!raster) return passOn(raster);
    raster->elevation.threads = std::clamp(tbb::this_task_arena::max_concurrency(), 1, mostLeavesInHand);
    const Interruption interruption;
    ProgressBar bar(stderr, arguments.quiet ? ProgressBar::Style::Quiet : ProgressBar::Style::Automatic);
    const auto done = writeRaster(**cloud, *raster, painter, arguments, bar.sink(), interruption.token());
    bar.clear();
    if (!done && interruption.token().stop_requested())
        return fail(ErrorCode::Cancelled, "Interrupted; nothing was left behind.");
    if (!done || arguments.quiet) return done;
    const RasterGrid& grid = raster->layout.grid;
    tell("{}: {} x {} cells of {:g} from x {:.12g}, y {:.12g}, {:.2f} s\n",
         arguments.output == "-" ? "standard output" : arguments.output, grid.columns, grid.rows, grid.cell,
         grid.left, grid.top,
         std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return {};
}

void addRaster(CLI::App& app, int& exitCode, RasterKind kind, const char* name, const char* what,
               const char* footer) {
    const auto arguments = std::make_shared<RasterArguments>(kind);
    auto* command = app.add_subcommand(name, what);
    addFilesAsOne(*command, arguments->files, arguments->verbose);
    command->add_option("-o,--output", arguments->output, "The GeoTIFF to write; - for standard output")
        ->type_name("FILE.tif")
        ->required();
    command->add_flag("-f,--force", arguments->force, "Replace the file if it exists");
    command->add_flag("-q,--quiet", arguments->quiet, "Nothing on standard error but errors");
    if (kind == RasterKind::Orthophoto) {
        command->add_option("--backend", arguments->device.backend, "auto, cpu, egl or osmesa")
            ->capture_default_str();
        command->add_option("--egl-device", arguments->device.eglDevice,
                            "Which GPU, as numbered by scancast --list-backends");
    }
    command
        ->add_option("--threads", arguments->device.threads, "CPU threads; 0 = all. Does not change the file")
        ->check(CLI::Range(0, 1024));
    command
        ->add_option("--memory-limit", arguments->memoryLimit,
                     "Memory for a cloud file, such as 2G. Default: half of the machine's")
        ->type_name("SIZE");
    addAssumeCrs(*command, arguments->assumeCrs);
    arguments->words.addTo(*command);
    command->footer(footer);
    command->callback([arguments, name, &exitCode] {
        const auto request = checkedRequest(*arguments);
        if (!request) {
            tell("scancast {}: {}\n", name, request.error().message);
            exitCode = exitUsage;
            return;
        }
        if (auto done = runRaster(*arguments, *request); !done) {
            tell("scancast {}: {}\n", name, done.error().message);
            exitCode = exitFailed;
        }
    });
}

}  // namespace

void addRasters(CLI::App& app, int& exitCode) {
    addRaster(app, exitCode, RasterKind::Elevation, "dem", "Write elevations in plan, as a GeoTIFF",
              "Of every cell the highest, the lowest or the mean elevation of the scan's own points in it, "
              "all of which are "
              "looked at; or how many they are. Any size, in the memory of a few leaves.\n"
              "Examples:\n"
              "  scancast dem town.scan --cell 0.5 -o town-dem.tif\n"
              "  scancast dem town.scan --classes 2 --value mean --fill 4 -o ground.tif\n"
              "  scancast dem flight.las --bbox 389400,5819700,389500,5819800 --cell 0.25 -o part.tif\n");
    addRaster(app, exitCode, RasterKind::Orthophoto, "ortho", "Write an orthophoto, as a GeoTIFF",
              "The cloud from straight above, drawn by any method and in any colour; transparent where "
              "nothing is.\n"
              "Examples:\n"
              "  scancast ortho town.scan --cell 0.1 -o town-ortho.tif\n"
              "  scancast ortho town.scan --cell 0.25 --color elevation --light occlusion=0.6 --background "
              "'#ffffff' -o "
              "relief.tif\n");
}

}  // namespace scancast
