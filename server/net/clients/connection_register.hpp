// Who is connected, and who may be: places for connections, in all and for each client. Who comes when all are taken
// gets the place of the connection that has been idle longest - of all, or of the same client where its own are
// taken. Idle is who is waited for: between two requests, or while a request's head or body does not come. Sessions never
// are.
//
// Owned by the server, one for each address that it listens on; outlives every connection. *Thread safety*: every
// function may be called from any thread; a place belongs to one connection, and its functions to that one's strand.
// Pipeline: listener → **register** → http connection → stream connection.
#pragma once

#include <boost/intrusive/list.hpp>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "server/base/metrics.hpp"
#include "server/net/clients/trusted_proxies.hpp"

namespace scancast {

/// Anything that is connected and can be asked to leave.
class Connection {
  public:
    virtual ~Connection() = default;
    /// Says goodbye and closes; posts, returns at once.
    virtual void shutDown() = 0;
    /// Ends what would never end by itself; posts, returns at once.
    virtual void sayGoodbye() {}
};

struct ConnectionLimits {
    std::size_t all = 512;
    std::size_t perClient = 512;
    /// That were asked to leave and have not left yet, beside those: each is a moment of a strand. Beyond, who comes is
    /// refused.
    std::size_t leaving = 64;
};

class ConnectionRegister {
  public:
    class Place;
    template <class T>
    using Admitted = tl::expected<T, ConnectionRefusal>;

    /// Counts in `metrics`, where there are any.
    explicit ConnectionRegister(const ConnectionLimits& limits, Metrics* metrics = nullptr);

    /// A place, which is busy until its connection says otherwise. Whoever had it is asked to leave.
    Admitted<Place> enter(const CountedClient& client);
    /// Asks who has been idle longest to leave, if anybody is: what connections are made of runs out.
    void makeRoom();
    void shutDownAll();
    /// To everybody who is connected now.
    void sayGoodbye() const;
    std::size_t size() const;
    bool shuttingDown() const;
    const ConnectionLimits& limits() const { return limits_; }

  private:
    using Hook =
        boost::intrusive::list_member_hook<boost::intrusive::link_mode<boost::intrusive::auto_unlink>>;
    struct Client;
    struct Entry;
    template <Hook Entry::*member>
    using List = boost::intrusive::list<Entry, boost::intrusive::member_hook<Entry, Hook, member>,
                                        boost::intrusive::constant_time_size<false>>;

    // Linked by their hooks, so that becoming idle, busy or gone needs no memory.
    struct Entry {
        std::weak_ptr<Connection> connection;
        Client* client = nullptr;  ///< it counts for, as far as clients are limited; none = it does not
        bool idle = false;
        bool leaving = false;  ///< has been asked to; counts no more
        Hook all, waiting, waitingOfClient;
    };
    struct Client {
        const std::string* name = nullptr;  ///< its key
        std::size_t connections = 0;
        List<&Entry::waitingOfClient> idle;  ///< longest first
    };
    using Clients = std::unordered_map<std::string, Client>;

    Admitted<Entry*> victimLocked(const Client* client) const;
    std::shared_ptr<Connection> sendAwayLocked(Entry* entry);
    void joinLocked(Entry& entry, Client* client);
    void partLocked(Entry& entry);
    void restLocked(Entry& entry);
    void wakeLocked(Entry& entry);
    Client* clientLocked(const CountedClient& counted);
    void forgetLocked(Client* client);
    std::vector<std::weak_ptr<Connection>> allLocked() const;
    tl::unexpected<ConnectionRefusal> refused(ConnectionRefusal why) const;
    void leave(std::unique_ptr<Entry> entry);

    const ConnectionLimits limits_;
    Metrics* const metrics_;
    mutable std::mutex mutex_;
    List<&Entry::all> all_;
    List<&Entry::waiting> idle_;  ///< longest first
    std::size_t count_ = 0, leaving_ = 0;
    Clients clients_;  ///< that have connections and are limited
    bool shuttingDown_ = false;
};

/// Of one connection; given back when it ends. A connection that turns into another one hands it on.
class ConnectionRegister::Place {
  public:
    Place() = default;  ///< none; whatever is said of it has no effect
    Place(Place&&) noexcept = default;
    Place& operator=(Place&& other) noexcept;
    ~Place();

    /// Who is asked to leave from now on; at once, when everybody is.
    void heldBy(const std::shared_ptr<Connection>& connection);
    /// It is waited for the client: the place may be given to somebody else.
    void idle() noexcept;
    /// It is no longer. False when the connection has been asked to leave meanwhile.
    bool busy() noexcept;
    /// For another client than before: behind a proxy requests of many come on one connection. Where that one has no
    /// place left, his idle ones go; a refusal leaves the place as it is.
    Admitted<void> countFor(const CountedClient& client);

  private:
    friend class ConnectionRegister;
    Place(ConnectionRegister& owner, std::unique_ptr<Entry> entry);

    ConnectionRegister* owner_ = nullptr;
    std::unique_ptr<Entry> entry_;
};

}  // namespace scancast
