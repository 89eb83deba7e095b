// `scancast label`: what stands beside a cloud's pictures - its title, whom to name, when it was scanned.
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "protocol/text/plain_text.hpp"
#include "remote/remote_url.hpp"
#include "renderer/cloud/file/change_facts.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "server/commands/command.hpp"
#include "server/commands/label_flags.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

struct LabelArguments {
    std::string file;
    std::optional<std::string> title, attribution, recorded;
    bool changes() const { return title || attribution || recorded; }
};

std::string labelText(const CloudFacts& facts) {
    const auto said = [](const std::string& text) { return text.empty() ? "(not known)" : plainText(text); };
    return fmt::format("title        {}\nattribution  {}\nrecorded     {}\n", said(facts.title),
                       said(facts.attribution), said(facts.recorded));
}

Expected<void> runLabel(const LabelArguments& arguments) {
    if (isRemoteUrl(arguments.file))
        return fail(ErrorCode::InvalidArgument,
                    shownArgument(arguments.file) + ": this reads and changes files; download a copy of it.");
    if (arguments.changes()) {
        auto changed = changeFacts(arguments.file, [&](CloudFacts& facts) -> Expected<void> {
            if (arguments.title) facts.title = *arguments.title;
            if (arguments.attribution) facts.attribution = *arguments.attribution;
            if (arguments.recorded) facts.recorded = *arguments.recorded;
            return {};
        });
        if (!changed) return changed;
    }
    const auto opened = CloudFile::open(arguments.file);
    return opened ? print(labelText((*opened)->facts())) : Expected<void>(passOn(opened));
}

}  // namespace

void addLabel(CLI::App& app, int& exitCode) {
    const auto arguments = std::make_shared<LabelArguments>();
    auto* command = app.add_subcommand("label", "Show or change a cloud's title, attribution and date");
    command->footer(
        "The page shows them beside the cloud. The file is changed in place and no block is rewritten; '' "
        "removes one.\n"
        "Examples:\n"
        "  scancast label town.scan\n"
        "  scancast label town.scan --title 'Old town' --attribution 'City of Graz, CC BY 4.0' --recorded "
        "2024-05");
    command->add_option("file", arguments->file, "The cloud file")->type_name("FILE")->required();
    command->add_option("--title", arguments->title, "What people see in lists and above the picture")
        ->type_name("TEXT");
    addLabelFlags(*command, arguments->attribution, arguments->recorded);
    command->callback([arguments, &exitCode] {
        if (auto done = runLabel(*arguments); !done) {
            tell("scancast label: {}\n", done.error().message);
            exitCode = 1;
        }
    });
}

}  // namespace scancast
