// Handlers of what a connection waits for: they keep the connection alive meanwhile. An exception in one
// closes that connection, and so does an operation that is dropped on its way because something below threw:
// a connection that nothing more will happen on must not stay open. The network threads never see an
// exception of a connection's.
//
// Owned by the operations; called, and dropped, on the connection's strand. `Self` has fault(), which closes
// it and throws nothing.
#pragma once

#include <memory>
#include <utility>

#include "server/base/faults.hpp"

namespace scancast {

/// Does work() for a connection.
template <class Self, class Work>
void onBehalfOf(Self& self, Work&& work) {
    if (!contained("A connection", std::forward<Work>(work))) self.fault();
}

/// Move-only; called once, with work(self, arguments of the operation ...).
template <class Self, class Work>
class Handler {
  public:
    Handler(std::shared_ptr<Self> self, Work work) : self_(std::move(self)), work_(std::move(work)) {}
    Handler(Handler&&) = default;
    ~Handler() {
        if (self_) self_->fault();
    }
    template <class... Arguments>
    void operator()(Arguments&&... arguments) {
        const std::shared_ptr<Self> self = std::exchange(self_, nullptr);
        onBehalfOf(*self, [&] { work_(*self, std::forward<Arguments>(arguments)...); });
    }

  private:
    std::shared_ptr<Self> self_;
    Work work_;
};

/// The same where a handler must be copied; the copies are one.
template <class Self, class Work>
auto sharedHandler(std::shared_ptr<Self> self, Work work) {
    auto one = std::make_shared<Handler<Self, Work>>(std::move(self), std::move(work));
    return [one = std::move(one)](auto... arguments) { (*one)(arguments...); };
}

}  // namespace scancast
