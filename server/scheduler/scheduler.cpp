#include "server/scheduler/scheduler.hpp"

#include <algorithm>
#include <utility>

#include "renderer/image/clock.hpp"
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
    const Monitor::Look look(monitor_);
    return device_;
}

DeviceStatus Scheduler::waitForDevice(std::chrono::milliseconds patience) const {
    Monitor::Lock lock(monitor_);
    monitor_.waitUntil(lock, Clock::now() + patience,
                       [this] { return device_.state != DeviceStatus::State::Opening || stopping_; });
    return device_;
}

Scheduler::MailboxId Scheduler::openMailbox() {
    const Monitor::Lock lock(monitor_);
    mailboxes_.emplace(lastMailbox_ + 1, std::nullopt);
    return ++lastMailbox_;
}

// Called by destructors: nothing here needs memory.
void Scheduler::closeMailbox(MailboxId mailbox) {
    Requests dropped;
    std::optional<Request> waited;
    {
        const Monitor::Lock lock(monitor_);
        const auto at = mailboxes_.find(mailbox);
        if (at == mailboxes_.end()) return;
        dropped = takePreparing(mailbox, true);
        waited = std::exchange(at->second, std::nullopt);
        mailboxes_.erase(at);
        std::erase(turns_, mailbox);
        for (auto* busy : allBusy())
            if (*busy && (*busy)->mailbox == mailbox) (*busy)->orphaned = true;
        stopRunning(mailbox, true);
    }
    drop(std::move(dropped), DropReason::Gone);
    if (waited) drop(*waited, cancelled, DropReason::Gone);
}

Scheduler::Request Scheduler::requestOf(MailboxId mailbox, PictureOrder order, PictureDone done) const {
    order.requester = mailbox;
    Request request{std::move(order), PicturePromise(std::move(done)), Clock::time_point::max(), mailbox};
    if (request.order.interruptible) request.givesWayUntil = Clock::now() + options_.stillPatience;
    return request;
}

void Scheduler::request(MailboxId mailbox, PictureOrder order, PictureDone done) {
    Request request = requestOf(mailbox, std::move(order), std::move(done));
    Requests abandoned;
    const auto fate = contained("The scheduler", [&] { return place(request, abandoned); });
    drop(std::move(abandoned), DropReason::Abandoned);
    if (!fate) return finish(request, tl::unexpected(fate.error()), DropReason::Failed);
    if (*fate == Fate::Refused) drop(request, cancelled, std::nullopt);
    if (*fate == Fate::Overwrote) drop(request, cancelled, DropReason::Overwritten);
}

/// When it overwrote another, `request` is that one afterwards.
Scheduler::Fate Scheduler::place(Request& request, Requests& abandoned) {
    const Monitor::Lock lock(monitor_);
    const auto at = mailboxes_.find(request.mailbox);
    if (stopping_ || at == mailboxes_.end()) return Fate::Refused;
    standInLine(request.mailbox);
    abandoned = takePreparing(request.mailbox, false);
    stopRunning(request.mailbox, false);
    if (!request.order.interruptible) interruptStill();
    if (at->second) {
        std::swap(*at->second, request);
        return Fate::Overwrote;
    }
    at->second = std::move(request);
    return Fate::Waits;
}

bool Scheduler::replaceWaiting(MailboxId mailbox, PictureOrder order, PictureDone done) {
    Request request = requestOf(mailbox, std::move(order), std::move(done));
    {
        const Monitor::Lock lock(monitor_);
        const auto at = mailboxes_.find(mailbox);
        if (stopping_ || at == mailboxes_.end() || !at->second) {
            request.promise.release();
            return false;
        }
        std::swap(*at->second, request);
        if (!at->second->order.interruptible) interruptStill();
    }
    drop(request, cancelled, DropReason::Overwritten);
    return true;
}

void Scheduler::abandon(MailboxId mailbox) {
    Requests dropped;
    std::optional<Request> waited;
    {
        const Monitor::Lock lock(monitor_);
        const auto at = mailboxes_.find(mailbox);
        if (at == mailboxes_.end()) return;
        dropped = takePreparing(mailbox, false);
        waited = std::exchange(at->second, std::nullopt);
        if (waited) std::erase(turns_, mailbox);
        stopRunning(mailbox, false);
    }
    drop(std::move(dropped), DropReason::Abandoned);
    if (waited) drop(*waited, cancelled, DropReason::Abandoned);
}

Expected<void> Scheduler::snapshot(PictureOrder order, PictureDone done) {
    Requests one;
    const auto queued = contained("The queue of pictures", [&]() -> Expected<void> {
        one.emplace_back();
        one.front() = {std::move(order), PicturePromise(std::move(done)),
                       Clock::now() + options_.snapshotDeadline, snapshots};
        const Monitor::Lock lock(monitor_);
        if (stopping_ || draining_) return fail(ErrorCode::ResourceLimit, "The server is shutting down.");
        const auto waiting = std::count_if(toPrepare_.begin(), toPrepare_.end(), [](const Request& request) {
            return request.mailbox == snapshots;
        });
        if (snapshots_.size() + std::size_t(waiting) >= options_.maxSnapshots) {
            return fail(ErrorCode::ResourceLimit,
                        "Too many pictures are waiting to be rendered; try again in a moment.");
        }
        standInLine(snapshots);
        snapshots_.splice(snapshots_.end(), one);
        return {};
    });
    if (!one.empty()) one.front().promise.release();
    return queued;
}

