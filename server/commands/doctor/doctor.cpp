// `scancast doctor`: whether `serve`, told the same, would find all that it needs; and if not, what to do.
#include <memory>

#include "server/commands/config_file.hpp"
#include "server/commands/doctor/checks.hpp"
#include "server/commands/doctor/doctor_command.hpp"
#include "server/commands/serve_options.hpp"
#include "server/server.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

struct DoctorArguments {
    ServeOptions serve;
    bool json = false;
};

int run(CLI::App& command, DoctorArguments& arguments) {
    ServeOptions& options = arguments.serve;
    Findings findings;
    findings.ok("version", std::string(scancastVersion()));
    if (!options.config.empty()) {
        if (auto applied = applyConfigFile(command, options.config); !applied)
            findings.fault(
                "configuration", applied.error().message,
                "scancast serve --help lists what may stand in it; what follows is about the rest");
        else
            findings.ok("configuration", options.config.string() + " is understood");
    }
    if (auto sound = checkFlags(options); !sound)
        findings.fault("flags", sound.error().message, "another value for what is named there");
    else
        findings.ok("flags", "each has a value that goes with the others");
    lookAtMachine(options, findings);
    lookAtEntrances(options, findings);
    lookAtFiles(options, findings);
    const auto printed = print(arguments.json ? findings.json() : findings.text());
    return printed && findings.sound() ? 0 : 1;
}

}  // namespace

void addDoctor(CLI::App& app, int& exitCode) {
    const auto arguments = std::make_shared<DoctorArguments>();
    CLI::App* command = app.add_subcommand(
        "doctor", "Check whether this machine has what serve needs, and say how to fix each problem");
    command->footer(
        "Takes what serve takes, and serves nothing. A line for each thing: ok; warning, with which it "
        "serves all\n"
        "the same; fault. Exit code: 0 without faults, whatever the warnings; 1 with them.\n"
        "Examples:\n"
        "  scancast doctor\n"
        "  scancast doctor --config /etc/scancast.json\n"
        "  scancast doctor town.scan --host 0.0.0.0 --auth-token-file token --json");
    addServeFlags(*command, arguments->serve);
    command->add_flag("--json", arguments->json, "Print one JSON object instead of text");
    command->callback([command, arguments, &exitCode] { exitCode = run(*command, *arguments); });
}

}  // namespace scancast
