#include "server/scheduler/scheduler.hpp"

#include <algorithm>
#include <exception>
#include <utility>

namespace scancast {
namespace {

double millisecondsSince(Scheduler::Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Scheduler::Clock::now() - start).count();
}

Error cancelled() {
    return Error{ErrorCode::Cancelled, "The picture is not wanted any more.", {}};
}

Error tooLate() {
    return Error{
        ErrorCode::DeadlineExceeded,
        "The picture was not ready in time: the server is busy, or the view is too costly. Ask for a smaller "
        "picture, fewer samples or a coarser detail.",
        {}};
}

}  // namespace

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
        for (auto* busy : {&running_, &preparing_})
            if (*busy && (*busy)->mailbox == mailbox) (*busy)->orphaned = true;
        stopRunning(mailbox, true);
    }
    for (Wish& wish : dropped) finish(wish, tl::unexpected(cancelled()), DropReason::Gone);
}

void Scheduler::wish(MailboxId mailbox, PictureOrder order, PictureDone done) {
    order.requester = mailbox;
    Wish wish{std::move(order), std::move(done), Clock::time_point::max(), mailbox};
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
        overwritten = std::exchange(
            at->second, Wish{std::move(order), std::move(done), Clock::time_point::max(), mailbox});
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
        if (stopping_) return fail(ErrorCode::ResourceLimit, "The server is shutting down.");
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
        for (auto* busy : {&running_, &preparing_})
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
    for (auto* busy : {&running_, &preparing_}) {
        if (*busy && (*busy)->mailbox == mailbox && (alsoMoving || (*busy)->interruptible))
            (*busy)->stop.request_stop();
    }
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

// ---- render thread
// --------------------------------------------------------------------------------------------

void Scheduler::openDevice(std::optional<Painter>& painter) {
    DeviceStatus status;
    auto opened = openPainter_();
    if (opened) {
        status.state = DeviceStatus::State::Ready;
        status.info = opened->device;
        painter = std::move(*opened);
        const std::lock_guard lock(mutex_);
        prepare_ = painter->prepare;
    } else {
        status.state = DeviceStatus::State::Failed;
        status.error = std::move(opened.error());
    }
    const std::lock_guard lock(mutex_);
    device_ = std::move(status);
    opened_.notify_all();
}

void Scheduler::renderLoop() {
    std::optional<Painter> painter;
    openDevice(painter);
    std::unique_lock lock(mutex_);
    while (true) {
        // Room for the result first, and only then a wish: what is taken is then as new as can be.
        work_.wait(lock, [&] { return stopping_ || (!turns_.empty() && encoding_.size() < maxEncoding); });
        if (stopping_) break;
        auto wish = takeNext(lock);
        if (!wish) continue;
        lock.unlock();
        paintOne(painter, std::move(*wish));
        lock.lock();
    }
    rendering_ = false;
    encodeWork_.notify_all();
}

std::optional<Scheduler::Wish> Scheduler::takeNext(std::unique_lock<std::mutex>&) {
    const MailboxId turn = turns_.front();
    turns_.pop_front();
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
    running_ =
        Running{wish->mailbox, wish->order.interruptible, wish->deadline, std::stop_source(), false, false};
    deadlines_.notify_one();
    return wish;
}

// A request must not take the server down: what escapes the renderer, out of memory for one, fails one
// picture.
template <class Work>
static auto guarded(Work work) -> decltype(work()) {
    try {
        return work();
    } catch (const std::exception& e) {
        return fail(ErrorCode::Internal, std::string("The renderer failed: ") + e.what());
    }
}

Expected<Frame> Scheduler::paint(const Painter& painter, Wish& wish, const std::stop_token& token,
                                 bool& deferred) {
    if (!wish.prepared) {
        auto prepared = guarded([&] { return painter.prepare(wish.order, false, token); });
        if (!prepared) return tl::unexpected(std::move(prepared.error()));
        wish.prepared = std::move(*prepared);
    }
    if (wish.order.complete && !wish.prepared->complete) {
        deferred = true;
        return tl::unexpected(cancelled());
    }
    auto frame = guarded([&] { return painter.paint(wish.order, *wish.prepared, token); });
    wish.prepared.reset();  // encoding needs no samples
    return frame;
}

void Scheduler::paintOne(const std::optional<Painter>& painter, Wish wish) {
    std::stop_token token;
    {
        const std::lock_guard lock(mutex_);
        token = running_->stop.get_token();
    }
    const auto start = Clock::now();
    bool deferred = false;
    Expected<Frame> frame = painter ? paint(*painter, wish, token, deferred) : tl::unexpected(device().error);
    if (!frame) wish.prepared.reset();
    const double renderMs = millisecondsSince(start);
    Running how;
    {
        const std::lock_guard lock(mutex_);
        how = *std::exchange(running_, std::nullopt);
        if (deferred && !stopping_ && !how.stop.stop_requested()) {
            toPrepare_.push_back(std::move(wish));
            prepareWork_.notify_one();
            deadlines_.notify_one();
            return;
        }
        if (!frame && frame.error().code == ErrorCode::DeviceLost) {
            device_.state = DeviceStatus::State::Failed;
            device_.error = frame.error();
        }
        if (frame) {
            metrics_.frameRendered(wish.order.view.style.method, renderMs / 1000,
                                   frame->stats.samplesMissing == 0);
            encoding_.push_back({std::move(wish), std::move(*frame), renderMs});
            encodeWork_.notify_one();
            return;
        }
    }
    finishFailed(wish, std::move(frame.error()), how);
}

void Scheduler::finishFailed(Wish& wish, Error error, const Running& how) {
    if (how.late) return finish(wish, tl::unexpected(tooLate()), DropReason::Deadline);
    const bool wasCancelled = error.code == ErrorCode::Cancelled;
    finish(wish, tl::unexpected(std::move(error)),
           how.orphaned   ? DropReason::Gone
           : wasCancelled ? DropReason::Abandoned
                          : DropReason::Failed);
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
        preparing_ =
            Running{wish.mailbox, wish.order.interruptible, wish.deadline, std::stop_source(), false, false};
        deadlines_.notify_one();
        lock.unlock();
        prepareOne(std::move(wish));
        lock.lock();
    }
}

void Scheduler::prepareOne(Wish wish) {
    std::stop_token token;
    {
        const std::lock_guard lock(mutex_);
        token = preparing_->stop.get_token();
    }
    auto prepared = guarded([&] { return prepare_(wish.order, true, token); });
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
        for (const auto* busy : {&running_, &preparing_})
            if (*busy && !(*busy)->late) next = std::min(next, (*busy)->deadline);
        if (next == Clock::time_point::max()) {
            deadlines_.wait(lock);
            continue;
        }
        if (Clock::now() < next) {
            deadlines_.wait_until(lock, next);
            continue;
        }
        for (auto* busy : {&running_, &preparing_}) {
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
