#include "server/net/api/shared_pictures.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "server/base/faults.hpp"

namespace scancast {
namespace {

void answer(const PictureDone& one, const Expected<EncodedPicture>& result) {
    std::ignore = contained("Handing over a picture", [&] { one(result); });
}

}  // namespace

// What waits for somebody's leaving is destroyed by whoever takes it, without the lock: that may have to wait for
// its function, which takes the lock.
SharedPictures::Waiters SharedPictures::Waiting::take(const std::string& tag, std::uint64_t number) {
    const std::lock_guard lock(mutex);
    const auto at = byTag.find(tag);
    if (at == byTag.end() || at->second.number != number) return {};
    Waiters all = std::move(at->second.waiters);
    byTag.erase(at);
    return all;
}

/// The snapshot that nobody waits for any more, if that was the last one.
std::optional<Scheduler::SnapshotId> SharedPictures::Waiting::leave(const std::string& tag,
                                                                    const Waiter* waiter) {
    Waiters left;  // ends without the lock
    const std::lock_guard lock(mutex);
    const auto at = byTag.find(tag);
    if (at == byTag.end()) return std::nullopt;
    Waiters& all = at->second.waiters;
    const auto one =
        std::find_if(all.begin(), all.end(), [&](const Waiter& other) { return &other == waiter; });
    if (one == all.end()) return std::nullopt;
    left.splice(left.end(), all, one);
    if (!all.empty() || !at->second.snapshot) return std::nullopt;
    const auto snapshot = at->second.snapshot;
    byTag.erase(at);
    return snapshot;
}

std::size_t SharedPictures::waiting() const {
    const std::lock_guard lock(waiting_->mutex);
    std::size_t all = 0;
    for (const auto& [tag, picture] : waiting_->byTag) all += picture.waiters.size();
    return all;
}

SharedPictures::Added SharedPictures::add(const std::string& tag, const PictureDone& done,
                                          const std::stop_token& gone, bool mayBeFirst) const {
    Waiters one(1);
    Waiter* const waiter = &one.front();
    waiter->done = done;
    const auto leave = [waiting = waiting_, &scheduler = scheduler_, tag, waiter] {
        // Called by what the waiter has, which ends with him: copies, for this function is gone before it returns.
        const auto all = waiting;
        Scheduler& maker = scheduler;
        const std::string its = tag;
        if (const auto snapshot = all->leave(its, waiter)) maker.abandonSnapshot(*snapshot);
    };
    if (gone.stop_possible())
        waiter->leaves = std::make_unique<std::stop_callback<std::function<void()>>>(gone, leave);
    Added added;
    {
        const std::lock_guard lock(waiting_->mutex);
        const auto at = waiting_->byTag.find(tag);
        if (at == waiting_->byTag.end() && !mayBeFirst) return added;
        added.isFirst = at == waiting_->byTag.end();
        Picture& picture = added.isFirst ? waiting_->byTag[tag] : at->second;
        if (added.isFirst) picture.number = ++waiting_->last;
        added.number = picture.number;
        picture.waiters.splice(picture.waiters.end(), one);
    }
    if (gone.stop_requested()) leave();  // perhaps before it was here
    return added;
}

bool SharedPictures::join(const std::string& tag, const PictureDone& done,
                          const std::stop_token& gone) const {
    return add(tag, done, gone, false).number != 0;
}

Expected<void> SharedPictures::order(const std::string& tag, PictureOrder order, PictureDone done,
                                     const std::stop_token& gone) const {
    const Added added = add(tag, done, gone, true);
    if (!added.isFirst) return {};
    auto queued = contained("The queue of pictures", [&] {
        return scheduler_.snapshot(std::move(order), [waiting = waiting_, tag, number = added.number](
                                                         const Expected<EncodedPicture>& result) {
            for (const Waiter& one : waiting->take(tag, number)) answer(one.done, result);
        });
    });
    if (queued) {
        // Whoever left before it had a number has not ended it.
        bool nobody = false;
        {
            const std::lock_guard lock(waiting_->mutex);
            const auto at = waiting_->byTag.find(tag);
            if (at == waiting_->byTag.end() || at->second.number != added.number) return {};  // answered
            at->second.snapshot = *queued;
            nobody = at->second.waiters.empty();
            if (nobody) waiting_->byTag.erase(at);
        }
        if (nobody) scheduler_.abandonSnapshot(*queued);
        return {};
    }
    // Whoever joined in between waits for a picture that will never come.
    const Expected<EncodedPicture> full = fail(ErrorCode::Cancelled, queued.error().message);
    const auto others = waiting_->take(tag, added.number);
    for (auto at = others.begin(); at != others.end(); ++at)
        if (at != others.begin()) answer(at->done, full);
    return passOn(queued);
}

}  // namespace scancast
