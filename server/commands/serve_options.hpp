// What `scancast serve` can be told, and the rules between the options. Flag > environment (SCANCAST_…) >
// configuration file (config_file.hpp) > default.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "renderer/device/device.hpp"
#include "server/catalog/live_source.hpp"
#include "server/commands/importer_flags.hpp"
#include "server/server.hpp"

namespace scancast {

struct ServeOptions {
    std::vector<std::filesystem::path> files;  ///< as they were named, until findFiles()
    std::vector<std::string> named;            ///< what findFiles() found them by
    std::vector<std::string> live;             ///< NAME=PATH of sources of clouds that change
    ServerOptions server;
    DeviceOptions device;
    bool insecure = false;
    std::filesystem::path authTokenFile, adminTokenFile, guestKeyFile, sessionKeyFile;  ///< empty = none
    std::filesystem::path
        catalog;           ///< a folder, or a URL, whose clouds are served as they come and go; empty = none
    int drainSeconds = 0;  ///< for which clients are given time to go to another server
    std::size_t maxConnections = 0;  ///< 0 = what sessions need, and short requests
    std::string adminListen;         ///< as written: "127.0.0.1:9090"; empty = nowhere
    std::vector<std::string> trustedProxies;
    std::string memoryLimit;         ///< as written: "2G"; empty = half of the machine's memory
    std::string transientLimit;      ///< as written; empty = a fixed share of memoryLimit
    std::string gpuMemoryLimit;      ///< as written; empty = most of what the GPU has free
    std::filesystem::path rates;     ///< a file in place of the shipped ones; empty = none
    std::filesystem::path cacheDir;  ///< empty = built anew with every start
    std::string cacheSize;           ///< as written; empty = a tenth of the disk that cacheDir is on
    ImporterFlags importer;
    int importers = 2;             ///< at once
    bool noSurfels = false;        ///< scans are built without normals and radii
    bool native = false;           ///< scans that can be are shown as they are
    std::filesystem::path config;  ///< empty = none
    bool checkConfig = false;      ///< say what holds, and serve nothing
    std::string logLevel = "info";
    std::string logFormat = "text";
    std::string requestLog = "on";
};

/// `options` must outlive the parse.
void addServeFlags(CLI::App& app, ServeOptions& options);

/// Puts what `files` name - files, folders, patterns - in their place, as they are now; again, when it is called again. What
/// in folders is no scan is logged. Errors: those of findScans(), and nothing has changed then.
Expected<void> findFiles(ServeOptions& options);

/// What no single flag can know. InvalidArgument: an address that needs a token or --insecure, an origin that is none,
/// connections that do not fit.
Expected<void> checkFlags(const ServeOptions& options);
/// The same, and that there is something to serve: a file, a live source, a catalog or a data root.
Expected<void> check(const ServeOptions& options);

/// What --live names. InvalidArgument for what is not NAME=PATH, and for a path that is named twice.
Expected<std::vector<LiveInput>> liveInputs(const ServeOptions& options);

/// --cache-size, bytes; 0 when it was not given. InvalidArgument when it is no size, or there is no --cache-dir.
Expected<std::uint64_t> cacheSize(const ServeOptions& options);

/// How --cache-size, or a tenth of the disk, is shared: half of it is for pieces of clouds behind URLs, where one is named at the
/// start.
struct CacheShares {
    std::uint64_t scans = 0;   ///< cloud files that scans are kept in; 0 = the usual part of the disk
    std::uint64_t pieces = 0;  ///< 0 = none are kept
};
/// Of options that check() has found sound.
CacheShares cacheShares(const ServeOptions& options);

/// What --rates holds, or the shipped ones; an error names the file.
Expected<Rates> rates(const ServeOptions& options);

/// Of --memory-limit, bytes: settled at the start, whatever the load.
struct MemoryShares {
    std::uint64_t clouds = 0;     ///< blocks of cloud files and scans that were read
    std::uint64_t transient = 0;  ///< pictures, and what clients have not read (--transient-limit)
};
/// InvalidArgument when a limit is none, or leaves too little to draw anything.
Expected<MemoryShares> memoryShares(const ServeOptions& options);

/// What --request-log, --log-level and --log-format say together.
Expected<RequestLogOptions> requestLog(const ServeOptions& options);

/// How many connections there may be: --max-connections, or what goes with --max-sessions. Raises the limit of open
/// files where it must. InvalidArgument when they do not fit.
Expected<std::size_t> maxConnections(const ServeOptions& options);

/// --admin-listen; empty when it was not given. InvalidArgument when it is none.
Expected<std::optional<ListenAddress>> adminListen(const ServeOptions& options);

/// What --auth-token-file, --admin-token-file, --guest-key-file and --session-key-file hold; an error names the flag, and never a token. InvalidArgument, too,
/// where one secret is good for two things that it must not be.
Expected<AccessTokens> accessTokens(const ServeOptions& options);

/// "localhost", 127.x.x.x, "::1".
bool isLoopbackHost(const std::string& host);

}  // namespace scancast
