#include "renderer/device/gl/passes/slices.hpp"

#include <algorithm>

namespace scancast::gl {
namespace {

/// OpenGL promises 65,535 work groups.
constexpr std::uint32_t largestSlice = 32768;
constexpr double sliceMs = 4, underWayMs = 3 * sliceMs;
constexpr std::size_t mostUnderWay = 32;
/// What is learned of one slice changes what is known by so much at most: clocks tell of other things, too.
constexpr double mostFaster = 2, mostSlower = 8;
/// However quick a GPU seems - slices that were done while nobody looked seem to take no time -, no more is
/// under way than a few of the largest slices: the next picture may be slow.
constexpr double leastGroupMs = sliceMs / largestSlice;

}  // namespace

Slices::~Slices() {
    for (const Slice& slice : underWay_) gl_.DeleteSync(slice.fence);
}

Expected<void> Slices::finishOldest() {
    const Slice oldest = underWay_.front();
    underWay_.pop_front();
    groupsUnderWay_ -= oldest.groups;
    if (auto ok = finishFence(gl_, oldest.fence, "drawing a slice of a picture"); !ok) return ok;
    const auto now = Clock::now();
    const double took = std::chrono::duration<double, std::milli>(now - last_).count() / oldest.groups;
    groupMs_ = std::max(std::clamp(took, groupMs_ / mostFaster, groupMs_ * mostSlower), leastGroupMs);
    last_ = now;
    return {};
}

std::uint32_t Slices::sliceOf(std::uint32_t left) const {
    const double groups = std::clamp(sliceMs / groupMs_, 1.0, double(largestSlice));
    return std::min(static_cast<std::uint32_t>(groups), left);
}

bool Slices::hasRoomFor(std::uint32_t groups) const {
    // Two at any rate, or the GPU would wait.
    if (underWay_.size() < 2) return true;
    return underWay_.size() < mostUnderWay && (groupsUnderWay_ + groups) * groupMs_ <= underWayMs;
}

Expected<void> Slices::dispatch(std::uint32_t first, std::uint32_t count, const std::stop_token& stop) {
    for (const std::uint32_t end = first + count; first < end;) {
        const std::uint32_t groups = sliceOf(end - first);
        while (!hasRoomFor(groups)) {
            if (auto ok = finishOldest(); !ok) return ok;
        }
        if (stop.stop_requested())
            return fail(ErrorCode::Cancelled, "The picture was abandoned: it is no longer wanted.");
        if (underWay_.empty()) last_ = Clock::now();
        Slice& slice = underWay_.emplace_back();
        gl_.Uniform1ui(0, first);
        gl_.DispatchCompute(groups, 1, 1);
        slice = {gl_.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0), groups};
        groupsUnderWay_ += groups;
        first += groups;
    }
    return {};
}

}  // namespace scancast::gl
