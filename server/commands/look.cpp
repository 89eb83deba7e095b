// `scancast look`: how a cloud is shown when nobody says anything, and why; and how to change that.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "protocol/text/plain_text.hpp"
#include "remote/remote_url.hpp"
#include "renderer/look/decide_look.hpp"
#include "renderer/look/keep_look.hpp"
#include "server/commands/command.hpp"
#include "server/commands/importer_flags.hpp"
#include "server/commands/look_file.hpp"
#include "server/commands/open_any.hpp"
#include "server/commands/scans/scan_arguments.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

struct LookArguments {
    std::vector<std::string> files;
    std::string set, assumeCrs;
    bool decide = false, native = false, verbose = false;
};

Expected<void> runLook(const LookArguments& arguments) {
    const bool keeps = arguments.decide || !arguments.set.empty();
    if (keeps && isRemoteUrl(arguments.files.front()))
        return fail(ErrorCode::InvalidArgument,
                    shownArgument(arguments.files.front()) +
                        ": a look is kept in the file itself; change a copy of it, and upload that.");
    if (keeps && arguments.files.size() > 1)
        return fail(ErrorCode::InvalidArgument, "a look is kept in one cloud file; name one.");
    // What is wrong with it is said before a scan is read.
    if (!arguments.set.empty())
        if (const auto changes = readLookFile(arguments.set); !changes) return passOn(changes);
    const auto cloud =
        openAny(arguments.files,
                {.assumeCrs = arguments.assumeCrs, .native = arguments.native, .verbose = arguments.verbose});
    if (!cloud) return passOn(cloud);
    const bool known = (*cloud)->look && !arguments.decide;
    auto look = known ? Expected<Look>(*(*cloud)->look) : decideLook(**cloud);
    if (look && !arguments.set.empty()) look = changedLook(*look, arguments.set);
    if (!look) return passOn(look);
    if (!keeps) return print(plainJson(toJson(*look).dump(2)) + "\n");
    const std::string& file = arguments.files.front();
    if (auto kept = keepLook(file, *look); !kept) return kept;
    tell("{} is shown like this from now on: {}, first seen {}.\n", file, name(look->kind),
         look->views.front().name);
    return {};
}

}  // namespace

void addLook(CLI::App& app, int& exitCode) {
    const auto arguments = std::make_shared<LookArguments>();
    auto* command = app.add_subcommand("look", "Show or change how a cloud looks when it is opened");
    command->footer(
        "Without --set or --decide, prints the look as JSON (of a scan, the one that would be chosen); "
        "PROTOCOL.md describes it.\n"
        "Examples:\n"
        "  scancast look town.scan > town.json       # then change town.json: a camera, a colour, a method\n"
        "  scancast look town.scan --set town.json   # the file is changed in place, no block is rewritten\n"
        "  scancast look town.scan --decide          # forget that, and look at it again");
    addFilesAsOne(*command, arguments->files, arguments->verbose);
    auto* set =
        command->add_option("--set", arguments->set,
                            "Store this look in the cloud file: JSON, complete or only what should change");
    command
        ->add_flag("--decide", arguments->decide,
                   "Choose the look again automatically, and store it in the cloud file")
        ->excludes(set);
    command->add_flag("--native", arguments->native,
                      "Look at a scan in COPC or EPT as it is, without ingest: at its upper levels");
    addAssumeCrs(*command, arguments->assumeCrs);
    command->callback([arguments, &exitCode] {
        if (auto done = runLook(*arguments); !done) {
            tell("scancast look: {}\n", done.error().message);
            exitCode = 1;
        }
    });
}

}  // namespace scancast
