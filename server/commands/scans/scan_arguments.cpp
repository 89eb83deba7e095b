#include "server/commands/scans/scan_arguments.hpp"

namespace scancast {

void addVerbose(CLI::App& app, bool& verbose) {
    app.add_flag("--verbose", verbose, "Name each file of a folder that is no scan");
}

void addFilesAsOne(CLI::App& app, std::vector<std::string>& files, bool& verbose) {
    app.add_option("file", files, "The cloud file or the scan; a folder of scans, or several, as one")
        ->required()
        ->type_name("FILE");
    addVerbose(app, verbose);
}

}  // namespace scancast
