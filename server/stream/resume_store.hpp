// What sessions need to go on after their connection broke. Each has a token, which any server with the same key believes
// (session_token.hpp); and for a minute after the connection was lost, this server remembers what it showed. A token of a session
// that is still connected moves it to the new connection: a client often knows before the server that a line is dead.
//
// What is remembered is given away once. A token that comes when nothing is remembered says whose session it is and no more: the
// client has to say what it saw. One that a later token of the same session has been issued for here is a replay, and good for nothing.
//
// Owned by the server, which outlives every session. *Thread safety*: every function may be called from any
// thread; `onTaken` comes from inside resume() and must only post. Its only clock is that of tokens' expiry.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// What a token was good for.
struct ResumedSession {
    std::string id;          ///< of the session
    std::uint32_t turn = 0;  ///< of the token: the connection that goes on with it has the next one
    std::optional<SavedSession> saved{};  ///< empty: another server showed it, or it is too long ago
    /// Of the connection that goes on with it: open() takes that place, forget() gives it up. From resume() on it makes the token
    /// a replay, so of two that come with it at once one goes on.
    std::uint64_t place = 0;
};

struct ResumeOptions {
    std::chrono::seconds lifetime{60};  ///< of what is remembered, after the connection was lost
    std::size_t mostAway = 1024;        ///< kept without a connection; the one that left first makes room
    std::chrono::seconds tokenLife{12 * 60 * 60};  ///< from when it is issued
    std::function<std::int64_t()> unixTime{};      ///< s since 1970; empty = the system's clock
};

class ResumeStore {
  public:
    using Time = std::chrono::steady_clock::time_point;
    using Key = std::uint64_t;
    struct Ticket {
        Key key = 0;
        std::string token;
    };
    struct Opening {
        std::string session;  ///< its id
        std::string owner;    ///< who it belongs to, in any words: others cannot go on with it
        std::uint32_t turn = 1;
        std::function<void()> onTaken{};
        Key place = 0;  ///< that resume() gave; 0 = a new one
    };

    /// Signs with a key of its own, which stays the same as long as the store is there.
    explicit ResumeStore(ResumeOptions options = {});

    /// The first one signs from now on, and what any of them signed is believed; empty = that of its own.
    void setKeys(std::vector<std::string> keys);

    /// A session begins, or goes on under a new token. nullopt when the system has no random numbers to give.
    std::optional<Ticket> open(Opening opening);
    void keep(Key key, SavedSession session);
    /// Its connection is lost. What was never kept is forgotten.
    void leave(Key key, Time now);
    /// It has ended.
    void forget(Key key);
    /// Whose session that token is, with what is remembered of it; nullopt for what no key has signed, for another owner's,
    /// when it has expired, and for a replay.
    std::optional<ResumedSession> resume(std::string_view token, std::string_view owner, Time now);

    std::size_t size() const;

  private:
    struct Entry {
        std::string session, token;
        std::uint32_t turn = 0;
        std::function<void()> onTaken;
        std::optional<SavedSession> saved;
        std::optional<Time> left;
    };
    void dropLate(Time now);
    std::int64_t unixTime() const;

    const ResumeOptions options_;
    const std::vector<std::string> own_;  ///< empty where there were no random numbers for one
    mutable std::mutex mutex_;
    std::vector<std::string> keys_;
    Key lastKey_ = 0;
    std::map<Key, Entry> entries_;
};

}  // namespace scancast
