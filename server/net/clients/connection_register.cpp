#include "server/net/clients/connection_register.hpp"

#include <tuple>
#include <utility>

#include "server/base/faults.hpp"

namespace scancast {
namespace {

void askToLeave(const std::shared_ptr<Connection>& connection) {
    if (connection) std::ignore = contained("Closing a connection", [&] { connection->shutDown(); });
}

}  // namespace

ConnectionRegister::ConnectionRegister(const ConnectionLimits& limits, Metrics* metrics)
    : limits_(limits), metrics_(metrics) {}

tl::unexpected<ConnectionRefusal> ConnectionRegister::refused(ConnectionRefusal why) const {
    if (metrics_) metrics_->connectionRefused(why);
    return tl::unexpected(why);
}

ConnectionRegister::Admitted<ConnectionRegister::Place> ConnectionRegister::enter(
    const CountedClient& counted) {
    auto entry = std::make_unique<Entry>();
    std::shared_ptr<Connection> victim;
    {
        const std::lock_guard lock(mutex_);
        if (shuttingDown_) return refused(ConnectionRefusal::ShuttingDown);
        Client* client = clientLocked(counted);
        auto old = victimLocked(client);
        if (old && *old == nullptr && count_ - leaving_ >= limits_.all) {
            old = idle_.empty() || leaving_ >= limits_.leaving
                      ? Admitted<Entry*>(tl::unexpected(ConnectionRefusal::Full))
                      : Admitted<Entry*>(&idle_.front());
        }
        if (!old) {
            forgetLocked(client);
            return refused(old.error());
        }
        joinLocked(*entry,
                   client);  // first: its client must not be forgotten with the last one of his that goes
        all_.push_back(*entry);
        ++count_;
        victim = sendAwayLocked(*old);
        if (metrics_) metrics_->setConnections(count_);
    }
    askToLeave(victim);
    return Place(*this, std::move(entry));
}

// The client's own that has to go for another one of his; nullptr when none has to.
ConnectionRegister::Admitted<ConnectionRegister::Entry*> ConnectionRegister::victimLocked(
    const Client* client) const {
    if (client == nullptr || client->connections < limits_.perClient) return nullptr;
    if (client->idle.empty() || leaving_ >= limits_.leaving)
        return tl::unexpected(ConnectionRefusal::Address);
    return const_cast<Entry*>(&client->idle.front());
}

std::shared_ptr<Connection> ConnectionRegister::sendAwayLocked(Entry* entry) {
    if (entry == nullptr) return nullptr;
    wakeLocked(*entry);
    partLocked(*entry);
    entry->leaving = true;
    ++leaving_;
    if (metrics_) metrics_->connectionDisplaced();
    return entry->connection.lock();
}

void ConnectionRegister::makeRoom() {
    std::shared_ptr<Connection> victim;
    {
        const std::lock_guard lock(mutex_);
        if (!idle_.empty() && leaving_ < limits_.leaving) victim = sendAwayLocked(&idle_.front());
    }
    askToLeave(victim);
}

ConnectionRegister::Client* ConnectionRegister::clientLocked(const CountedClient& counted) {
    if (!counted.limited) return nullptr;
    const auto at = clients_.try_emplace(counted.client).first;
    at->second.name = &at->first;
    return &at->second;
}

void ConnectionRegister::forgetLocked(Client* client) {
    if (client != nullptr && client->connections == 0) clients_.erase(clients_.find(*client->name));
}

void ConnectionRegister::joinLocked(Entry& entry, Client* client) {
    entry.client = client;
    if (client != nullptr) ++client->connections;
}

void ConnectionRegister::partLocked(Entry& entry) {
    Client* const client = std::exchange(entry.client, nullptr);
    if (client == nullptr) return;
    --client->connections;
    forgetLocked(client);
}

void ConnectionRegister::restLocked(Entry& entry) {
    if (entry.idle || entry.leaving) return;
    entry.idle = true;
    idle_.push_back(entry);
    if (entry.client != nullptr) entry.client->idle.push_back(entry);
}

void ConnectionRegister::wakeLocked(Entry& entry) {
    entry.idle = false;
    entry.waiting.unlink();
    entry.waitingOfClient.unlink();
}

void ConnectionRegister::leave(std::unique_ptr<Entry> entry) {
    const std::lock_guard lock(mutex_);
    wakeLocked(*entry);
    partLocked(*entry);
    if (entry->leaving) --leaving_;
    entry->all.unlink();
    --count_;
    if (metrics_) metrics_->setConnections(count_);
}

std::vector<std::weak_ptr<Connection>> ConnectionRegister::allLocked() const {
    std::vector<std::weak_ptr<Connection>> all;
    all.reserve(count_);
    for (const Entry& entry : all_) all.push_back(entry.connection);
    return all;
}

void ConnectionRegister::shutDownAll() {
    std::vector<std::weak_ptr<Connection>> all;
    {
        const std::lock_guard lock(mutex_);
        shuttingDown_ = true;
        all = allLocked();
    }
    for (const auto& weak : all) askToLeave(weak.lock());
}

void ConnectionRegister::sayGoodbye() const {
    std::vector<std::weak_ptr<Connection>> all;
    {
        const std::lock_guard lock(mutex_);
        all = allLocked();
    }
    for (const auto& weak : all) {
        const auto connection = weak.lock();
        if (connection) std::ignore = contained("Ending a session", [&] { connection->sayGoodbye(); });
    }
}

std::size_t ConnectionRegister::size() const {
    const std::lock_guard lock(mutex_);
    return count_;
}

bool ConnectionRegister::shuttingDown() const {
    const std::lock_guard lock(mutex_);
    return shuttingDown_;
}

ConnectionRegister::Place::Place(ConnectionRegister& owner, std::unique_ptr<Entry> entry)
    : owner_(&owner), entry_(std::move(entry)) {}

ConnectionRegister::Place& ConnectionRegister::Place::operator=(Place&& other) noexcept {
    if (entry_) owner_->leave(std::move(entry_));
    owner_ = other.owner_;
    entry_ = std::move(other.entry_);
    return *this;
}

ConnectionRegister::Place::~Place() {
    if (entry_) owner_->leave(std::move(entry_));
}

void ConnectionRegister::Place::heldBy(const std::shared_ptr<Connection>& connection) {
    if (!entry_) return;
    bool goes = false;
    {
        const std::lock_guard lock(owner_->mutex_);
        entry_->connection = connection;
        goes = entry_->leaving || owner_->shuttingDown_;
    }
    if (goes) askToLeave(connection);
}

void ConnectionRegister::Place::idle() noexcept {
    if (!entry_) return;
    const std::lock_guard lock(owner_->mutex_);
    owner_->restLocked(*entry_);
}

bool ConnectionRegister::Place::busy() noexcept {
    if (!entry_) return true;
    const std::lock_guard lock(owner_->mutex_);
    owner_->wakeLocked(*entry_);
    return !entry_->leaving;
}

ConnectionRegister::Admitted<void> ConnectionRegister::Place::countFor(const CountedClient& counted) {
    if (!entry_) return {};
    std::shared_ptr<Connection> victim;
    {
        const std::lock_guard lock(owner_->mutex_);
        if (entry_->leaving) return {};
        Client* const client = owner_->clientLocked(counted);
        if (client == entry_->client) return {};
        const auto old = owner_->victimLocked(client);
        if (!old) return owner_->refused(old.error());
        const bool wasIdle = entry_->idle;
        owner_->wakeLocked(*entry_);
        owner_->partLocked(*entry_);
        owner_->joinLocked(*entry_, client);
        if (wasIdle) owner_->restLocked(*entry_);
        victim = owner_->sendAwayLocked(*old);
    }
    askToLeave(victim);
    return {};
}

}  // namespace scancast
