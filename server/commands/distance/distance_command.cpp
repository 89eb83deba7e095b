// `scancast distance`: a cloud once more, with the distance of each point to another epoch of the same place.
#include "server/commands/distance/distance_command.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <memory>
#include <string>

#include "protocol/text/grouped.hpp"
#include "protocol/text/plain_text.hpp"
#include "protocol/view/view_values.hpp"
#include "remote/remote_url.hpp"
#include "renderer/cloud/distance/epoch_distance.hpp"
#include "server/base/byte_size.hpp"
#include "server/commands/making_flags.hpp"
#include "server/terminal/interruption.hpp"
#include "server/terminal/progress_bar.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

struct DistanceArguments : MakingFlags {
    std::string after, before, name = "distance", shift;
    double most = 5;
};

Expected<DistanceOptions> distanceOptions(const DistanceArguments& arguments) {
    for (const std::string* input : {&arguments.after, &arguments.before})
        if (isRemoteUrl(*input))
            return fail(
                ErrorCode::InvalidArgument,
                shownArgument(*input) + ": distances are measured between files; download a copy of it.");
    DistanceOptions options;
    options.after = arguments.after;
    options.before = arguments.before;
    options.output = arguments.output;
    options.name = arguments.name;
    options.most = arguments.most;
    options.threads = arguments.threads;
    if (!arguments.shift.empty()) {
        const auto shift = values::parse<glm::dvec3>(arguments.shift);
        if (!shift)
            return fail(ErrorCode::InvalidArgument,
                        fmt::format("--shift {}: {}", arguments.shift, shift.error()), "shift");
        options.shift = *shift;
    }
    const auto limit = memoryLimitOf(arguments);
    if (!limit) return passOn(limit);
    options.memoryLimit = *limit;
    if (auto ok = checkOutput(arguments); !ok) return passOn(ok);
    return options;
}

void tellMeasured(const DistanceArguments& arguments, const DistanceReport& report) {
    const double points = double(report.points);
    const std::string unit = report.unit.empty() ? "" : " " + report.unit;
    tell("{}: {}, {}, {:.1f} s ({:.2f} M points/s)\n", arguments.output, counted(report.points, "point"),
         byteSizeText(report.fileBytes), report.seconds, points / std::max(report.seconds, 1e-9) / 1e6);
    const double usual = (*report.column.usual)[1];
    tell(
        "column {}{}: half of the points are within {:.3g}, 99 % within {:.3g}; {} ({:.2f} %) {} {:g} away "
        "or more\n",
        report.column.column.name, unit.empty() ? "" : " [" + unit.substr(1) + "]", report.median, usual,
        counted(report.beyond, "point"), 100 * double(report.beyond) / points,
        report.beyond == 1 ? "is" : "are", arguments.most);
    for (const std::string& remark : report.remarks) tell("{}.\n", remark);
    tell("To look at it: scancast serve {}, then color=column:{}&range=0,{:g}\n", arguments.output,
         report.column.column.name, arguments.most);
}

Expected<void> runDistance(const DistanceArguments& arguments) {
    // Trees and leaves come and go: their memory goes back when they do, or the limit would be kept in name only.
    ::mallopt(M_ARENA_MAX, 4);
    ::mallopt(M_MMAP_THRESHOLD, 1 << 20);
    ::mallopt(M_TRIM_THRESHOLD, 64 << 20);
    const auto options = distanceOptions(arguments);
    if (!options) return passOn(options);
    const Interruption interruption;
    ProgressBar bar(stderr, arguments.quiet ? ProgressBar::Style::Quiet : ProgressBar::Style::Automatic);
    const auto report = measureDistance(*options, bar.sink(), interruption.token());
    bar.clear();
    if (!report && report.error().code == ErrorCode::Cancelled)
        return fail(ErrorCode::Cancelled, "Interrupted; no cloud file was left behind.");
    if (!report) return passOn(report);
    if (!arguments.quiet) tellMeasured(arguments, *report);
    return {};
}

constexpr const char* distanceFooter =
    "Both epochs are cloud files; of scans, scancast ingest makes some (with --exact, points are where the "
    "scan "
    "has them to the last bit; without, a few are rounded to a fraction of their spacing). The new file is "
    "AFTER "
    "with all that it has, and a column of distances, in the file's unit: exact, from each point to the "
    "nearest point of BEFORE. What differs is what is new: for what has gone, measure the other way round as "
    "well. Coordinate reference systems that differ are refused. How to look at it: docs/epochs.md\n"
    "Examples:\n"
    "  scancast distance 2024.scan 2019.scan -o changes.scan\n"
    "  scancast distance 2024.scan 2019.scan -o changes.scan --max 0.5 --shift 0.02,-0.01,0.15\n"
    "  scancast serve changes.scan       # and look with color=column:distance&range=0,0.5\n";

}  // namespace

void addDistance(CLI::App& app, int& exitCode) {
    const auto arguments = std::make_shared<DistanceArguments>();
    CLI::App* command = app.add_subcommand(
        "distance", "Measure how far each point of a cloud is from another epoch, and keep that as a column");
    command->add_option("after", arguments->after, "The cloud file whose points get distances")
        ->required()
        ->type_name("AFTER");
    command->add_option("before", arguments->before, "The cloud file that they are measured to")
        ->required()
        ->type_name("BEFORE");
    addOutputFlag(*command, *arguments);
    command->add_option("--name", arguments->name, "What the column is called: letters, digits, _")
        ->capture_default_str()
        ->type_name("NAME");
    command
        ->add_option(
            "--max", arguments->most,
            "Distance up to which is looked, in the file's unit: what is farther away has this value")
        ->capture_default_str()
        ->type_name("LENGTH");
    command
        ->add_option("--shift", arguments->shift,
                     "Added to the coordinates of BEFORE, for epochs that are known to lie beside each other")
        ->type_name("DX,DY,DZ");
    addMakingFlags(*command, *arguments);
    command->footer(distanceFooter);
    command->callback([arguments, &exitCode] {
        const auto done = runDistance(*arguments);
        exitCode = done ? 0 : 1;
        if (!done) {
            const std::string& message = done.error().message;
            tell("scancast distance: {}{}\n", message, message.ends_with('.') ? "" : ".");
        }
    });
}

}  // namespace scancast
