// What goes on for as long as the server is there, also while its clients leave it for others: files are read anew when SIGHUP comes,
// and clouds of --catalog come and go.
//
// Owned by the command, on the main thread, whose loops call step(). Place: signals, lookout → **upkeep** → reload, cloud sources.
#pragma once

#include <functional>

#include "server/commands/serve/clouds.hpp"
#include "server/commands/serve/reload.hpp"
#include "server/terminal/shutdown_signals.hpp"

namespace scancast {

class Upkeep {
  public:
    /// All of them outlive it.
    Upkeep(CloudSources& sources, Reload& reload, const ShutdownSignals& signals);
    /// What has come since the last call. `onReload` is called before files are read anew.
    void step(const std::function<void()>& onReload = {});

  private:
    CloudSources& sources_;
    Reload& reload_;
    const ShutdownSignals& signals_;
    int reloads_ = 0, others_ = 0;  // signals that have been served
};

}  // namespace scancast
