#include "server/commands/serve_options.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>

#include "files/input_file.hpp"
#include "files/machine.hpp"
#include "remote/remote_listing.hpp"
#include "server/base/byte_size.hpp"
#include "server/commands/scans/found_scans.hpp"
#include "server/net/clients/open_files.hpp"
#include "server/net/origin_check.hpp"

namespace scancast {

bool isLoopbackHost(const std::string& host) {
    in_addr address{};
    const bool isAddress = inet_pton(AF_INET, host.c_str(), &address) == 1;
    return host == "localhost" || host == "::1" || (isAddress && host.rfind("127.", 0) == 0);
}

Expected<AccessTokens> accessTokens(const ServeOptions& options) {
    AccessTokens tokens;
    const auto read = [](const std::filesystem::path& file, const char* flag, const char* usual,
                         std::vector<NamedToken>& list) -> Expected<void> {
        if (file.empty()) return {};
        auto named = readTokens(file, usual);
        if (!named)
            return fail(named.error().code, std::string("--") + flag + ": " + named.error().message, flag);
        list = std::move(*named);
        return {};
    };
    if (auto ok = read(options.authTokenFile, "auth-token-file", "user", tokens.users); !ok)
        return passOn(ok);
    if (auto ok = read(options.adminTokenFile, "admin-token-file", "admin", tokens.admins); !ok)
        return passOn(ok);
    if (auto ok = read(options.guestKeyFile, "guest-key-file", "guests", tokens.guestKeys); !ok)
        return passOn(ok);
    if (auto ok = read(options.sessionKeyFile, "session-key-file", "sessions", tokens.sessionKeys); !ok)
        return passOn(ok);
    for (const NamedToken& admin : tokens.admins) {
        const auto same = std::ranges::find(tokens.users, admin.token, &NamedToken::token);
        if (same == tokens.users.end()) continue;
        return fail(
            ErrorCode::InvalidArgument,
            fmt::format(
                "--admin-token-file: \"{}\" is the same token as \"{}\" in --auth-token-file, so that "
                "who has that one would administer; make another one.",
                admin.name, same->name),
            "admin-token-file");
    }
    // Who knows what signs sessions could sign one for anybody; and a token goes over the line, a key never does.
    for (const NamedToken& key : tokens.sessionKeys)
        for (const auto& [flag, others] :
             {std::pair("auth-token-file", &tokens.users), std::pair("admin-token-file", &tokens.admins),
              std::pair("guest-key-file", &tokens.guestKeys)}) {
            const auto same = std::ranges::find(*others, key.token, &NamedToken::token);
            if (same == others->end()) continue;
            return fail(ErrorCode::InvalidArgument,
                        fmt::format("--session-key-file: \"{}\" is the same secret as \"{}\" in --{}; make "
                                    "another one: scancast token NAME.",
                                    key.name, same->name, flag),
                        "session-key-file");
        }
    return tokens;
}

Expected<void> findFiles(ServeOptions& options) {
    std::vector<std::string> named = options.named;
    if (named.empty())
        for (const std::filesystem::path& file : options.files) named.push_back(file.string());
    const auto found = findScans(named, {.urls = true});
    if (!found) return passOn(found);
    if (!found->leftOut().empty()) spdlog::info("{}", found->leftOutText());
    for (const std::string& one : found->leftOut()) spdlog::debug("no scan: {}", one);
    options.files.assign(found->files().begin(), found->files().end());
    options.named = std::move(named);
    return {};
}

void addServeFlags(CLI::App& app, ServeOptions& options) {
    app.add_option("FILE", options.files,
                   "What to serve: cloud files (made by scancast ingest), also from object storage "
                   "(https://..., s3://BUCKET/KEY), scans, folders of them, or patterns such as "
                   "'flight/*.laz'. Each becomes a cloud")
        ->type_name("");
    app.add_option("--live", options.live,
                   "A cloud that changes over time: frames as point streams, one after another, from "
                   "standard input (-), a named pipe or a file. May be repeated")
        ->type_name("NAME=PATH")
        ->envname("SCANCAST_LIVE")
        ->allow_extra_args(false)
        ->take_all();
    const auto flag = [&](const char* name, auto& value, const char* environment, const char* meaning) {
        return app.add_option(name, value, meaning)->envname(environment)->capture_default_str();
    };
    flag("--host", options.server.host, "SCANCAST_HOST",
         "Address to listen on. Anything but a loopback address needs --auth-token-file or --insecure")
        ->type_name("ADDRESS");
    flag("--port", options.server.port, "SCANCAST_PORT", "Port to listen on; 0 picks a free one")
        ->type_name("PORT")
        ->check(CLI::Range(0, 65535));
    flag("--backend", options.device.backend, "SCANCAST_BACKEND",
         "What to render with: auto, cpu, egl or osmesa")
        ->type_name("NAME")
        ->check(CLI::IsMember({"auto", "cpu", "egl", "osmesa"}));
    flag("--egl-device", options.device.eglDevice, "SCANCAST_EGL_DEVICE",
         "Which EGL device, as numbered by scancast --list-backends; -1 = the best")
        ->type_name("N");
    flag("--threads", options.device.threads, "SCANCAST_THREADS",
         "Threads for rendering and loading; 0 = all cores")
        ->type_name("N")
        ->check(CLI::Range(0, 1024));
    flag("--max-pixels", options.server.limits.maxPixels, "SCANCAST_MAX_PIXELS", "Largest picture, in pixels")
        ->type_name("N")
        ->check(CLI::Range(std::uint64_t(1), std::uint64_t(maxPictureSide) * maxPictureSide));
    const auto cost = [&](const char* name, double& value, const char* environment, const char* meaning) {
        flag(name, value, environment, meaning)->type_name("MS")->check(CLI::Range(0.0, 1e9));
    };
    cost("--max-picture-cost", options.server.costs.picture, "SCANCAST_MAX_PICTURE_COST",
         "The most that one picture may cost, in milliseconds of one core");
    cost("--max-client-cost", options.server.costs.client, "SCANCAST_MAX_CLIENT_COST",
         "The most that all pictures one address is waiting for may cost together; 0 = half of "
         "--max-total-cost");
    cost("--max-total-cost", options.server.costs.total, "SCANCAST_MAX_TOTAL_COST",
         "The most that all pictures being waited for may cost together; 0 = what this machine's cores can "
         "do in 25 s");
    flag("--rates", options.rates, "SCANCAST_RATES",
         "JSON file with the costs of methods, passes and encoders, used instead of the built-in table")
        ->type_name("FILE");
    flag("--max-sessions", options.server.limits.maxSessions, "SCANCAST_MAX_SESSIONS",
         "The most streams at the same time")
        ->type_name("N")
        ->check(CLI::Range(1, 100000));
    flag(
        "--video-sessions", options.server.limits.videoSessions, "SCANCAST_VIDEO_SESSIONS",
        "The most streams whose moving frames are video (H.264), where their clients can show it: each takes "
        "memory for an encoder. Further ones get JPEG. 0 = no video. Example: --video-sessions 40")
        ->type_name("N")
        ->check(CLI::Range(0, 100000));
    flag("--max-connections", options.maxConnections, "SCANCAST_MAX_CONNECTIONS",
         "The most connections at the same time, including those of streams. When all are in use, the one "
         "that has been idle longest is closed; when none is idle, newcomers get a 503. 0 = --max-sessions "
         "plus 448")
        ->type_name("N")
        ->check(CLI::Range(0, 1000000));
    flag("--max-connections-per-address", options.server.limits.maxConnectionsPerAddress,
         "SCANCAST_MAX_CONNECTIONS_PER_ADDRESS",
         "The most of these from one address (for IPv6, one /64 network); further ones get a 429. 0 = a "
         "quarter of all, and no limit for this machine itself")
        ->type_name("N")
        ->check(CLI::Range(0, 1000000));
    flag("--memory-limit", options.memoryLimit, "SCANCAST_MEMORY_LIMIT",
         "Memory for clouds, pictures and clients together, such as 2G or 512M. Default: half of what the "
         "machine, or this process's control group, has")
        ->type_name("SIZE");
    flag("--transient-limit", options.transientLimit, "SCANCAST_TRANSIENT_LIMIT",
         "The part of --memory-limit for pictures and for data that clients have not read yet, such as 256M. "
         "Default: three eighths of it, at most 2G. Clouds get the rest")
        ->type_name("SIZE");
    flag("--gpu-memory-limit", options.gpuMemoryLimit, "SCANCAST_GPU_MEMORY_LIMIT",
         "GPU memory for points, such as 8G. Default: three quarters of what is free")
        ->type_name("SIZE");
    flag("--cache-dir", options.cacheDir, "SCANCAST_CACHE_DIR",
         "Folder in which to keep scans as cloud files, compiled GPU programs, and what has been fetched of "
         "clouds in object storage, so that the next start need not wait for them")
        ->type_name("FOLDER");
    flag("--cache-size", options.cacheSize, "SCANCAST_CACHE_SIZE",
         "The most space that --cache-dir may take, such as 20G; the least recently used cloud files make "
         "room for new ones. Default: a tenth of the disk")
        ->type_name("SIZE");
    flag("--max-clouds", options.server.maxClouds, "SCANCAST_MAX_CLOUDS",
         "The most clouds at the same time, live ones included: those on the command line and those that the "
         "administrator adds")
        ->type_name("N")
        ->check(CLI::Range(1, 100000));
    flag("--data-root", options.server.dataRoot, "SCANCAST_DATA_ROOT",
         "Folder whose scans the administrator may add while the server runs (POST /api/v1/clouds)")
        ->type_name("FOLDER");
    flag("--catalog", options.catalog, "SCANCAST_CATALOG",
         "Folder whose cloud files are served for as long as they are there: it is looked at every two "
         "seconds. "
         "Scans and folders in it are left out. Or s3://BUCKET/PREFIX/, whose objects NAME.scan are, or the "
         "URL "
         "of a list that names clouds, one a line: asked for every five seconds")
        ->type_name("FOLDER|URL");
    flag(
        "--importers", options.importers, "SCANCAST_IMPORTERS",
        "How many files importers may read at the same time; files that need no importer never wait for them")
        ->type_name("N")
        ->check(CLI::Range(1, 64));
    addImporterFlags(app, options.importer, true);
    app.add_option("--allowed-origin", options.server.allowedOrigins,
                   "Another website whose pages may use this server and show its page in a frame, such as "
                   "https://viewer.example.org. May be repeated")
        ->type_name("ORIGIN")
        ->envname("SCANCAST_ALLOWED_ORIGIN")
        ->allow_extra_args(false)
        ->take_all();
    const auto list = [&](const char* name, std::vector<std::string>& values, const char* environment,
                          const char* meaning) {
        return app.add_option(name, values, meaning)
            ->envname(environment)
            ->allow_extra_args(false)
            ->delimiter(',')
            ->take_all();
    };
    list("--allowed-host", options.server.allowedHosts, "SCANCAST_ALLOWED_HOST",
         "Another name of this server, as people type it into a browser: scans.example.org. Requests for any "
         "other name are refused. May be repeated, or a comma-separated list")
        ->type_name("NAME");
    list("--trusted-proxy", options.trustedProxies, "SCANCAST_TRUSTED_PROXY",
         "Address of a proxy in front of this server, or a range such as 10.0.0.0/8: for requests from "
         "there, Forwarded or X-Forwarded-For names the client that they count for. May be repeated, or a "
         "comma-separated list")
        ->type_name("CIDR");
    flag("--admin-listen", options.adminListen, "SCANCAST_ADMIN_LISTEN",
         "A second address, such as 127.0.0.1:9090 or [::1]:9090, for /healthz, /readyz and /metrics only, "
         "without TLS: monitoring gets an answer there even when all connections are in use")
        ->type_name("HOST:PORT");
    app.add_flag("--no-surfels", options.noSurfels,
                 "Read scans faster by not estimating the normals and radii that disc, ewa, voronoi and "
                 "shading=phong need. Cloud files stay as they are")
        ->envname("SCANCAST_NO_SURFELS");
    app.add_flag("--native", options.native,
                 "Show scans in COPC and EPT as they are, without ingest: at once, and points are read as "
                 "views want "
                 "them. Those behind URLs are always shown so")
        ->envname("SCANCAST_NATIVE");
    app.add_flag("--insecure", options.insecure,
                 "Let in everybody who can reach the address, without a token")
        ->envname("SCANCAST_INSECURE");
    flag("--auth-token-file", options.authTokenFile, "SCANCAST_AUTH_TOKEN_FILE",
         "File with the tokens that clients must present, one line NAME TOKEN each, as scancast token prints "
         "it. Nobody but its owner may be able to read it (chmod 600)")
        ->type_name("FILE");
    flag("--admin-token-file", options.adminTokenFile, "SCANCAST_ADMIN_TOKEN_FILE",
         "File with the tokens of administrators, who may do everything")
        ->type_name("FILE");
    flag("--guest-key-file", options.guestKeyFile, "SCANCAST_GUEST_KEY_FILE",
         "File with the keys that sign guest links (scancast guest-link), as scancast token prints them. The "
         "first one signs, all are accepted. Needs --auth-token-file")
        ->type_name("FILE");
    app.add_flag(
           "--guests-may-export", options.server.guestsMayExport,
           "Guests get the points of their cloud, too - exports and profiles -, and not its pictures alone")
        ->envname("SCANCAST_GUESTS_MAY_EXPORT");
    flag("--session-key-file", options.sessionKeyFile, "SCANCAST_SESSION_KEY_FILE",
         "File with the keys that sign the sessions' tokens, as scancast token prints them. Servers that "
         "share it "
         "go on with each other's sessions. The first one signs, all are accepted. Without it every server "
         "has a "
         "key of its own")
        ->type_name("FILE");
    flag("--tls-cert", options.server.tls.certificate, "SCANCAST_TLS_CERT",
         "Certificate chain in PEM format, to serve https and wss")
        ->type_name("FILE");
    flag("--tls-key", options.server.tls.key, "SCANCAST_TLS_KEY",
         "The certificate's private key in PEM format")
        ->type_name("FILE");
    flag("--hsts-seconds", options.server.hstsSeconds, "SCANCAST_HSTS_SECONDS",
         "With --tls-cert: how long browsers that have been here insist on https "
         "(Strict-Transport-Security); 0 = do not send that header")
        ->type_name("S")
        ->check(CLI::Range(0, 10 * 31'536'000));
    flag(
        "--drain-seconds", options.drainSeconds, "SCANCAST_DRAIN_SECONDS",
        "Where there are other servers at the same address: after SIGTERM, how long clients have to go to "
        "one of "
        "them, one after the other, while this one takes no new ones and still draws. 0 = they are sent away "
        "at once")
        ->type_name("S")
        ->check(CLI::Range(0, 86400));
    flag("--config", options.config, "SCANCAST_CONFIG",
         "JSON file with flag names as keys. Flags and environment variables take precedence")
        ->type_name("FILE");
    app.add_flag("--check-config", options.checkConfig,
                 "Check all settings, print those in effect, and exit");
    flag("--log-level", options.logLevel, "SCANCAST_LOG_LEVEL", "debug, info, warn, error or off")
        ->type_name("LEVEL");
    flag("--request-log", options.requestLog, "SCANCAST_REQUEST_LOG",
         "Log a line for each request: on, off, or all, which also writes repeated ones in full")
        ->type_name("WHICH");
    flag("--log-format", options.logFormat, "SCANCAST_LOG_FORMAT", "text, or json: one object per line")
        ->type_name("FORMAT");
}

Expected<std::uint64_t> cacheSize(const ServeOptions& options) {
    if (options.cacheSize.empty()) return 0;
    if (options.cacheDir.empty())
        return fail(ErrorCode::InvalidArgument,
                    "--cache-size: there is no --cache-dir FOLDER for it to limit.", "cache-size");
    auto size = parseByteSize(options.cacheSize, "cache-size");
    if (size && *size == 0)
        return fail(ErrorCode::InvalidArgument,
                    "--cache-size: nothing could be kept; leave out --cache-dir instead.", "cache-size");
    return size;
}

CacheShares cacheShares(const ServeOptions& options) {
    const std::uint64_t asked = cacheSize(options).value_or(0);
    const bool isRemote =
        isRemoteUrl(options.catalog.native()) ||
        std::ranges::any_of(options.files, [](const auto& file) { return isRemoteUrl(file.native()); });
    if (options.cacheDir.empty() || !isRemote) return {asked, 0};
    const std::uint64_t all = asked > 0 ? asked : tenthOfTheDisk(options.cacheDir);
    return {all - all / 2, all / 2};
}

Expected<Rates> rates(const ServeOptions& options) {
    if (options.rates.empty()) return shippedRates();
    constexpr std::size_t longest = 1 << 20;
    auto text = readTextFile(options.rates, longest);
    if (!text) return fail(text.error().code, "--rates: " + text.error().message, "rates");
    auto rates = parseRates(*text);
    if (!rates)
        return fail(rates.error().code, "--rates: " + options.rates.string() + ": " + rates.error().message,
                    "rates");
    return rates;
}

Expected<RequestLogOptions> requestLog(const ServeOptions& options) {
    RequestLogOptions log;
    if (options.requestLog != "on" && options.requestLog != "off" && options.requestLog != "all") {
        return fail(ErrorCode::InvalidArgument,
                    "--request-log " + options.requestLog + ": it is on, all or off.", "request-log");
    }
    auto writer = EventWriter::create(options.logLevel, options.logFormat);
    if (!writer) return passOn(writer);
    if (options.requestLog != "off") log.writer = std::move(*writer);
    if (options.requestLog == "all") log.repeats = std::nullopt;
    return log;
}

Expected<std::size_t> maxConnections(const ServeOptions& options) {
    ConnectionWish wish;
    wish.sessions = options.server.limits.maxSessions;
    if (options.maxConnections > 0) wish.asked = options.maxConnections;
    wish.clouds =
        options.catalog.empty() ? options.files.size() + options.live.size() : options.server.maxClouds;
    return fittingConnections(wish, raiseFileLimit(wish.files(wish.connections())));
}

Expected<std::optional<ListenAddress>> adminListen(const ServeOptions& options) {
    if (options.adminListen.empty()) return std::nullopt;
    return parseListenAddress(options.adminListen, "admin-listen").map([](ListenAddress address) {
        return std::optional(std::move(address));
    });
}

Expected<MemoryShares> memoryShares(const ServeOptions& options) {
    constexpr std::uint64_t least = 64 << 20, leastTransient = 8 << 20, leastForClouds = 16 << 20;
    std::uint64_t all = std::max(machineMemory() / 2, least);
    if (!options.memoryLimit.empty()) {
        const auto limit = parseByteSize(options.memoryLimit, "memory-limit");
        if (!limit) return passOn(limit);
        all = *limit;
    }
    if (all < least) {
        return fail(ErrorCode::InvalidArgument,
                    "--memory-limit: 64M is the least that a picture can be drawn with.", "memory-limit");
    }
    // Enough for a picture of 3840 x 2160 with its depth where there are 512M, and no more than pictures ever need.
    std::uint64_t transient = std::min(all / 8 * 3, std::uint64_t(2) << 30);
    if (!options.transientLimit.empty()) {
        const auto limit = parseByteSize(options.transientLimit, "transient-limit");
        if (!limit) return passOn(limit);
        transient = *limit;
    }
    if (transient < leastTransient || transient + leastForClouds > all) {
        return fail(
            ErrorCode::InvalidArgument,
            fmt::format(
                "--transient-limit: must be from 8M to {}M, since it is a share of --memory-limit and "
                "clouds need 16M of that at least.",
                (all - leastForClouds) >> 20),
            "transient-limit");
    }
    return MemoryShares{all - transient, transient};
}

Expected<std::vector<LiveInput>> liveInputs(const ServeOptions& options) {
    std::vector<LiveInput> inputs;
    for (const std::string& text : options.live) {
        auto input = parseLiveInput(text);
        if (!input) return passOn(std::move(input));
        if (std::ranges::find(inputs, input->path, &LiveInput::path) != inputs.end())
            return fail(
                ErrorCode::InvalidArgument,
                "--live: " + input->path.string() + " is named twice; its frames can go to one cloud only.",
                "live");
        inputs.push_back(std::move(*input));
    }
    return inputs;
}

Expected<void> check(const ServeOptions& options) {
    if (options.files.empty() && options.live.empty() && options.catalog.empty() &&
        options.server.dataRoot.empty()) {
        return fail(ErrorCode::InvalidArgument,
                    "Nothing to serve: name at least one scan. Without one at hand, make a town: "
                    "scancast generate town --points 2000000 -o town.las && scancast serve town.las");
    }
    return checkFlags(options);
}

Expected<void> checkFlags(const ServeOptions& options) {
    if (auto ok = liveInputs(options); !ok) return passOn(ok);
    if (const std::size_t named = options.files.size() + options.live.size();
        named > options.server.maxClouds)
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("--max-clouds: {} clouds are named, and {} may be served; let it be {}, or "
                                "name fewer.",
                                named, options.server.maxClouds, named),
                    "max-clouds");
    if (auto ok = cacheSize(options); !ok) return passOn(ok);
    const std::string& host = options.server.host;
    if (!isLoopbackHost(host) && !options.insecure && options.authTokenFile.empty()) {
        return fail(
            ErrorCode::InvalidArgument,
            "--host " + host +
                " can be reached from other machines. Give --auth-token-file FILE, so that clients need "
                "the token in it: (umask 077; scancast token NAME > FILE). If everybody who "
                "can reach that address may see the clouds, add --insecure instead; or keep 127.0.0.1 and "
                "forward the port: ssh -L 8080:127.0.0.1:8080 THIS-MACHINE",
            "host");
    }
    const auto probes = adminListen(options);
    if (!probes) return passOn(probes);
    if (*probes && !isLoopbackHost((*probes)->host) && !options.insecure && options.authTokenFile.empty()) {
        return fail(
            ErrorCode::InvalidArgument,
            "--admin-listen " + options.adminListen +
                " can be reached from other machines. Give --auth-token-file FILE, so that /metrics needs "
                "the "
                "token in it (/healthz and /readyz never do), or --insecure if everybody may read it; or "
                "listen on 127.0.0.1.",
            "admin-listen");
    }
    if (auto ok = TrustedProxies::parse(options.trustedProxies); !ok) return passOn(ok);
    if (auto ok = requestLog(options); !ok) return passOn(ok);
    if (auto ok = maxConnections(options); !ok) return passOn(ok);
    if (auto ok = memoryShares(options); !ok) return passOn(ok);
    if (auto ok = importOptions(options.importer); !ok) return passOn(ok);
    if (auto ok = rates(options); !ok) return passOn(ok);
    if (options.server.costs.picture <= 0)
        return fail(ErrorCode::InvalidArgument,
                    "--max-picture-cost: must be more than 0, or nothing is drawn.", "max-picture-cost");
    if (auto ok = parseGpuMemoryLimit(options.gpuMemoryLimit); !ok) return passOn(ok);
    std::error_code error;
    for (const auto& [flag, folder] :
         {std::pair("cache-dir", &options.cacheDir), std::pair("data-root", &options.server.dataRoot),
          std::pair("catalog", &options.catalog)}) {
        if (folder->empty() || std::filesystem::is_directory(*folder, error)) continue;
        if (folder == &options.catalog && isRemoteUrl(folder->native())) {
            if (auto listing = RemoteListing::create(folder->native()); !listing)
                return fail(ErrorCode::InvalidArgument, "--catalog: " + listing.error().message, flag);
            continue;
        }
        return fail(
            ErrorCode::InvalidArgument,
            "--" + std::string(flag) + ": there is no folder " + folder->string() + "; create it first.",
            flag);
    }
    if (!options.guestKeyFile.empty() && options.authTokenFile.empty()) {
        return fail(
            ErrorCode::InvalidArgument,
            "--guest-key-file: without --auth-token-file everybody sees all clouds, so that a guest's link "
            "would restrict nobody; give that, too.",
            "guest-key-file");
    }
    if (!options.server.dataRoot.empty() && options.adminTokenFile.empty()) {
        return fail(ErrorCode::InvalidArgument,
                    "--data-root: only an administrator may add clouds; give --admin-token-file, too.",
                    "data-root");
    }
    for (const std::string& origin : options.server.allowedOrigins) {
        if (auto ok = checkAllowedOrigin(origin); !ok) return ok;
    }
    for (const std::string& name : options.server.allowedHosts) {
        if (auto ok = checkAllowedHost(name); !ok)
            return fail(ok.error().code, "--allowed-host: " + ok.error().message, ok.error().field);
    }
    return {};
}

}  // namespace scancast
