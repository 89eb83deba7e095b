// The certificate that is shown now: taken by each connection as it comes, and replaced while others go on with the
// one that they began with.
//
// Owned by the net context. *Thread safety*: every function may be called from any thread.
#pragma once

#include <memory>
#include <mutex>
#include <utility>

#include "server/net/tls/tls.hpp"

namespace scancast {

class CurrentTls {
  public:
    /// Empty = in the clear.
    std::shared_ptr<const ServerTls> get() const {
        const std::lock_guard lock(mutex_);
        return now_;
    }
    void replace(ServerTls tls) {
        auto next = std::make_shared<const ServerTls>(std::move(tls));
        const std::lock_guard lock(mutex_);
        now_.swap(next);
    }

  private:
    mutable std::mutex mutex_;
    std::shared_ptr<const ServerTls> now_;
};

}  // namespace scancast
