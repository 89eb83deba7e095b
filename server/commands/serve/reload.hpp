// What SIGHUP does: the configuration file, the files of tokens, certificate and key, and the list of clouds are read
// anew while everybody goes on looking. Each of these kinds is taken as a whole or not at all: what is unsound is said, and
// what was there before goes on. What cannot change in a running server is named.
//
// Owned by the command, on the main thread. Place: signals → **reload** → access, certificate, loader.
#pragma once

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

class Reload {
  public:
    /// `given`: what stood on the command line and in the environment, which goes before the file now as at the start.
    /// `options`: those that the server was started with; `effective`: the same, as effectiveConfig() tells them.
    Reload(GivenFlags given, ServeOptions options, nlohmann::json effective, ScancastServer& server,
           CloudSources& clouds);
    /// Says all of it in the log, and counts it.
    void run();

  private:
    struct Wanted;
    Expected<Wanted> readConfiguration() const;
    void takeTokens(const ServeOptions& wanted, Reloaded& reloaded);
    void takeCertificate(const ServeOptions& wanted, Reloaded& reloaded);
    void takeClouds(const ServeOptions& wanted, Reloaded& reloaded);

    const GivenFlags given_;
    ServeOptions running_;            // what holds: of the start, but for what has been taken since
    const nlohmann::json effective_;  // of the start
    ScancastServer& server_;
    CloudSources& clouds_;
};

}  // namespace scancast
