// Answers what lies under a pixel: has the scheduler draw the picture's depth, then looks for the point
// there.
//
// Owned by the API. *Thread safety*: any thread. Pipeline: api, stream connection → **picker** → scheduler →
// worker.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "renderer/pick/pick.hpp"
#include "server/net/api/shared_pictures.hpp"
#include "server/net/worker.hpp"

namespace scancast {

/// Called once, on a thread of the scheduler's or the worker's, unless the server ends first; must only post.
/// Errors: the renderer's, the blocks', Cancelled when too much is waiting.
using PickDone = std::function<void(Expected<std::optional<Picked>>)>;

/// InvalidArgument (x, y) unless the pixel lies in the view's picture.
Expected<glm::ivec2> pixelAt(const View& view, double x, double y);

/// Who asked for it, and what its picture costs.
struct PickedFor {
    std::string client{};
    double price = 0;
    std::stop_token gone{};  ///< once it is requested, `done` is not called
};

class Picker {
  public:
    /// Both outlive this.
    Picker(const SharedPictures& pictures, Scheduler& scheduler, std::string version);

    /// Errors, `done` not being called then: those of pixelAt(); DeviceUnavailable; Cancelled when there are
    /// too many pictures waiting.
    Expected<void> pick(std::shared_ptr<const Cloud> cloud, std::shared_ptr<const PlannedView> asked,
                        double x, double y, PickDone done, const PickedFor& by = {}) const;
    /// No `done` is called afterwards. The scheduler must have ended.
    void stop() { worker_.stop(); }

  private:
    const SharedPictures& pictures_;
    Scheduler& scheduler_;
    const std::string version_;
    mutable Worker worker_;
};

}  // namespace scancast
