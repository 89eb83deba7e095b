#include "server/scheduler/scheduler.hpp"

#include <algorithm>
#include <utility>

#include "renderer/clock.hpp"
#include "server/scheduler/outcome.hpp"

namespace scancast {

Scheduler::Scheduler(OpenPainter openPainter, const SchedulerOptions& options, Metrics& metrics)
    : openPainter_(std::move(openPainter)), options_(options), metrics_(metrics) {
    renderThread_ = std::thread([this] { renderLoop(); });
    prepareThread_ = std::thread([this] { prepareLoop(); });
    encodeThread_ = std::thread([this] { encodeLoop(); });
    deadlineThread_ = std::thread([this] { deadlineLoop(); });
}

Scheduler::~Scheduler() {
    stop();
    wait();
}

void Scheduler::wait() {
    for (std::thread* thread : {&renderThread_, &prepareThread_, &encodeThread_, &deadlineThread_}) {
        if (thread->joinable()) thread->join();
    }
}

DeviceStatus Scheduler::device() const {
    const std::lock_guard lock(mutex_);
    return device_;
}

DeviceStatus Scheduler::waitForDevice(std::chrono::milliseconds patience) const {
    std::unique_lock lock(mutex_);
    opened_.wait_for(lock, patience,
                     [&] { return device_.state != DeviceStatus::State::Opening || stopping_; });
    return device_;
}

Scheduler::MailboxId Scheduler::openMailbox() {
    const std::lock_guard lock(mutex_);
    mailboxes_.emplace(++lastMailbox_, std::nullopt);
    return lastMailbox_;
}

void Scheduler::closeMailbox(MailboxId mailbox) {
    std::vector<Wish> dropped;
    {
        const std::lock_guard lock(mutex_);
        const auto at = mailboxes_.find(mailbox);
        if (at == mailboxes_.end()) return;
        dropped = takePreparing(mailbox, true);
        if (at->second) dropped.push_back(std::move(*at->second));
        mailboxes_.erase(at);
        std::erase(turns_, mailbox);
        for (auto* busy : allBusy())
            if (*busy && (*busy)->mailbox == mailbox) (*busy)->orphaned = true;
        stopRunning(mailbox, true);
    }
    for (Wish& wish : dropped) finish(wish, tl::unexpected(cancelled()), DropReason::Gone);
}

void Scheduler::wish(MailboxId mailbox, PictureOrder order, PictureDone done) {
    order.requester = mailbox;
    Wish wish{std::move(order), std::move(done), Clock::time_point::max(), mailbox};
    if (wish.order.interruptible) wish.givesWayUntil = Clock::now() + options_.stillPatience;
    std::optional<Wish> overwritten;
    std::vector<Wish> abandoned;
    bool refused = false;
    {
        const std::lock_guard lock(mutex_);
        const auto at = mailboxes_.find(mailbox);
        refused = stopping_ || at == mailboxes_.end();
        if (!refused) {
            overwritten = std::exchange(at->second, std::move(wish));
            if (!overwritten) turns_.push_back(mailbox);
            abandoned = takePreparing(mailbox, false);
            stopRunning(mailbox, false);
            if (!at->second->order.interruptible) makeWay();
        }
    }
    work_.notify_one();
    for (Wish& old : abandoned) finish(old, tl::unexpected(cancelled()), DropReason::Abandoned);
    if (refused) finish(wish, tl::unexpected(cancelled()), std::nullopt);
    if (overwritten) finish(*overwritten, tl::unexpected(cancelled()), DropReason::Overwritten);
}

bool Scheduler::replaceWaiting(MailboxId mailbox, PictureOrder order, PictureDone done) {
    order.requester = mailbox;
    std::optional<Wish> overwritten;
    {
        const std::lock_guard lock(mutex_);
        const auto at = mailboxes_.find(mailbox);
        if (stopping_ || at == mailboxes_.end() || !at->second) return false;
        Wish wish{std::move(order), std::move(done), Clock::time_point::max(), mailbox};
        if (wish.order.interruptible) wish.givesWayUntil = Clock::now() + options_.stillPatience;
        overwritten = std::exchange(at->second, std::move(wish));
        if (!at->second->order.interruptible) makeWay();
    }
    finish(*overwritten, tl::unexpected(cancelled()), DropReason::Overwritten);
    return true;
}

void Scheduler::abandon(MailboxId mailbox) {
    std::vector<Wish> dropped;
    {
        const std::lock_guard lock(mutex_);
        const auto at = mailboxes_.find(mailbox);
        if (at == mailboxes_.end()) return;
        dropped = takePreparing(mailbox, false);
        if (at->second) {
            dropped.push_back(*std::exchange(at->second, std::nullopt));
            std::erase(turns_, mailbox);
        }
        stopRunning(mailbox, false);
    }
    for (Wish& wish : dropped) finish(wish, tl::unexpected(cancelled()), DropReason::Abandoned);
}

Expected<void> Scheduler::snapshot(PictureOrder order, PictureDone done) {
    {
        const std::lock_guard lock(mutex_);
        if (stopping_ || draining_) return fail(ErrorCode::ResourceLimit, "The server is shutting down.");
        const auto waiting = std::count_if(toPrepare_.begin(), toPrepare_.end(),
                                           [](const Wish& wish) { return wish.mailbox == snapshots; });
        if (snapshots_.size() + std::size_t(waiting) >= options_.maxSnapshots) {
            return fail(ErrorCode::ResourceLimit,
                        "Too many pictures are waiting to be rendered; try again in a moment.");
        }
        if (snapshots_.empty()) turns_.push_back(snapshots);
        snapshots_.push_back(
            {std::move(order), std::move(done), Clock::now() + options_.snapshotDeadline, snapshots});
    }
    work_.notify_one();
    deadlines_.notify_one();
    return {};
}

void Scheduler::drain() {
    const std::lock_guard lock(mutex_);
    draining_ = true;
}

bool Scheduler::draining() const {
    const std::lock_guard lock(mutex_);
    return draining_ || stopping_;
}

bool Scheduler::idle() const {
    const std::lock_guard lock(mutex_);
    return turns_.empty() && toPrepare_.empty() && encoding_.empty() && !prepared_ && !running_ && !begun_ &&
           !preparing_;
}

void Scheduler::stop() {
    std::deque<Wish> dropped;
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
        dropped = std::exchange(snapshots_, {});
        for (auto& [id, wish] : mailboxes_) {
            if (wish) dropped.push_back(*std::exchange(wish, std::nullopt));
        }
        for (Wish& wish : toPrepare_) dropped.push_back(std::move(wish));
        toPrepare_.clear();
        if (prepared_) dropped.push_back(*std::exchange(prepared_, std::nullopt));
        turns_.clear();
        for (auto* busy : allBusy())
            if (*busy) (*busy)->stop.request_stop();
    }
    work_.notify_all();
    prepareWork_.notify_all();
    encodeWork_.notify_all();
    deadlines_.notify_all();
    opened_.notify_all();
    for (Wish& wish : dropped) finish(wish, tl::unexpected(cancelled()), DropReason::Gone);
}

