// How many long pieces of work there are at a time, of each client and of all together: a few, because each holds memory until
// it has been read. Owned by who gives places; a place keeps what it needs of it. *Thread safety*: any thread.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "protocol/problem.hpp"

namespace scancast {

class WorkPlaces {
  public:
    struct Limits {
        std::size_t all = 8, client = 3;
        std::string_view what = "exports";  ///< for messages
    };
    using Place = std::shared_ptr<const void>;

    explicit WorkPlaces(Limits limits) : state_(std::make_shared<State>(limits)) {}

    /// Held as long as the work lasts, and what was made of it has not been read. 429 where this client, 503 where all have as
    /// many as there are.
    tl::expected<Place, Problem> take(const std::string& client) const;

  private:
    struct State {
        explicit State(Limits most) : limits(most) {}
        const Limits limits;
        std::mutex mutex;
        std::map<std::string, std::size_t> clients;
        std::size_t all = 0;
    };
    const std::shared_ptr<State> state_;
};

}  // namespace scancast
