// How much work may wait or be under way: for each client, and for all together. Who would go beyond is told to come
// again; a ticket is held as long as the work lasts.
//
// Owned by the server; tickets keep what they need of it. *Thread safety*: any thread. Place: price → **work budget** →
// api.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "protocol/error.hpp"

namespace scancast {

class WorkBudget {
  public:
    /// ms of a core (price.hpp).
    struct Limits {
        double client = 0, total = 0;
    };
    /// Why not.
    struct Refusal {
        bool ofClient = false;  ///< else of all together
        double used = 0, limit = 0;
    };
    using Ticket = std::shared_ptr<const void>;

    explicit WorkBudget(const Limits& limits) : state_(std::make_shared<State>(limits)) {}

    /// A client's first piece of work is taken whatever it costs, and so is the first of all: limits are of what waits.
    tl::expected<Ticket, Refusal> take(const std::string& client, double price) const;
    /// ms that tickets are out for.
    double used() const;

  private:
    struct State {
        explicit State(const Limits& most) : limits(most) {}
        const Limits limits;
        std::mutex mutex;
        std::map<std::string, double> clients;
        double total = 0;
    };
    const std::shared_ptr<State> state_;
};

}  // namespace scancast