// Called with the lock held.
void Scheduler::stopRunning(MailboxId mailbox, bool alsoMoving) {
    for (auto* busy : allBusy()) {
        if (!*busy || (*busy)->mailbox != mailbox || !(alsoMoving || (*busy)->interruptible)) continue;
        (*busy)->gaveWay = false;  // nobody wants it any more
        (*busy)->stop.request_stop();
    }
}

// Stops a still that is being drawn, for a moving frame that somebody else waits for; blocks may go on being
// loaded meanwhile. Called with the lock held.
void Scheduler::makeWay() {
    for (auto* busy : {&running_, &begun_}) {
        if (!*busy || (*busy)->stop.stop_requested() || Clock::now() >= (*busy)->givesWayUntil) continue;
        (*busy)->gaveWay = true;
        (*busy)->stop.request_stop();
    }
}

// The still gave way, and nothing has taken its place in its mailbox since. Called with the lock held.
bool Scheduler::putBack(Wish& wish) {
    const auto at = mailboxes_.find(wish.mailbox);
    if (stopping_ || at == mailboxes_.end() || at->second) return false;
    wish.prepared.reset();
    at->second = std::move(wish);
    turns_.push_back(at->first);
    work_.notify_one();
    return true;
}

Scheduler::Running Scheduler::runningOf(const Wish& wish) {
    Running running;
    running.mailbox = wish.mailbox;
    running.interruptible = wish.order.interruptible;
    running.deadline = wish.deadline;
    running.givesWayUntil = wish.givesWayUntil;
    return running;
}

// The session's wishes that wait for blocks, or for a turn with them. Called with the lock held.
std::vector<Scheduler::Wish> Scheduler::takePreparing(MailboxId mailbox, bool alsoMoving) {
    std::vector<Wish> taken;
    const auto isMeant = [&](const Wish& wish) {
        return wish.mailbox == mailbox && (alsoMoving || wish.order.interruptible);
    };
    for (Wish& wish : toPrepare_)
        if (isMeant(wish)) taken.push_back(wish);
    std::erase_if(toPrepare_, isMeant);
    if (prepared_ && isMeant(*prepared_)) {
        taken.push_back(*std::exchange(prepared_, std::nullopt));
        taken.back().prepared.reset();
        std::erase(turns_, preparedOne);
        prepareWork_.notify_one();
    }
    return taken;
}

