#include "server/price/work_budget.hpp"

#include <utility>

namespace scancast {

tl::expected<WorkBudget::Ticket, WorkBudget::Refusal> WorkBudget::take(const std::string& client,
                                                                       double price) const {
    // Made first: it may fail for want of memory. Nothing is given back until something was taken.
    const auto taken = std::make_shared<double>(0);
    Ticket ticket(taken.get(), [state = state_, client, taken](const void*) {
        const std::lock_guard lock(state->mutex);
        if (*taken == 0) return;
        state->total -= *taken;
        const auto at = state->clients.find(client);
        if ((at->second -= *taken) <= 1e-6) state->clients.erase(at);
    });
    if (!(price > 0)) return ticket;
    State& state = *state_;
    const std::lock_guard lock(state.mutex);
    const auto mine = state.clients.find(client);
    const double used = mine == state.clients.end() ? 0 : mine->second;
    if (used > 0 && used + price > state.limits.client)
        return tl::unexpected(Refusal{true, used, state.limits.client});
    if (state.total > 0 && state.total + price > state.limits.total)
        return tl::unexpected(Refusal{false, state.total, state.limits.total});
    state.clients[client] += price;
    state.total += price;
    *taken = price;
    return ticket;
}

double WorkBudget::used() const {
    const std::lock_guard lock(state_->mutex);
    return state_->total;
}

}  // namespace scancast
