#include "server/commands/serve/upkeep.hpp"

#include <spdlog/spdlog.h>

#include <utility>

namespace scancast {

Upkeep::Upkeep(CloudSources& sources, Reload& reload, const ShutdownSignals& signals)
    : sources_(sources), reload_(reload), signals_(signals) {}

void Upkeep::step(const std::function<void()>& onReload) {
    const int others = signals_.others(), reloads = signals_.reloads();
    if (std::exchange(others_, others) != others)
        spdlog::warn("SIGUSR1 and SIGUSR2 mean nothing here; SIGHUP has files read anew.");
    if (std::exchange(reloads_, reloads) != reloads) {
        if (onReload) onReload();
        reload_.run();
    }
    sources_.lookAround();
}

}  // namespace scancast
