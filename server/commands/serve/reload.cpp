#include "server/commands/serve/reload.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <utility>

#include "server/base/faults.hpp"
#include "server/net/tls/tls.hpp"
#include "server/server.hpp"

namespace scancast {
namespace {

using nlohmann::json;

// What is taken while the server runs.
constexpr std::array<std::string_view, 7> reloadable{filesKey,         "auth-token-file",  "admin-token-file",
                                                     "guest-key-file", "session-key-file", "tls-cert",
                                                     "tls-key"};

/// The same in options: those that hold, with what can change of those that are asked for.
ServeOptions withReloadable(ServeOptions running, const ServeOptions& wanted) {
    running.files = wanted.files;
    running.named = wanted.named;
    running.authTokenFile = wanted.authTokenFile;
    running.adminTokenFile = wanted.adminTokenFile;
    running.guestKeyFile = wanted.guestKeyFile;
    running.sessionKeyFile = wanted.sessionKeyFile;
    running.server.tls = wanted.server.tls;
    return running;
}

/// The names of all other flags that have another value now.
std::vector<std::string> changedFlags(const json& before, const json& now) {
    std::set<std::string> names;
    for (const json* one : {&before, &now})
        for (const auto& [name, value] : one->items())
            if (before.value(name, json()) != now.value(name, json())) names.insert(name);
    for (const std::string_view name : reloadable) names.erase(std::string(name));
    return {names.begin(), names.end()};
}

/// "2 clouds added".
std::string cloudsThat(std::size_t count, std::string_view what) {
    return fmt::format("{} cloud{} {}", count, count == 1 ? "" : "s", what);
}

void keep(Reloaded& reloaded, const char* kind, const Error& error) {
    spdlog::error("Reloading: {} is as it was, because what was read is not sound: {}", kind, error.message);
    reloaded.kept.emplace_back(kind);
}

}  // namespace

std::string summary(const Reloaded& reloaded) {
    std::string text = "Reloaded: ";
    text += reloaded.changed.empty() ? "nothing has changed"
                                     : fmt::format("{}", fmt::join(reloaded.changed, ", "));
    if (!reloaded.kept.empty()) text += fmt::format("; as before: {}", fmt::join(reloaded.kept, ", "));
    if (!reloaded.forRestart.empty())
        text += fmt::format("; restart for --{}", fmt::join(reloaded.forRestart, ", --"));
    return text + ".";
}

/// What the configuration asks for now.
struct Reload::Wanted {
    ServeOptions options;
    json effective;
};

Reload::Reload(StartedWith started, ServeOptions options, ScancastServer& server, CloudSources& clouds)
    : started_(std::move(started)), running_(std::move(options)), server_(server), clouds_(clouds) {}

// As at the start: the command line and the environment, then the file, then the rules between flags.
Expected<Reload::Wanted> Reload::readConfiguration() const {
    CLI::App app;
    Wanted wanted;
    addServeFlags(app, wanted.options);
    if (started_.moreFlags) started_.moreFlags(app);
    if (auto ok = applyGivenFlags(app, started_.given); !ok) return passOn(ok);
    if (!running_.config.empty())
        if (auto ok = applyConfigFile(app, running_.config); !ok) return passOn(ok);
    if (auto ok = findFiles(wanted.options); !ok) return passOn(ok);
    if (auto ok = check(wanted.options); !ok) return passOn(ok);
    wanted.effective = effectiveConfig(app);
    // Where it listens does not change before a restart: an address that needs no token must not take the token away now.
    wanted.options = withReloadable(running_, wanted.options);
    if (auto ok = check(wanted.options); !ok)
        return fail(ok.error().code, "as long as it is not restarted, " + ok.error().message);
    return wanted;
}

void Reload::takeTokens(const ServeOptions& wanted, Reloaded& reloaded) {
    auto tokens = accessTokens(wanted);
    if (!tokens) return keep(reloaded, "the tokens", tokens.error());
    running_.authTokenFile = wanted.authTokenFile;
    running_.adminTokenFile = wanted.adminTokenFile;
    running_.guestKeyFile = wanted.guestKeyFile;
    running_.sessionKeyFile = wanted.sessionKeyFile;
    AccessTokens& now = running_.server.tokens;
    const bool same = tokens->users == now.users && tokens->admins == now.admins &&
                      tokens->guestKeys == now.guestKeys && tokens->sessionKeys == now.sessionKeys;
    now = std::move(*tokens);
    server_.replaceTokens(now);  // who came by one that is still there does not notice
    if (same) return;
    std::string text =
        fmt::format("tokens ({} of users, {} of administrators", now.users.size(), now.admins.size());
    if (!now.guestKeys.empty()) text += fmt::format(", {} that sign guests' links", now.guestKeys.size());
    if (!now.sessionKeys.empty())
        text += fmt::format(", {} that sign sessions' tokens", now.sessionKeys.size());
    reloaded.changed.push_back(text + ")");
}

void Reload::takeCertificate(const ServeOptions& wanted, Reloaded& reloaded) {
    const auto before = server_.tls();
    if (!before && !wanted.server.tls.given()) return;
    if (!before || !wanted.server.tls.given()) {  // the addresses of pages and clients change with it
        reloaded.forRestart.emplace_back("tls-cert");
        return;
    }
    auto tls = openTls(wanted.server.tls);
    if (!tls) return keep(reloaded, "the certificate", tls.error());
    running_.server.tls = wanted.server.tls;
    const std::string warning =
        expiryWarning(*tls, wanted.server.tls.certificate, std::chrono::system_clock::now());
    if (!warning.empty()) spdlog::warn("{}", warning);
    if (tls->digest == before->digest) return;
    reloaded.changed.push_back("certificate (until " + dateText(tls->expires) + ")");
    server_.replaceTls(std::move(*tls));
}

void Reload::takeClouds(const ServeOptions& wanted, Reloaded& reloaded) {
    running_.files = wanted.files;
    running_.named = wanted.named;
    const Loader::Changes changes = clouds_.serve(wanted.files);
    if (changes.added > 0) reloaded.changed.push_back(cloudsThat(changes.added, "added"));
    if (changes.removed > 0) reloaded.changed.push_back(cloudsThat(changes.removed, "removed"));
    if (changes.tried > 0) reloaded.changed.push_back(cloudsThat(changes.tried, "tried again"));
}

void Reload::run() {
    Reloaded reloaded;
    const auto done = contained("Reloading", [&] {
        auto wanted = readConfiguration();
        if (!wanted) keep(reloaded, "the configuration", wanted.error());
        // Its files may have changed all the same.
        ServeOptions options = wanted ? wanted->options : running_;
        if (!wanted && !findFiles(options)) spdlog::debug("The list of clouds is as it was.");
        takeTokens(options, reloaded);
        takeCertificate(options, reloaded);
        takeClouds(options, reloaded);
        if (wanted) {
            const auto flags = changedFlags(started_.effective, wanted->effective);
            reloaded.forRestart.insert(reloaded.forRestart.end(), flags.begin(), flags.end());
        }
        const bool sound = reloaded.kept.empty();
        spdlog::log(sound ? spdlog::level::info : spdlog::level::warn, "{}", summary(reloaded));
        server_.metrics().reloaded(sound, std::chrono::system_clock::now());
    });
    if (!done) spdlog::error("Reloading was not finished; send another SIGHUP.");
}

}  // namespace scancast
