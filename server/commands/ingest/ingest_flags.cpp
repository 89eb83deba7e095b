#include "server/commands/ingest/ingest_flags.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "protocol/text/grouped.hpp"
#include "renderer/cloud/import/standard_input.hpp"
#include "renderer/look/keep_look.hpp"
#include "server/base/byte_size.hpp"
#include "server/commands/label_flags.hpp"
#include "server/commands/look_file.hpp"
#include "server/commands/scans/found_scans.hpp"
#include "server/commands/scans/open_in_turn.hpp"
#include "server/commands/scans/scan_arguments.hpp"
#include "server/terminal/progress_bar.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {

namespace {

namespace fs = std::filesystem;

using Clock = std::chrono::steady_clock;

}  // namespace

void returnMemoryOfChunks() {
    ::mallopt(M_ARENA_MAX, 4);
    ::mallopt(M_MMAP_THRESHOLD, 4 << 20);
    ::mallopt(M_TRIM_THRESHOLD, 64 << 20);
}

Expected<IngestOptions> ingestOptions(const IngestArguments& arguments,
                                      const std::vector<std::string>& files) {
    IngestOptions options;
    options.output = arguments.output;
    options.scratch = arguments.scratch;
    options.title = arguments.title;
    options.attribution = arguments.attribution;
    options.recorded = arguments.recorded;
    options.threads = arguments.threads;
    options.photos = !arguments.noPhotos;
    options.shape.surfels = !arguments.noSurfels;
    options.shape.curvature = !arguments.noCurvature;
    options.shape.exact = arguments.exact;
    options.shape.neighbours = arguments.neighbours;
    options.shape.orientation = arguments.orient == "up"     ? Orientation::Up
                                : arguments.orient == "scan" ? Orientation::Scan
                                                             : Orientation::Auto;
    const auto limit = memoryLimitOf(arguments);
    if (!limit) return passOn(limit);
    options.memoryLimit = *limit;
    if (auto ok = checkOutput(arguments); !ok) return passOn(ok);
    std::error_code error;
    for (const std::string& input : files)
        if (fs::equivalent(input, options.output, error))
            return fail(ErrorCode::InvalidArgument, fmt::format("{} is both input and output.", input),
                        "output");
    return options;
}

Expected<ImportOptions> importOptions(const IngestArguments& arguments, const IngestOptions& options) {
    auto import = importOptions(arguments.importer);
    if (!import) return import;
    import->keepAttributes = arguments.keepAttributes || arguments.exact;
    import->exact = arguments.exact;
    import->recover = arguments.recover;
    if (!arguments.noPhotos) import->photos = scratchFolder(options);
    return import;
}

Expected<std::vector<std::unique_ptr<PointSource>>> openAll(const std::vector<std::string>& files,
                                                            IngestOptions& options,
                                                            const ImportOptions& import) {
    std::vector<std::unique_ptr<PointSource>> sources;
    const auto add = [&](Expected<std::unique_ptr<PointSource>> source) -> Expected<void> {
        if (!source) return passOn(source);
        sources.push_back(std::move(*source));
        return {};
    };
    options.names = files;
    std::ranges::replace(options.names, std::string("-"), std::string("standard input"));
    for (const std::string& name : files) {
        if (name == "-") {
            if (auto ok = add(openStandardInput(import)); !ok) return passOn(ok);
            continue;
        }
        const auto input = ScanInput::open(name);
        if (!input) return passOn(input);
        const auto mirrors = input->mirrors();
        if (!mirrors) return passOn(mirrors);
        options.mirrors.insert(options.mirrors.end(), mirrors->begin(), mirrors->end());
        const bool isNext = sources.empty();  // its turn is now
        if (auto ok = add(isNext ? openScan(*input, import) : openInTurn(*input, import)); !ok)
            return passOn(ok);
    }
    return sources;
}

void tellNeeds(const std::vector<std::unique_ptr<PointSource>>& sources, const IngestOptions& options) {
    DiskNeeds sum;
    std::uint64_t points = 0;
    for (const auto& source : sources) {
        const auto needs = diskNeeds(source->header(), options);
        if (!needs) return;
        points += *source->header().points;
        sum.file += needs->file;
        sum.scratch += needs->scratch;
    }
    tell("{} points: the cloud file will need up to {}{}\n", shortCount(double(points)),
         byteSizeText(sum.file),
         sum.scratch > 0 ? fmt::format(", temporary files up to {}", byteSizeText(sum.scratch)) : "");
}

Expected<nlohmann::json> lookOf(const IngestArguments& arguments) {
    return arguments.look.empty() ? Expected<nlohmann::json>(nlohmann::json()) : readLookFile(arguments.look);
}

