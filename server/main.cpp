// `scancast`: one program, one subcommand for each thing that it does.
#include <CLI/CLI.hpp>
#include <sstream>

#include "files/program_start.hpp"
#include "protocol/flags/exit_codes.hpp"
#include "renderer/device/device.hpp"
#include "server/commands/access/access_commands.hpp"
#include "server/commands/backends.hpp"
#include "server/commands/command.hpp"
#include "server/commands/distance/distance_command.hpp"
#include "server/commands/doctor/doctor_command.hpp"
#include "server/commands/export/export.hpp"
#include "server/commands/importer_flags.hpp"
#include "server/commands/rasters/rasters.hpp"
#include "server/server.hpp"
#include "server/terminal/terminal.hpp"

int main(int argc, char** argv) {
    scancast::startProgram();
    CLI::App app{"Scancast holds huge scanned point clouds in memory and shows any view of them."};
    app.set_version_flag("--version", "scancast " + std::string(scancast::scancastVersion()));
    app.footer("Example: scancast serve town.las   (then open http://127.0.0.1:8080/)\n" +
               std::string(scancast::exitCodesText));
    bool backends = false;
    app.add_flag("--list-backends", backends,
                 "List what this machine can render with, best first, and what importers are sandboxed by");
    app.require_subcommand(0, 1);
    int exitCode = 0;
    scancast::addServe(app, exitCode);
    scancast::addRender(app, exitCode);
    scancast::addIngest(app, exitCode);
    scancast::addExport(app, exitCode);
    scancast::addDistance(app, exitCode);
    scancast::addRasters(app, exitCode);
    scancast::addInfo(app, exitCode);
    scancast::addLook(app, exitCode);
    scancast::addLabel(app, exitCode);
    scancast::addGenerate(app, exitCode);
    scancast::addToken(app, exitCode);
    scancast::addDoctor(app, exitCode);
    scancast::addGuestLink(app, exitCode);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        // What it complains of may be the name of a file that looked like a flag.
        std::ostringstream asked, complaint;
        const bool wasAsked = app.exit(error, asked, complaint) == 0;
        scancast::tellText(complaint.str());
        return !scancast::print(asked.str()) ? 1 : wasAsked ? 0 : scancast::exitUsage;
    }
    if (backends) {
        exitCode = scancast::print(scancast::backendsText(scancast::listDevices()) +
                                   scancast::sandboxLine({}).text + "\n")
                       ? 0
                       : 1;
    } else if (app.get_subcommands().empty()) {
        scancast::tellText(app.help());
        exitCode = scancast::exitUsage;
    }
    return exitCode;
}
