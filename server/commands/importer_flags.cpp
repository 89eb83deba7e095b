#include "server/commands/importer_flags.hpp"

#include "renderer/cloud/import/stream/sandbox_report.hpp"
#include "server/base/byte_size.hpp"

namespace scancast {

CLI::Option* addAssumeCrs(CLI::App& app, std::string& crs) {
    return app
        .add_option("--assume-crs", crs,
                    "Coordinate reference system of every scan, whatever the scan itself says: EPSG:25832, "
                    "or a complete WKT. Coordinates stay as they are")
        ->type_name("CRS");
}

Expected<std::optional<AssumedCrs>> assumedCrs(const std::string& crs) {
    if (crs.empty()) return std::nullopt;
    auto parsed = parseCrs(crs);
    if (!parsed)
        return fail(parsed.error().code, "--assume-crs: " + parsed.error().message + ".", "assume-crs");
    return std::move(*parsed);
}

void addImporterFlags(CLI::App& app, ImporterFlags& flags, bool environment) {
    const auto flag = [&](const char* name, auto& value, const char* variable, const char* meaning) {
        auto* const option = app.add_option(name, value, meaning)->capture_default_str();
        return environment ? option->envname(variable) : option;
    };
    flag("--importer-sandbox", flags.sandbox, "SCANCAST_IMPORTER_SANDBOX",
         "LAZ, E57, EPT, Potree, PLY and PCD are read by separate programs, importers, which are kept away "
         "from other files, the network and other processes: auto, as far as this machine can; require, "
         "completely, or such files are not read; off, not at all")
        ->type_name("MODE")
        ->check(CLI::IsMember({"auto", "require", "off"}));
    flag("--importer-memory", flags.memory, "SCANCAST_IMPORTER_MEMORY",
         "The most memory for each importer, such as 4G")
        ->type_name("SIZE");
    flag("--importer-time", flags.time, "SCANCAST_IMPORTER_TIME",
         "The most processor time for each importer, in seconds")
        ->type_name("SECONDS")
        ->check(CLI::Range(std::uint64_t(1), std::uint64_t(10'000'000)));
    flag("--importer-silence", flags.silence, "SCANCAST_IMPORTER_SILENCE",
         "Stop an importer that has neither sent a byte nor read from its file for this many seconds")
        ->type_name("SECONDS")
        ->check(CLI::Range(1, 86400));
    auto* const crs = addAssumeCrs(app, flags.assumeCrs);
    if (environment) crs->envname("SCANCAST_ASSUME_CRS");
}

Expected<ImportOptions> importOptions(const ImporterFlags& flags) {
    constexpr std::uint64_t least = 64 << 20;
    const auto memory = parseByteSize(flags.memory, "importer-memory");
    if (!memory) return passOn(memory);
    if (*memory < least)
        return fail(ErrorCode::InvalidArgument,
                    "--importer-memory: 64M is the least that an importer starts with.", "importer-memory");
    auto crs = assumedCrs(flags.assumeCrs);
    if (!crs) return passOn(crs);
    ImportOptions options;
    options.assumeCrs = std::move(*crs);
    options.importerMemoryLimit = *memory;
    options.importerProcessorSeconds = flags.time;
    options.importerSilenceSeconds = flags.silence;
    options.importerSandbox = flags.sandbox == "require" ? ImporterSandbox::Require
                              : flags.sandbox == "off"   ? ImporterSandbox::Off
                                                         : ImporterSandbox::Auto;
    return options;
}

SandboxLine sandboxLine(const ImportOptions& options) {
    if (options.importerSandbox == ImporterSandbox::Off)
        return {false,
                "importers are not shut in (--importer-sandbox=off): they can do what this program can"};
    const auto report = askSandbox(options);
    if (!report) return {false, "importers cannot be started: " + report.error().message};
    if (report->complete) return {true, "importers are shut in: " + report->text};
    const char* const end = options.importerSandbox == ImporterSandbox::Require
                                ? "; with --importer-sandbox=require, what needs one is not read"
                                : "";
    return {false, "importers are not shut in completely: " + report->text + end};
}

}  // namespace scancast
