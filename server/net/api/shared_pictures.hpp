// Snapshots that are asked for again while they are being rendered: drawn once, handed to everybody who
// waits.
//
// Owned by the API. *Thread safety*: any thread. Pipeline: api → **shared pictures** → scheduler.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/scheduler/scheduler.hpp"

namespace scancast {

class SharedPictures {
  public:
    /// The scheduler outlives this.
    explicit SharedPictures(Scheduler& scheduler) : scheduler_(scheduler) {}

    /// As Scheduler::snapshot(). `tag` is the picture's ETag: equal exactly when the bytes are. Who comes
    /// later shares the deadline of the first.
    Expected<void> order(const std::string& tag, PictureOrder order, PictureDone done) const;
    /// Who waits for a picture now.
    std::size_t waiting() const;

  private:
    struct Waiting {
        /// Whether this is the first, who has to order the picture.
        bool add(const std::string& tag, PictureDone done);
        std::vector<PictureDone> take(const std::string& tag);
        std::size_t size() const;

        mutable std::mutex mutex;
        std::map<std::string, std::vector<PictureDone>> byTag;
    };

    Scheduler& scheduler_;
    const std::shared_ptr<Waiting> waiting_ = std::make_shared<Waiting>();  // pictures may outlive this
};

}  // namespace scancast