// Called without the lock, because `done` is somebody else's code.
void Scheduler::finish(Wish& wish, Expected<Picture> result, std::optional<DropReason> dropped) {
    if (dropped) metrics_.frameDropped(*dropped);
    wish.done(std::move(result));
}

// ---- prepare thread
// -------------------------------------------------------------------------------------------

void Scheduler::prepareLoop() {
    std::unique_lock lock(mutex_);
    while (true) {
        prepareWork_.wait(lock, [&] { return stopping_ || (!toPrepare_.empty() && !prepared_); });
        if (stopping_) return;
        Wish wish = std::move(toPrepare_.front());
        toPrepare_.pop_front();
        preparing_ = runningOf(wish);
        deadlines_.notify_one();
        lock.unlock();
        prepareOne(std::move(wish));
        lock.lock();
    }
}

void Scheduler::prepareOne(Wish wish) {
    std::stop_token token;
    PreparePicture prepare;
    {
        const std::lock_guard lock(mutex_);
        token = preparing_->stop.get_token();
        prepare = prepare_;
    }
    auto prepared = guarded([&] { return prepare(wish.order, true, token); });
    Running how;
    {
        const std::lock_guard lock(mutex_);
        how = *std::exchange(preparing_, std::nullopt);
        if (prepared && !stopping_ && !how.stop.stop_requested()) {
            wish.prepared = std::move(*prepared);
            wish.prepared->complete = true;  // damaged blocks have their stand-ins: nothing more will come
            prepared_ = std::move(wish);
            turns_.push_back(preparedOne);
            work_.notify_one();
            return;
        }
    }
    finishFailed(wish, prepared ? cancelled() : std::move(prepared.error()), how);
}

// ---- encode thread
// --------------------------------------------------------------------------------------------

void Scheduler::encodeLoop() {
    std::unique_lock lock(mutex_);
    while (true) {
        encodeWork_.wait(lock, [&] { return !encoding_.empty() || (stopping_ && !rendering_); });
        if (encoding_.empty()) return;
        Rendered job = std::move(encoding_.front());
        lock.unlock();
        const auto start = Clock::now();
        auto bytes = encodePicture(job.frame, job.wish.order.view, job.wish.order.format);
        const double encodeMs = millisecondsSince(start);
        if (!bytes) {
            finish(job.wish, tl::unexpected(std::move(bytes.error())), DropReason::Failed);
        } else if (Clock::now() > job.wish.deadline) {
            finish(job.wish, tl::unexpected(tooLate()), DropReason::Deadline);
        } else {
            metrics_.frameEncoded(encodeMs / 1000, bytes->size());
            Picture picture;
            picture.bytes = std::make_shared<const Bytes>(std::move(*bytes));
            picture.width = job.frame.width;
            picture.height = job.frame.height;
            picture.stats = std::move(job.frame.stats);
            picture.stats.add("encode", encodeMs);
            picture.renderMs = job.renderMs;
            picture.encodeMs = encodeMs;
            picture.rivals = job.wish.rivals;
            picture.device = std::move(job.device);
            finish(job.wish, std::move(picture), std::nullopt);
        }
        job = {};
        lock.lock();
        encoding_.pop_front();  // only now, so that the bound counts what is being encoded too
        work_.notify_one();
    }
}

// ---- deadline thread
// ------------------------------------------------------------------------------------------

void Scheduler::deadlineLoop() {
    std::unique_lock lock(mutex_);
    while (!stopping_) {
        // All snapshots have the same patience, so the queue is sorted by deadline.
        auto next = Clock::time_point::max();
        if (!snapshots_.empty()) next = snapshots_.front().deadline;
        for (const Wish& wish : toPrepare_) next = std::min(next, wish.deadline);
        for (const auto* busy : allBusy())
            if (*busy && !(*busy)->late) next = std::min(next, (*busy)->deadline);
        if (next == Clock::time_point::max()) {
            deadlines_.wait(lock);
            continue;
        }
        if (Clock::now() < next) {
            deadlines_.wait_until(lock, next);
            continue;
        }
        for (auto* busy : allBusy()) {
            if (!*busy || (*busy)->deadline > next) continue;
            (*busy)->late = true;
            (*busy)->stop.request_stop();
        }
        std::vector<Wish> late;
        if (!snapshots_.empty() && snapshots_.front().deadline <= next) {
            late.push_back(std::move(snapshots_.front()));
            snapshots_.pop_front();
            if (snapshots_.empty()) std::erase(turns_, snapshots);
        }
        for (const Wish& wish : toPrepare_)
            if (wish.deadline <= next) late.push_back(wish);
        std::erase_if(toPrepare_, [&](const Wish& wish) { return wish.deadline <= next; });
        lock.unlock();
        for (Wish& wish : late) finish(wish, tl::unexpected(tooLate()), DropReason::Deadline);
        lock.lock();
    }
}

}  // namespace scancast
