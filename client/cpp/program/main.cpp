// `scancast-client`: pictures and facts from a Scancast server, without a browser.
#include <sstream>
#include <string>

#include "client/cpp/program/command.hpp"
#include "client/cpp/program/say.hpp"
#include "files/program_start.hpp"
#include "protocol/flags/exit_codes.hpp"

int main(int argc, char** argv) {
    scancast::startProgram();
    CLI::App app{"Pictures and facts from a Scancast server"};
    app.set_version_flag("--version", "scancast-client " SCANCAST_VERSION);
    app.footer(
        "Examples:\n"
        "  scancast-client info http://127.0.0.1:8080/\n"
        "  scancast-client snapshot http://127.0.0.1:8080/ --method cone -o town.jpg\n"
        "  scancast-client orbit http://127.0.0.1:8080/ --frames 36 -o frames/\n"
        "  scancast-client points http://127.0.0.1:8080/ town --classes 6 -o roofs.las\n"
        "  scancast-client view http://127.0.0.1:8080/\n"
        "  scancast-client pick http://127.0.0.1:8080/ town --x 640 --y 360\n"
        "  scancast-client measure http://127.0.0.1:8080/ distance town --point 0,0,0 --point 3,4,0\n"
        "  scancast-client dem http://127.0.0.1:8080/ --cell 0.5 -o town-dem.tif\n"
        "The cloud stands behind the server's URL, or behind --cloud; without, it is the server's first one. "
        "Each "
        "subcommand has a --help of its own.\n" +
        std::string(scancast::exitCodesText));
    app.require_subcommand(1);
    int exitCode = 0;
    scancast::client::addSnapshot(app, exitCode);
    scancast::client::addOrbit(app, exitCode);
    scancast::client::addInfo(app, exitCode);
    scancast::client::addPath(app, exitCode);
    scancast::client::addPoints(app, exitCode);
    scancast::client::addProfile(app, exitCode);
    scancast::client::addView(app, exitCode);
    scancast::client::addBench(app, exitCode);
    scancast::client::addPick(app, exitCode);
    scancast::client::addMeasure(app, exitCode);
    scancast::client::addMap(app, exitCode);
    scancast::client::addLonLat(app, exitCode);
    scancast::client::addRasters(app, exitCode);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        std::ostringstream asked, complaint;
        exitCode = app.exit(error, asked, complaint) == 0 ? 0 : scancast::exitUsage;
        scancast::client::sayOn(stdout, "%s", asked.str().c_str());
        scancast::client::sayOn(stderr, "%s", complaint.str().c_str());
    }
    return exitCode;
}
