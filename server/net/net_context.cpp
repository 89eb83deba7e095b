#include "server/net/net_context.hpp"

#include <tuple>
#include <vector>

#include "server/base/faults.hpp"

namespace scancast {

bool ConnectionRegister::add(const std::shared_ptr<Connection>& connection, std::size_t limit) {
    const std::lock_guard lock(mutex_);
    if (shuttingDown_ || connections_.size() >= limit) return false;
    connections_.emplace(connection.get(), connection);
    return true;
}

void ConnectionRegister::remove(const Connection* connection) {
    const std::lock_guard lock(mutex_);
    connections_.erase(connection);
}

std::vector<std::weak_ptr<Connection>> ConnectionRegister::allLocked() const {
    std::vector<std::weak_ptr<Connection>> all;
    for (const auto& [key, connection] : connections_) all.push_back(connection);
    return all;
}

void ConnectionRegister::shutDownAll() {
    std::vector<std::weak_ptr<Connection>> all;
    {
        const std::lock_guard lock(mutex_);
        shuttingDown_ = true;
        all = allLocked();
    }
    for (const auto& weak : all) {
        const auto connection = weak.lock();
        if (connection) std::ignore = contained("Closing a connection", [&] { connection->shutDown(); });
    }
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
    return connections_.size();
}

bool ConnectionRegister::shuttingDown() const {
    const std::lock_guard lock(mutex_);
    return shuttingDown_;
}

}  // namespace scancast
