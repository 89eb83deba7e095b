#include "server/commands/scans/scan_arguments.hpp"

namespace scancast {

void addVerbose(CLI::App& app, bool& verbose) {
    app.add_flag("--verbose", verbose, "List each file in a folder that is not a scan");
}

void addFilesAsOne(CLI::App& app, std::vector<std::string>& files, bool& verbose) {
    app.add_option("file", files,
                   "A cloud file (also behind a URL: https://, s3://) or a scan; several scans, or a folder "
                   "of them, are "
                   "taken as one")
        ->required()
        ->type_name("FILE");
    addVerbose(app, verbose);
}

}  // namespace scancast
