// The flags of an ingest, and what they mean: of `scancast ingest`, and of `scancast-ranks ingest`, where several processes do the same.
// One table for both; used on the command's thread. Place: command line → **arguments** → sources, options.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "renderer/cloud/build/ingest.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "server/commands/importer_flags.hpp"
#include "server/commands/making_flags.hpp"

namespace scancast {

struct IngestArguments : MakingFlags {
    std::vector<std::string> inputs;
    std::string scratch, title, attribution, recorded, look, orient = "auto";
    ImporterFlags importer;
    int neighbours = 10;
    bool recover = false;
    bool noSurfels = false, noCurvature = false, noPhotos = false, keepAttributes = false, exact = false,
         verbose = false;
};

/// `arguments` must outlive the parse. `memory`, `threads`: what is said of those two flags.
void addIngestFlags(CLI::App& command, IngestArguments& arguments, const std::string& memory,
                    const std::string& threads);

/// Large blocks go back to the system when they are freed, or the limit would be kept in name only; small
/// ones are used again, for getting pages anew costs more than what is done in them.
void returnMemoryOfChunks();

/// Errors: InvalidArgument for an output that is there, or is an input, too.
Expected<IngestOptions> ingestOptions(const IngestArguments& arguments,
                                      const std::vector<std::string>& files);

/// How scans are read; without whoever stops it.
Expected<ImportOptions> importOptions(const IngestArguments& arguments, const IngestOptions& options);

/// Their mirrors go into the options, and their names.
Expected<std::vector<std::unique_ptr<PointSource>>> openAll(const std::vector<std::string>& files,
                                                            IngestOptions& options,
                                                            const ImportOptions& import);

/// How much disk it will take, where that is known.
void tellNeeds(const std::vector<std::unique_ptr<PointSource>>& sources, const IngestOptions& options);

/// The file of --look; null without.
Expected<nlohmann::json> lookOf(const IngestArguments& arguments);

/// How the cloud is shown at first is decided once it is whole. A cloud without is as good: it is decided whenever
/// it is opened.
Expected<void> keepLookOf(const IngestArguments& arguments, const nlohmann::json& changes);

/// What ends too early may be worth something all the same.
tl::unexpected<Error> withRecovery(Error error, bool recover);

/// What has become of it.
void tellIngested(const IngestArguments& arguments, const IngestReport& report, double seconds);

}  // namespace scancast
