#include "server/net/points/work_places.hpp"

#include <fmt/format.h>

#include <utility>

namespace scancast {

tl::expected<WorkPlaces::Place, Problem> WorkPlaces::take(const std::string& client) const {
    auto letGo = [state = state_, client](const void*) {
        const std::lock_guard lock(state->mutex);
        --state->all;
        const auto at = state->clients.find(client);
        if (at != state->clients.end() && --at->second == 0) state->clients.erase(at);
    };
    {
        const std::lock_guard lock(state_->mutex);
        if (state_->all >= state_->limits.all)
            return tl::unexpected(problemOf(
                503,
                fmt::format("{} {} are under way, as many as this server makes at a time; ask again later.",
                            state_->all, state_->limits.what)));
        std::size_t& own = state_->clients[client];
        if (own >= state_->limits.client)
            return tl::unexpected(problemOf(
                429,
                fmt::format("You have {} {} under way, as many as one client may; read them to their end, "
                            "or ask again later.",
                            own, state_->limits.what)));
        ++own;
        ++state_->all;
    }
    // Where there is no memory for it, it lets go at once: so the lock is not held here.
    return Place(nullptr, std::move(letGo));
}

}  // namespace scancast
