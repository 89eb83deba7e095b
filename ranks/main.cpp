// `scancast-ranks`: the work of `scancast` by several processes, on one machine or many, started together by mpirun. One
// subcommand for each thing that they do; each starts MPI itself, so that --help needs none.
#include <CLI/CLI.hpp>
#include <sstream>

#include "files/program_start.hpp"
#include "protocol/flags/exit_codes.hpp"
#include "ranks/commands.hpp"
#include "ranks/mpi/session.hpp"
#include "server/server.hpp"
#include "server/terminal/terminal.hpp"

int main(int argc, char** argv) {
    scancast::startProgram();
    CLI::App app{
        "Scancast by several processes that work together, on one machine or many: ranks, started by "
        "mpirun."};
    app.set_version_flag("--version", "scancast-ranks " + std::string(scancast::scancastVersion()));
    app.footer("Example: mpirun -n 4 --bind-to none scancast-ranks ingest flight/ -o flight.scan\n" +
               std::string(scancast::exitCodesText));
    app.require_subcommand(0, 1);
    int exitCode = 0;
    scancast::addRanksCommands(app, exitCode);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        std::ostringstream asked, complaint;
        const bool wasAsked = app.exit(error, asked, complaint) == 0;
        if (!scancast::isFirstOfMany()) return wasAsked ? 0 : scancast::exitUsage;
        scancast::tellText(complaint.str());
        return !scancast::print(asked.str()) ? 1 : wasAsked ? 0 : scancast::exitUsage;
    }
    if (app.get_subcommands().empty()) {
        if (scancast::isFirstOfMany()) scancast::tellText(app.help());
        exitCode = scancast::exitUsage;
    }
    return exitCode;
}
