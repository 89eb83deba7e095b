// What SIGHUP does: the configuration file, the files of tokens, certificate and key, and the list of clouds are read
// anew while everybody goes on looking. Each of these kinds is taken as a whole or not at all: what is unsound is said, and
// what was there before goes on. What cannot change in a running server is named.
//
// Owned by the command, on the main thread. Place: signals → **reload** → access, certificate, loader.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/commands/config_file.hpp"
#include "server/commands/serve/clouds.hpp"
#include "server/commands/serve_options.hpp"

namespace scancast {

/// What came of it.
struct Reloaded {
    std::vector<std::string> changed;     ///< in words: "2 clouds added"
    std::vector<std::string> kept;        ///< kinds that were unsound: "the certificate"
    std::vector<std::string> forRestart;  ///< names of flags whose values in the file are others
};

/// One line for the log.
std::string summary(const Reloaded& reloaded);

/// How the server was started.
struct StartedWith {
    GivenFlags
        given;  ///< on the command line and in the environment, which goes before the file now as at the start
    nlohmann::json effective;                    ///< its options, as effectiveConfig() tells them
    std::function<void(CLI::App&)> moreFlags{};  ///< that are no flags of serve's
};

class Reload {
  public:
    /// `options`: those that the server was started with.
    Reload(StartedWith started, ServeOptions options, ScancastServer& server, CloudSources& clouds);
    /// Says all of it in the log, and counts it.
    void run();

  private:
    struct Wanted;
    Expected<Wanted> readConfiguration() const;
    void takeTokens(const ServeOptions& wanted, Reloaded& reloaded);
    void takeCertificate(const ServeOptions& wanted, Reloaded& reloaded);
    void takeClouds(const ServeOptions& wanted, Reloaded& reloaded);

    const StartedWith started_;
    ServeOptions running_;  // what holds: of the start, but for what has been taken since
    ScancastServer& server_;
    CloudSources& clouds_;
};

}  // namespace scancast
