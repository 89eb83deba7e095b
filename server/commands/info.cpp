// `scancast info`: what is in a cloud file or a scan, and whether it is sound.
#include <memory>
#include <nlohmann/json.hpp>

#include "protocol/text/plain_text.hpp"
#include "server/commands/command.hpp"
#include "server/commands/file_info.hpp"
#include "server/commands/info_print.hpp"
#include "server/commands/scans/found_scans.hpp"
#include "server/commands/scans/scan_arguments.hpp"
#include "server/terminal/progress_bar.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

using Json = nlohmann::ordered_json;

struct InfoArguments {
    std::vector<std::string> files;
    bool json = false, check = false, quiet = false, verbose = false;
};

/// Every file is told of, whatever the others are like. False when one of them cannot be read or is damaged.
bool runInfo(const InfoArguments& arguments) {
    bool sound = true;
    RemoteFiles remote{RemoteOptions()};
    Json all{{"files", Json::array()}};
    ProgressBar bar(stderr, arguments.quiet ? ProgressBar::Style::Quiet : ProgressBar::Style::Automatic);
    const auto failed = [&](const std::string& file, const Error& error) {
        sound = false;
        tell("scancast info: {}\n", error.message);
        if (arguments.json)
            all["files"].push_back(Json{{"file", shownArgument(file)},
                                        {"error", {{"code", name(error.code)}, {"message", error.message}}}});
    };
    const auto describe = [&](const std::string& file) {
        const auto info = isRemoteUrl(file) ? remoteInfo(remote, file, arguments.check, bar.sink())
                                            : fileInfo(file, arguments.check, bar.sink());
        bar.clear();
        if (!info) return failed(file, info.error());
        sound = sound && info->damaged.empty();
        if (arguments.json)
            all["files"].push_back(infoJson(*info));
        else
            sound = bool(print(infoText(*info))) && sound;
    };
    FoundScans found({.urls = true});
    for (const std::string& argument : arguments.files) {
        const std::size_t before = found.files().size();
        if (auto ok = found.add(argument); !ok) failed(argument, ok.error());
        for (std::size_t i = before; i < found.files().size(); ++i) describe(found.files()[i]);
    }
    if (!arguments.quiet) tellLeftOut(found, arguments.verbose);
    if (arguments.json)
        sound =
            bool(print(plainJson(all.dump(2, ' ', false, Json::error_handler_t::replace)) + "\n")) && sound;
    return sound;
}

}  // namespace

void addInfo(CLI::App& app, int& exitCode) {
    const auto arguments = std::make_shared<InfoArguments>();
    auto* command = app.add_subcommand("info", "Describe a cloud file or a scan");
    command->footer(
        "Exit code: 0, or 1 when a file cannot be read or is damaged.\n"
        "Examples:\n"
        "  scancast info town.scan\n"
        "  scancast info --check *.scan          # read every block and verify its checksum\n"
        "  scancast info flight/                 # every scan in the folder, and beneath it\n"
        "  scancast info s3://scans/town.scan    # a cloud file in object storage; https:// as well\n"
        "  scancast info --json flight.laz       # docs/info.md describes the object");
    command
        ->add_option("files", arguments->files,
                     "Cloud files (also behind a URL), scans, folders of them, or patterns")
        ->type_name("FILE")
        ->required();
    command->add_flag("--json", arguments->json, "Print one JSON object instead of text");
    command->add_flag("--check", arguments->check,
                      "Verify every block of a cloud file; read a scan to its end");
    command->add_flag("-q,--quiet", arguments->quiet, "No progress on standard error");
    addVerbose(*command, arguments->verbose);
    command->callback([arguments, &exitCode] { exitCode = runInfo(*arguments) ? 0 : 1; });
}

}  // namespace scancast
