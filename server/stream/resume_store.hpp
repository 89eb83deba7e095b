// What sessions need to go on after their connection broke: each has a token, good once, and for a minute
// after the connection was lost. A token of a session that is still connected moves it to the new connection:
// a client often knows before the server that a line is dead.
//
// Owned by the server, which outlives every session. *Thread safety*: every function may be called from any
// thread; `onTaken` comes from inside resume() and must only post. No clock of its own.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/view/view.hpp"
#include "server/stream/quality.hpp"

namespace scancast {

/// A session as it was when something last changed.
struct SavedSession {
    std::string id, cloudId;
    View view;
    std::uint64_t seq = 0;  ///< of the view
    MovingLimits limits;
    std::uint64_t lastFrame = 0;  ///< numbers go on behind it
};

struct ResumeOptions {
    std::chrono::seconds lifetime{60};  ///< after the connection was lost
    std::size_t mostAway = 1024;        ///< kept without a connection; the one that left first makes room
};

class ResumeStore {
  public:
    using Time = std::chrono::steady_clock::time_point;
    using Key = std::uint64_t;
    struct Ticket {
        Key key = 0;
        std::string token;  ///< 256 random bits
    };

    explicit ResumeStore(ResumeOptions options = {}) : options_(options) {}

    /// A session begins, or goes on under a new token. nullopt when the system has no random numbers to give.
    std::optional<Ticket> open(std::function<void()> onTaken);
    void keep(Key key, SavedSession session);
    /// Its connection is lost. What was never kept is forgotten.
    void leave(Key key, Time now);
    /// It has ended.
    void forget(Key key);
    /// The session of that token, which it leaves with; nullopt when there is none, or it is too late.
    std::optional<SavedSession> resume(std::string_view token, Time now);

    std::size_t size() const;

  private:
    struct Entry {
        std::string token;
        std::function<void()> onTaken;
        std::optional<SavedSession> session;
        std::optional<Time> left;
    };
    void dropLate(Time now);

    const ResumeOptions options_;
    mutable std::mutex mutex_;
    Key lastKey_ = 0;
    std::map<Key, Entry> entries_;
};

}  // namespace scancast
