// The scheduler's render thread: opens the device, takes wishes, begins pictures and finishes them, and has
// another painter take over when the device is lost.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "renderer/clock.hpp"
#include "server/scheduler/outcome.hpp"
#include "server/scheduler/scheduler.hpp"

namespace scancast {
namespace {

template <class T>
bool isLost(const Expected<T>& result) {
    return !result && result.error().code == ErrorCode::DeviceLost;
}

}  // namespace

// ---- the device

void Scheduler::openDevice() {
    usePainter(openPainter_(), std::nullopt);
}

void Scheduler::usePainter(Expected<Painter> opened, std::optional<LostDevice> lost) {
    DeviceStatus status;
    status.lost = std::move(lost);
    if (opened) {
        painter_ = std::move(*opened);
        status.state = DeviceStatus::State::Ready;
        status.info = painter_->device;
    } else {
        status.state = DeviceStatus::State::Failed;
        status.error = std::move(opened.error());
    }
    metrics_.setDevice(status.info.name, status.info.renderer);
    const std::lock_guard lock(mutex_);
    if (painter_) prepare_ = painter_->prepare;
    device_ = std::move(status);
    opened_.notify_all();
}

void Scheduler::replacePainter(const Error& lost) {
    LostDevice device{painter_->device, lost};
    const OpenPainter instead = painter_->instead;
    painter_.reset();  // a device is closed on the thread that opened it, and before another takes its place
    ++painterNumber_;
    metrics_.deviceLost();
    spdlog::error("The device {} was lost: {}", title(device.info), lost.message);
    auto opened = instead ? instead() : Expected<Painter>(tl::unexpected(lost));
    if (opened) {
        spdlog::warn("drawing with {} from now on; to try {} again, restart", title(opened->device),
                     device.info.name);
    } else if (instead) {
        opened.error() = {ErrorCode::DeviceLost,
                          lost.message + " Nor can another take its place: " + opened.error().message,
                          {}};
        spdlog::error("{}", opened.error().message);
    }
    usePainter(std::move(opened), std::move(device));
}

// ---- one picture after the other

void Scheduler::renderLoop() {
    openDevice();
    std::optional<Begun> begun;  // its pixels may still be on their way
    std::unique_lock lock(mutex_);
    while (true) {
        // Room for the result first, and only then a wish: what is taken is then as new as can be.
        work_.wait(lock, [&] {
            return stopping_ || (encoding_.size() < maxEncoding && (begun || !turns_.empty()));
        });
        if (stopping_) break;
        lock.unlock();
        // What is finished waits for nobody else's picture to be begun.
        if (begun && begun->frame->ready())
            completeOne(*std::exchange(begun, std::nullopt));
        else
            beginNext(begun);
        lock.lock();
    }
    lock.unlock();
    if (begun) completeOne(std::move(*begun));
    painter_.reset();
    lock.lock();
    rendering_ = false;
    encodeWork_.notify_all();
}

/// Begins the next picture, if one is wished for, and only then waits for the pixels of the one before.
void Scheduler::beginNext(std::optional<Begun>& begun) {
    std::optional<Wish> wish;
    {
        const std::lock_guard lock(mutex_);
        wish = takeNext();
    }
    // A still or a snapshot may take long to begin, and a moving frame's pixels do not wait for that.
    if (wish && wish->order.complete && begun) completeOne(*std::exchange(begun, std::nullopt));
    std::optional<Begun> next;
    if (wish) next = beginOne(std::move(*wish));
    if (begun) completeOne(std::move(*begun));
    begun = std::move(next);
    if (!begun) return;
    const std::lock_guard lock(mutex_);
    begun_ = std::exchange(running_, std::nullopt);
}

// What waits for that turn, or nullptr. Called with the lock held.
const Scheduler::Wish* Scheduler::waiting(MailboxId turn) const {
    if (turn == preparedOne) return prepared_ ? &*prepared_ : nullptr;
    if (turn == snapshots) return snapshots_.empty() ? nullptr : &snapshots_.front();
    const auto at = mailboxes_.find(turn);
    return at == mailboxes_.end() || !at->second ? nullptr : &*at->second;
}

// The first in line, but for stills that give way to somebody behind them. Called with the lock held.
Scheduler::MailboxId Scheduler::takeTurn() {
    const auto now = Clock::now();
    const auto takesIt = [&](MailboxId turn) {
        const Wish* wish = waiting(turn);
        return wish && now >= wish->givesWayUntil;
    };
    auto at = std::find_if(turns_.begin(), turns_.end(), takesIt);
    if (at == turns_.end()) at = turns_.begin();
    const MailboxId turn = *at;
    turns_.erase(at);
    return turn;
}

std::optional<Scheduler::Wish> Scheduler::takeNext() {
    if (turns_.empty()) return std::nullopt;
    const MailboxId turn = takeTurn();
    std::optional<Wish> wish;
    if (turn == preparedOne) {
        wish = std::exchange(prepared_, std::nullopt);
        if (!wish) return std::nullopt;
    } else if (turn == snapshots) {
        if (snapshots_.empty()) return std::nullopt;
        wish = std::move(snapshots_.front());
        snapshots_.pop_front();
        if (!snapshots_.empty()) turns_.push_back(snapshots);
    } else {
        const auto at = mailboxes_.find(turn);
        if (at == mailboxes_.end()) return std::nullopt;
        wish = std::exchange(at->second, std::nullopt);
        if (!wish) return std::nullopt;
    }
    wish->rivals = movingWishes();
    running_ = runningOf(*wish);
    deadlines_.notify_one();
    return wish;
}

// Called with the lock held.
std::size_t Scheduler::movingWishes() const {
    return std::size_t(std::count_if(mailboxes_.begin(), mailboxes_.end(), [](const auto& mailbox) {
        return mailbox.second && !mailbox.second->order.complete;
    }));
}

std::optional<Scheduler::Begun> Scheduler::beginOne(Wish wish) {
    std::stop_token token;
    {
        const std::lock_guard lock(mutex_);
        token = running_->stop.get_token();
    }
    const auto start = Clock::now();
    bool deferred = false;
    auto frame = begin(wish, token, deferred);
    wish.prepared.reset();  // what is begun needs no samples any more
    if (!frame) {
        endWithout(running_, std::move(wish), std::move(frame.error()), deferred);
        return std::nullopt;
    }
    return Begun{std::move(wish), std::move(*frame), painter_->device, painterNumber_,
                 millisecondsSince(start)};
}

/// `deferred`: the picture lacks blocks that it must not lack.
Expected<std::unique_ptr<PendingFrame>> Scheduler::begin(Wish& wish, const std::stop_token& token,
                                                         bool& deferred) {
    while (painter_) {
        if (!wish.prepared) {
            auto prepared = guarded([&] { return painter_->prepare(wish.order, false, token); });
            if (!prepared) return tl::unexpected(std::move(prepared.error()));
            wish.prepared = std::move(*prepared);
        }
        deferred = wish.order.complete && !wish.prepared->complete;
        if (deferred) return tl::unexpected(cancelled());
        wish.lacking = wish.order.onlyWhole && !wish.prepared->complete;
        if (wish.lacking) return fail(ErrorCode::Cancelled, "Samples of this picture are still to be read.");
        auto frame = guarded([&] { return painter_->begin(wish.order, *wish.prepared, token); });
        if (!isLost(frame)) return frame;
        replacePainter(frame.error());
    }
    return tl::unexpected(device().error);
}

void Scheduler::completeOne(Begun begun) {
    std::stop_token token;
    {
        const std::lock_guard lock(mutex_);
        token = begun_->stop.get_token();
    }
    const auto start = Clock::now();
    bool deferred = false;
    auto frame = finish(begun, token, deferred);
    begun.wish.prepared.reset();
    if (!frame) return endWithout(begun_, std::move(begun.wish), std::move(frame.error()), deferred);
    const double renderMs = begun.renderMs + millisecondsSince(start);
    metrics_.frameRendered(begun.wish.order.view.style.method, renderMs / 1000,
                           frame->stats.samplesMissing == 0);
    metrics_.setDeviceMemory(frame->stats.deviceBytes);
    const std::lock_guard lock(mutex_);
    begun_.reset();
    encoding_.push_back({std::move(begun.wish), std::move(*frame), std::move(begun.device), renderMs});
    encodeWork_.notify_one();
}

/// What was lost with its device is begun again with the painter that took over.
Expected<Frame> Scheduler::finish(Begun& begun, const std::stop_token& token, bool& deferred) {
    while (true) {
        auto frame = guarded([&] { return begun.frame->finish(); });
        begun.frame.reset();
        if (!isLost(frame)) return frame;
        if (begun.painter == painterNumber_) replacePainter(frame.error());
        auto again = begin(begun.wish, token, deferred);
        if (!again) return tl::unexpected(std::move(again.error()));
        begun.frame = std::move(*again);
        begun.device = painter_->device;
        begun.painter = painterNumber_;
    }
}

/// The picture in `slot` ends without one: it waits for blocks, gave way to another, or failed.
void Scheduler::endWithout(std::optional<Running>& slot, Wish wish, Error error, bool deferred) {
    Running how;
    {
        const std::lock_guard lock(mutex_);
        how = *std::exchange(slot, std::nullopt);
        if (deferred && !stopping_ && !how.stop.stop_requested()) {
            toPrepare_.push_back(std::move(wish));
            prepareWork_.notify_one();
            deadlines_.notify_one();
            return;
        }
        if (how.gaveWay && !how.orphaned && putBack(wish)) return;
    }
    finishFailed(wish, std::move(error), how);
}

void Scheduler::finishFailed(Wish& wish, Error error, const Running& how) {
    if (how.late) return finish(wish, tl::unexpected(tooLate()), DropReason::Deadline);
    const bool wasCancelled = error.code == ErrorCode::Cancelled;
    finish(wish, tl::unexpected(std::move(error)),
           how.orphaned   ? DropReason::Gone
           : wish.lacking ? DropReason::Lacking
           : wasCancelled ? DropReason::Abandoned
                          : DropReason::Failed);
}

}  // namespace scancast