void Scheduler::drain() {
    const Monitor::Lock lock(monitor_);
    draining_ = true;
}

bool Scheduler::draining() const {
    const Monitor::Look look(monitor_);
    return draining_ || stopping_;
}

bool Scheduler::idle() const {
    const Monitor::Look look(monitor_);
    return turns_.empty() && toPrepare_.empty() && prepared_.empty() && encoding_.empty() && !running_ &&
           !begun_ && !preparing_;
}

void Scheduler::stop() {
    Requests dropped;
    {
        const Monitor::Lock lock(monitor_);
        stopping_ = true;  // from here on nothing is added
        for (Requests* waiting : {&snapshots_, &toPrepare_, &prepared_})
            dropped.splice(dropped.end(), *waiting);
        turns_.clear();
        for (auto* busy : allBusy())
            if (*busy) (*busy)->stop.request_stop();
    }
    drop(std::move(dropped), DropReason::Gone);
    MailboxId last = 0;
    while (auto waited = takeWaitingAfter(last)) drop(*waited, cancelled, DropReason::Gone);
}

/// The request of the first mailbox after `last`, which becomes that one's number, that has any.
std::optional<Scheduler::Request> Scheduler::takeWaitingAfter(MailboxId& last) {
    const Monitor::Lock lock(monitor_);
    const auto at = std::find_if(mailboxes_.upper_bound(last), mailboxes_.end(),
                                 [](const auto& mailbox) { return mailbox.second.has_value(); });
    if (at == mailboxes_.end()) return std::nullopt;
    last = at->first;
    return std::exchange(at->second, std::nullopt);
}

// ---- what functions above and threads share; called with the lock held, down to the next line of this kind

// Before anything else is changed: this may fail for want of memory. A turn that nothing waits for does no
// harm.
void Scheduler::standInLine(MailboxId turn) {
    if (std::find(turns_.begin(), turns_.end(), turn) == turns_.end()) turns_.push_back(turn);
}

void Scheduler::stopRunning(MailboxId mailbox, bool alsoMoving) {
    for (auto* busy : allBusy()) {
        if (!*busy || (*busy)->mailbox != mailbox || !(alsoMoving || (*busy)->interruptible)) continue;
        (*busy)->gaveWay = false;  // nobody wants it any more
        (*busy)->stop.request_stop();
    }
}

// Stops a still that is being drawn, for a moving frame that somebody else waits for; blocks may go on being
// loaded meanwhile.
void Scheduler::interruptStill() {
    for (auto* busy : {&running_, &begun_}) {
        if (!*busy || (*busy)->stop.stop_requested() || Clock::now() >= (*busy)->givesWayUntil) continue;
        (*busy)->gaveWay = true;
        (*busy)->stop.request_stop();
    }
}

// The still gave way, and nothing has taken its place in its mailbox since.
bool Scheduler::putBack(Request& request) {
    const auto at = mailboxes_.find(request.mailbox);
    if (stopping_ || at == mailboxes_.end() || at->second) return false;
    standInLine(at->first);
    request.prepared.reset();
    at->second = std::move(request);
    return true;
}

Scheduler::Running Scheduler::runningOf(const Request& request) {
    Running running;
    running.mailbox = request.mailbox;
    running.interruptible = request.order.interruptible;
    running.deadline = request.deadline;
    running.givesWayUntil = request.givesWayUntil;
    return running;
}

// The session's requests that wait for blocks, or for a turn with them.
Scheduler::Requests Scheduler::takePreparing(MailboxId mailbox, bool alsoMoving) {
    Requests taken;
    for (Requests* from : {&toPrepare_, &prepared_}) {
        for (auto at = from->begin(); at != from->end();) {
            const auto request = at++;
            if (request->mailbox != mailbox || !(alsoMoving || request->order.interruptible)) continue;
            request->prepared.reset();
            taken.splice(taken.end(), *from, request);
        }
    }
    if (prepared_.empty()) std::erase(turns_, preparedOne);
    return taken;
}

// ---- how pictures end; called without the lock, because `done` is somebody else's code

void Scheduler::finish(Request& request, Expected<EncodedPicture> result,
                       std::optional<DropReason> dropped) noexcept {
    if (dropped) std::ignore = contained("Counting", [&] { metrics_.frameDropped(*dropped); });
    request.promise.keep(std::move(result));
}

void Scheduler::drop(Request& request, Error (*why)(), std::optional<DropReason> reason) noexcept {
    std::ignore = contained("The scheduler", [&] { finish(request, tl::unexpected(why()), reason); });
}

void Scheduler::drop(Requests requests, DropReason reason) noexcept {
    for (Request& request : requests) drop(request, cancelled, reason);
}

void Scheduler::finishFailed(Request& request, Error error, const Running& how) {
    if (how.late) return finish(request, tl::unexpected(tooLate()), DropReason::Deadline);
    const bool wasCancelled = error.code == ErrorCode::Cancelled;
    finish(request, tl::unexpected(std::move(error)),
           how.orphaned      ? DropReason::Gone
           : request.lacking ? DropReason::Lacking
           : wasCancelled    ? DropReason::Abandoned
                             : DropReason::Failed);
}

// An exception came out of the work on it: its place is free again, and somebody is told.
void Scheduler::endFaulty(std::optional<Running>& slot, Request& request, Error fault) noexcept {
    {
        const Monitor::Lock lock(monitor_);
        slot.reset();
    }
    finish(request, tl::unexpected(std::move(fault)), DropReason::Failed);
}

}  // namespace scancast
