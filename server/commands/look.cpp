// `scancast look`: how a cloud is shown when nobody says anything, and why.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/look/decide_look.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "server/commands/command.hpp"
#include "server/commands/open_any.hpp"
#include "server/commands/terminal.hpp"

namespace scancast {
namespace {

struct LookArguments {
    std::string file, set;
};

Expected<void> runLook(const LookArguments& arguments) {
    auto cloud = openAny(arguments.file, {});
    if (!cloud) return passOn(cloud);
    const auto look = (*cloud)->look ? Expected<Look>(*(*cloud)->look) : decideLook(**cloud);
    if (!look) return passOn(look);
    return print(toJson(*look).dump(2) + "\n");
}

}  // namespace

void addLook(CLI::App& app, int& exitCode) {
    const auto arguments = std::make_shared<LookArguments>();
    auto* command = app.add_subcommand("look", "Show or change how a cloud is shown at first, and why");
    command->footer(
        "Examples:\n"
        "  scancast look town.scan > town.json       # as it is, or would be decided\n"
        "  scancast look town.scan --set town.json   # from now on like this\n"
        "  scancast look town.scan --decide          # forget it and look again");
    command->add_option("file", arguments->file, "The cloud file or the scan")->required();
    command->callback([arguments, &exitCode] {
        if (auto done = runLook(*arguments); !done) {
            tell("scancast look: {}\n", done.error().message);
            exitCode = 1;
        }
    });
}

}  // namespace scancast