Expected<void> keepLookOf(const IngestArguments& arguments, const nlohmann::json& changes) {
    const auto start = Clock::now();
    const auto look = decideAndKeepLook(arguments.output, changes);
    if (!look && look.error().code == ErrorCode::InvalidArgument) return passOn(look);
    if (arguments.quiet) return {};
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (!look)
        tell("How to show it at first could not be decided: {}\n", look.error().message);
    else
        tell("{}, first seen {}. {} (decided in {:.1f} s)\n", name(look->kind), look->views.front().name,
             look->reason, seconds);
    return {};
}

tl::unexpected<Error> withRecovery(Error error, bool recover) {
    // Some readers know better themselves whether it is of use.
    const bool said = error.message.find("--recover") != std::string::npos;
    if (error.code == ErrorCode::Truncated && !recover && !said)
        error.message +=
            ". With --recover, what is whole of LAS, LAZ, E57, PLY, PCD and text is read, and how much is "
            "lost is told";
    return tl::unexpected(std::move(error));
}

void tellIngested(const IngestArguments& arguments, const IngestReport& report, double seconds) {
    const double points = double(report.facts.points);
    tell("{}: {} in {}, {} ({:.1f} bytes per point), {:.1f} s ({:.2f} M points/s)\n", arguments.output,
         counted(report.facts.points, "point"), counted(report.nodes, "node"), byteSizeText(report.fileBytes),
         double(report.fileBytes) / points, seconds, points / seconds / 1e6);
    for (const std::string& remark : remarksOn(report.facts)) tell("{}\n", remark);
}

void addIngestFlags(CLI::App& command, IngestArguments& arguments, const std::string& memory,
                    const std::string& threads) {
    command
        .add_option("inputs", arguments.inputs,
                    "Scans, folders of them, or patterns such as 'flight/*.laz', all merged into one cloud; "
                    "- reads LAS from standard input")
        ->required()
        ->type_name("INPUT");
    addOutputFlag(command, arguments);
    command
        .add_option("--scratch", arguments.scratch,
                    "Folder for temporary files. Default: that of the cloud file")
        ->type_name("DIR");
    command
        .add_option("--title", arguments.title, "The title that people see. Default: the cloud file's name")
        ->type_name("TEXT");
    addLabelFlags(command, arguments.attribution, arguments.recorded);
    command.add_flag(
        "--no-surfels", arguments.noSurfels,
        "Do not estimate normals and radii from neighbours: much faster, but without the methods that "
        "need them");
    command.add_flag("--no-curvature", arguments.noCurvature,
                     "Do not store curvature: a smaller file, but no color=curvature");
    command.add_flag(
        "--no-photos", arguments.noPhotos,
        "Leave out the photos that come with scans (E57): a smaller file, but no photos to look at");
    command
        .add_option("--neighbours", arguments.neighbours,
                    "Number of neighbours from which normals and radii are estimated")
        ->check(CLI::Range(3, 40))
        ->capture_default_str()
        ->type_name("K");
    command
        .add_option("--orient", arguments.orient,
                    "Which way estimated normals point. auto: towards the scanner that saw the point, if "
                    "the scan says where it stood; otherwise to the side that neighbours agree on, if they "
                    "do. scan: the same, but otherwise undecided. up: upwards, for scans from the air")
        ->check(CLI::IsMember({"auto", "scan", "up"}))
        ->capture_default_str()
        ->type_name("SIDE");
    command.add_flag("--keep-attributes", arguments.keepAttributes,
                     "Also keep attributes that are not drawn: GPS time, returns, extra bytes");
    command.add_flag(
        "--exact", arguments.exact,
        "Keep everything exactly as it was, in a larger file: every attribute, positions to the last step of "
        "their grid, 16-bit colours. scancast export then writes LAS with identical records");
    command.add_flag("--recover", arguments.recover,
                     "Of scans that end too early - a copy was cut, a disk was full - read what is whole, "
                     "and tell how much is "
                     "lost; without, they are refused. LAS, LAZ (not COPC), PLY, PCD (not compressed) and "
                     "text. E57, whose "
                     "pages have checksums, also where it is damaged");
    command
        .add_option("--look", arguments.look,
                    "How to show the cloud at first: JSON with whatever should differ from the automatic "
                    "look (scancast look prints one)")
        ->type_name("FILE");
    addImporterFlags(command, arguments.importer, false);
    addMakingFlags(command, arguments, memory, threads);
    addVerbose(command, arguments.verbose);
}

}  // namespace scancast
