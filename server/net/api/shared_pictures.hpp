// Snapshots that are asked for again while they are being rendered: drawn once, handed to everybody who
// waits. Who leaves is forgotten, and when the last one has left, so is the picture.
//
// Owned by the API. *Thread safety*: any thread. Pipeline: api → **shared pictures** → scheduler.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/scheduler/scheduler.hpp"

namespace scancast {

class SharedPictures {
  public:
    /// The scheduler outlives this.
    explicit SharedPictures(Scheduler& scheduler) : scheduler_(scheduler) {}

    /// Waits for that picture, too, if it is under way; else false. `tag` is the picture's ETag: equal exactly when the
    /// bytes are. Who comes later shares the deadline of the first. Once `gone` is requested, `done` is not called.
    bool join(const std::string& tag, const PictureDone& done, const std::stop_token& gone) const;
    /// As Scheduler::snapshot(), unless it is under way.
    Expected<void> order(const std::string& tag, PictureOrder order, PictureDone done,
                         const std::stop_token& gone = {}) const;
    /// Who waits for a picture now.
    std::size_t waiting() const;

  private:
    struct Waiter {
        PictureDone done;
        std::unique_ptr<std::stop_callback<std::function<void()>>> leaves{};
    };
    using Waiters = std::list<Waiter>;
    struct Picture {
        std::uint64_t number = 0;  ///< one that was given up is not the next one of its tag
        Waiters waiters;
        std::optional<Scheduler::SnapshotId> snapshot{};  ///< once it has been ordered
    };
    struct Waiting {
        std::mutex mutex;
        std::map<std::string, Picture> byTag;
        std::uint64_t last = 0;
        Waiters take(const std::string& tag, std::uint64_t number);
        std::optional<Scheduler::SnapshotId> leave(const std::string& tag, const Waiter* waiter);
    };
    struct Added {
        std::uint64_t number = 0;  ///< of the picture that is waited for; 0 = none
        bool isFirst = false;
    };

    Added add(const std::string& tag, const PictureDone& done, const std::stop_token& gone,
              bool mayBeFirst) const;

    Scheduler& scheduler_;
    const std::shared_ptr<Waiting> waiting_ = std::make_shared<Waiting>();  // pictures may outlive this
};

}  // namespace scancast
