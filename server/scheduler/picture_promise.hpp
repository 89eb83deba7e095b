// The callback of an order, as something that can be passed on but not lost: it is called exactly once, also
// when an exception drops the order on its way. Move-only; owned by the order, used by one thread at a time.
#pragma once

#include <tuple>
#include <utility>

#include "server/base/faults.hpp"
#include "server/scheduler/picture_order.hpp"

namespace scancast {

class PicturePromise {
  public:
    PicturePromise() = default;  ///< nobody waits for it
    explicit PicturePromise(PictureDone done) noexcept : done_(std::move(done)) {}
    PicturePromise(PicturePromise&& other) noexcept : done_(std::exchange(other.done_, nullptr)) {}
    PicturePromise& operator=(PicturePromise&& other) noexcept {
        if (this != &other) {
            dropped();
            done_ = std::exchange(other.done_, nullptr);
        }
        return *this;
    }
    ~PicturePromise() { dropped(); }

    /// The first result counts. What the callback throws is its own affair, and logged.
    void keep(Expected<EncodedPicture> result) noexcept {
        if (!done_) return;
        const PictureDone done = std::exchange(done_, nullptr);
        std::ignore = contained("Handing over a picture", [&] { done(std::move(result)); });
    }

    /// The callback is not called: the order was refused in another way.
    void release() noexcept { done_ = nullptr; }

  private:
    void dropped() noexcept {
        if (!done_) return;
        const PictureDone done = std::exchange(done_, nullptr);
        std::ignore = contained("Handing over a failure", [&] {
            done(fail(ErrorCode::Internal, "The picture was lost on its way through the server."));
        });
    }

    PictureDone done_;
};

}  // namespace scancast
