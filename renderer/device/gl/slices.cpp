#include "renderer/device/gl/slices.hpp"

#include <algorithm>

namespace scancast::gl {
namespace {

/// OpenGL promises 65,535 work groups.
constexpr std::uint32_t largestSlice = 32768;
constexpr double shortSliceMs = 2, longSliceMs = 6;

}  // namespace

Slices::~Slices() {
    for (const Fence& fence : underWay_) {
        if (fence.sync) gl_.DeleteSync(fence.sync);
    }
}

void Slices::learn(std::uint32_t groups, double milliseconds) {
    if (groups < slice_) return;  // the end of a page, or from before slices grew: it says little
    if (milliseconds < shortSliceMs) slice_ = std::min(slice_ * 2, largestSlice);
    if (milliseconds > longSliceMs) slice_ = std::max(slice_ / 2, 1u);
}

Expected<void> Slices::finishOldest() {
    const Fence oldest = underWay_[0];
    underWay_ = {underWay_[1], {}};
    if (!oldest.sync) return {};
    if (auto finished = finishFence(gl_, oldest.sync, "drawing a slice of a picture"); !finished)
        return finished;
    const auto now = Clock::now();
    learn(oldest.groups, std::chrono::duration<double, std::milli>(now - last_).count());
    last_ = now;
    return {};
}

Expected<void> Slices::dispatch(std::uint32_t first, std::uint32_t count, const std::stop_token& stop) {
    for (const std::uint32_t end = first + count; first < end;) {
        if (underWay_[1].sync) {
            if (auto finished = finishOldest(); !finished) return finished;
        }
        if (stop.stop_requested())
            return fail(ErrorCode::Cancelled, "The picture was abandoned: it is no longer wanted.");
        if (!underWay_[0].sync) last_ = Clock::now();
        const std::uint32_t groups = std::min(slice_, end - first);
        gl_.Uniform1ui(0, first);
        gl_.DispatchCompute(groups, 1, 1);
        underWay_[underWay_[0].sync ? 1 : 0] = {gl_.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0), groups};
        first += groups;
    }
    return {};
}

}  // namespace scancast::gl
