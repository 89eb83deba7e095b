// `scancast export`: the points of a cloud file, or of a scan, as a file that other programs read.
#include "server/commands/export/export.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <memory>

#include "protocol/flags/region_flags.hpp"
#include "protocol/text/grouped.hpp"
#include "renderer/cloud/export/export_points.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "server/base/byte_size.hpp"
#include "server/base/remote_cloud.hpp"
#include "server/commands/importer_flags.hpp"
#include "server/terminal/interruption.hpp"
#include "server/terminal/progress_bar.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

struct ExportArguments {
    std::string input, output, format;
    RegionFlags region;
    ImporterFlags importer;
    bool normals = false, force = false, quiet = false;
};

Expected<ExportFormat> formatOf(const ExportArguments& arguments) {
    if (arguments.format == "las") return ExportFormat::Las;
    if (arguments.format == "ply") return ExportFormat::Ply;
    if (arguments.format == "csv") return ExportFormat::Csv;
    if (arguments.format == "txt") return ExportFormat::Text;
    if (arguments.output == "-")
        return fail(ErrorCode::InvalidArgument,
                    "Standard output has no name that tells the format; give --format las, ply, csv or txt.",
                    "format");
    return exportFormatOf(arguments.output);
}

Expected<ExportOptions> exportOptions(const ExportArguments& arguments) {
    ExportOptions options;
    options.output = arguments.output;
    options.estimatedNormals = arguments.normals;
    const auto format = formatOf(arguments);
    if (!format) return passOn(format);
    options.format = *format;
    auto region = arguments.region.region();
    if (!region) return passOn(region);
    options.region = std::move(*region);
    const bool text = options.format == ExportFormat::Csv || options.format == ExportFormat::Text;
    if (arguments.output == "-") {
        if (!text && isatty(STDOUT_FILENO))
            return fail(
                ErrorCode::InvalidArgument,
                "LAS and PLY are binary data, not for a terminal; give a file with -o FILE or pipe it on.",
                "output");
        return options;
    }
    std::error_code error;
    if (fs::equivalent(arguments.input, arguments.output, error))
        return fail(ErrorCode::InvalidArgument, fmt::format("{} is both input and output.", arguments.input),
                    "output");
    if (!arguments.force && fs::is_regular_file(arguments.output, error))
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("{} is there already; --force replaces it.", arguments.output), "output");
    return options;
}

Expected<ExportReport> exportInput(const ExportArguments& arguments, const ExportOptions& options,
                                   const ProgressSink& progress, const std::stop_token& stop) {
    if (isRemoteUrl(arguments.input)) {
        RemoteFiles remote{RemoteOptions()};
        const std::stop_callback whenStopped(stop, [&] { remote.stop(); });
        auto opened = openRemoteCloud(remote, arguments.input);
        if (opened && opened->file->isNative())
            return fail(ErrorCode::Unsupported,
                        shownArgument(arguments.input) +
                            " is a scan and no cloud file, and its points are not exported over the network: "
                            "download it, or ingest it, and "
                            "export that.");
        auto report = opened ? exportCloud(opened->file, options, progress, stop) : passOn(std::move(opened));
        if (!report && stop.stop_requested())
            return fail(ErrorCode::Cancelled, "The export was interrupted.");
        return report;
    }
    auto input = ScanInput::open(arguments.input);
    if (!input) return passOn(input);
    if (isCloudFile(input->file())) {
        auto shared = input->file().share();
        if (!shared) return passOn(shared);
        auto file = CloudFile::open(std::move(*shared));
        if (!file) return passOn(file);
        return exportCloud(*file, options, progress, stop);
    }
    auto import = importOptions(arguments.importer);
    if (!import) return passOn(import);
    import->keepAttributes = import->exact = true;
    import->stop = stop;
    return exportScan([&] { return openScan(*input, *import); }, options, progress, stop);
}

Expected<void> runExport(const ExportArguments& arguments) {
    const auto options = exportOptions(arguments);
    if (!options) return passOn(options);
    const Interruption interruption;
    ProgressBar bar(stderr, arguments.quiet ? ProgressBar::Style::Quiet : ProgressBar::Style::Automatic);
    const auto report = exportInput(arguments, *options, bar.sink(), interruption.token());
    bar.clear();
    if (!report && report.error().code == ErrorCode::Cancelled)
        return fail(ErrorCode::Cancelled, "Interrupted; nothing was left behind.");
    if (!report) return passOn(report);
    if (arguments.quiet) return {};
    tell("{}: {}, {}, {:.1f} s ({:.2f} M points/s)\n",
         arguments.output == "-" ? "standard output" : arguments.output, counted(report->points, "point"),
         byteSizeText(report->bytes), report->seconds,
         double(report->points) / std::max(report->seconds, 1e-9) / 1e6);
    for (const std::string& loss : report->losses) tell("Not as the scan was: {}.\n", loss);
    return {};
}

constexpr const char* exportFooter =
    "Every point of the scan is written once, with everything that its cloud file keeps: position, colour, "
    "intensity, class, the scan's own normals, and the columns of ingest --keep-attributes (in LAS, as "
    "fields and extra bytes). Whatever the cloud file has not kept is listed at the end: 16-bit colours (8 "
    "bits are kept), positions in leaves wider than 16 bits of the scan's grid (rounded), columns. ingest "
    "--exact keeps all of it.\n"
    "LAZ, COPC and E57 cannot be written. To turn LAS into LAZ: pdal translate out.las out.laz\n"
    "Examples:\n"
    "  scancast export town.scan -o town.las\n"
    "  scancast export town.scan -o roofs.ply --clip 389400,5819700,40,389500,5819800,90 --classes 6\n"
    "  scancast export town.scan -o block.las --polygon '389400,5819700;389500,5819720;389480,5819800'\n"
    "  scancast export town.scan -o - --format csv | head\n"
    "  scancast ingest town.las -o town.scan --exact && scancast export town.scan -o again.las  # the same "
    "records\n";

}  // namespace

void addExport(CLI::App& app, int& exitCode) {
    const auto arguments = std::make_shared<ExportArguments>();
    CLI::App* command =
        app.add_subcommand("export", "Write the points of a cloud file or a scan as LAS, PLY or text");
    command
        ->add_option("cloud", arguments->input,
                     "The cloud file (a file, or a URL: https://, s3://), or a scan")
        ->required()
        ->type_name("CLOUD");
    command
        ->add_option("-o,--output", arguments->output,
                     "File to write: LAS (.las), PLY (.ply), CSV (.csv) or space-separated text (.txt, "
                     ".xyz); - for standard output")
        ->required()
        ->type_name("FILE");
    command
        ->add_option("--format", arguments->format,
                     "las (1.4, in the point format that the attributes need), ply (binary, doubles), csv or "
                     "txt. Default: what the file's name says")
        ->check(CLI::IsMember({"las", "ply", "csv", "txt"}))
        ->type_name("FORMAT");
    arguments->region.addTo(*command);
    command->add_flag("--normals", arguments->normals,
                      "Also write the normals that ingest estimated; a scan's own are always written");
    addImporterFlags(*command, arguments->importer, false);
    command->add_flag("-f,--force", arguments->force, "Replace the file if it exists");
    command->add_flag("-q,--quiet", arguments->quiet,
                      "No progress and no list of differences on standard error");
    command->footer(exportFooter);
    command->callback([arguments, &exitCode] {
        const auto done = runExport(*arguments);
        exitCode = done ? 0 : 1;
        if (!done) tell("scancast export: {}\n", done.error().message);
    });
}

}  // namespace scancast
