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
    encodeThread_ = std::thread([this] { encodeLoop(); });
    deadlineThread_ = std::thread([this] { deadlineLoop(); });
}

Scheduler::~Scheduler() {
    stop();
    wait();
}

void Scheduler::wait() {
    for (std::thread* thread : {&renderThread_, &encodeThread_, &deadlineThread_}) {
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
    std::optional<Wish> dropped;
    {
        const std::lock_guard lock(mutex_);
        const auto at = mailboxes_.find(mailbox);
        if (at == mailboxes_.end()) return;
        dropped = std::exchange(at->second, std::nullopt);
        mailboxes_.erase(at);
        std::erase(turns_, mailbox);
        if (running_ && running_->mailbox == mailbox) running_->orphaned = true;
        stopRunning(mailbox, true);
    }
    if (dropped) finish(*dropped, tl::unexpected(cancelled()), DropReason::Gone);
}

void Scheduler::wish(MailboxId mailbox, PictureOrder order, PictureDone done) {
    Wish wish{std::move(order), std::move(done), Clock::time_point::max(), mailbox};
    std::optional<Wish> overwritten;
    bool refused = false;
    {
        const std::lock_guard lock(mutex_);
        const auto at = mailboxes_.find(mailbox);
        refused = stopping_ || at == mailboxes_.end();
        if (!refused) {
            overwritten = std::exchange(at->second, std::move(wish));
            if (!overwritten) turns_.push_back(mailbox);
            stopRunning(mailbox, false);
        }
    }
    work_.notify_one();
    if (refused) finish(wish, tl::unexpected(cancelled()), std::nullopt);
    if (overwritten) finish(*overwritten, tl::unexpected(cancelled()), DropReason::Overwritten);
}

bool Scheduler::replaceWaiting(MailboxId mailbox, PictureOrder order, PictureDone done) {
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
    std::optional<Wish> dropped;
    {
        const std::lock_guard lock(mutex_);
        const auto at = mailboxes_.find(mailbox);
        if (at == mailboxes_.end()) return;
        dropped = std::exchange(at->second, std::nullopt);
        if (dropped) std::erase(turns_, mailbox);
        stopRunning(mailbox, false);
    }
    if (dropped) finish(*dropped, tl::unexpected(cancelled()), DropReason::Abandoned);
}

Expected<void> Scheduler::snapshot(PictureOrder order, PictureDone done) {
    {
        const std::lock_guard lock(mutex_);
        if (stopping_) return fail(ErrorCode::ResourceLimit, "The server is shutting down.");
        if (snapshots_.size() >= options_.maxSnapshots) {
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
        turns_.clear();
        if (running_) running_->stop.request_stop();
    }
    work_.notify_all();
    encodeWork_.notify_all();
    deadlines_.notify_all();
    opened_.notify_all();
    for (Wish& wish : dropped) finish(wish, tl::unexpected(cancelled()), DropReason::Gone);
}

// Called with the lock held.
void Scheduler::stopRunning(MailboxId mailbox, bool alsoMoving) {
    if (running_ && running_->mailbox == mailbox && (alsoMoving || running_->interruptible)) {
        running_->stop.request_stop();
    }
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
    if (turn == snapshots) {
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
    running_ = Running{turn, wish->order.interruptible, wish->deadline, std::stop_source(), false, false};
    deadlines_.notify_one();
    return wish;
}

void Scheduler::paintOne(const std::optional<Painter>& painter, Wish wish) {
    std::stop_token token;
    {
        const std::lock_guard lock(mutex_);
        token = running_->stop.get_token();
    }
    const auto start = Clock::now();
    Expected<Frame> frame = tl::unexpected(cancelled());
    if (!painter) {
        frame = tl::unexpected(device().error);
    } else {
        // A request must not take the server down: what escapes the renderer, out of memory for one, fails
        // one picture.
        try {
            frame = painter->paint(*wish.order.cloud, wish.order.view, token);
        } catch (const std::exception& e) {
            frame = fail(ErrorCode::Internal, std::string("The renderer failed: ") + e.what());
        }
    }
    const double renderMs = millisecondsSince(start);
    bool late = false;
    bool orphaned = false;
    {
        const std::lock_guard lock(mutex_);
        late = running_->late;
        orphaned = running_->orphaned;
        running_.reset();
        if (!frame && frame.error().code == ErrorCode::DeviceLost) {
            device_.state = DeviceStatus::State::Failed;
            device_.error = frame.error();
        }
        if (frame) {
            metrics_.frameRendered(wish.order.view.style.method, renderMs / 1000);
            encoding_.push_back({std::move(wish), std::move(*frame), renderMs});
            encodeWork_.notify_one();
            return;
        }
    }
    if (late) {
        finish(wish, tl::unexpected(tooLate()), DropReason::Deadline);
    } else {
        const bool wasCancelled = frame.error().code == ErrorCode::Cancelled;
        finish(wish, tl::unexpected(std::move(frame.error())),
               orphaned       ? DropReason::Gone
               : wasCancelled ? DropReason::Abandoned
                              : DropReason::Failed);
    }
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
        if (running_ && !running_->late) next = std::min(next, running_->deadline);
        if (next == Clock::time_point::max()) {
            deadlines_.wait(lock);
            continue;
        }
        if (Clock::now() < next) {
            deadlines_.wait_until(lock, next);
            continue;
        }
        if (running_ && running_->deadline <= next) {
            running_->late = true;
            running_->stop.request_stop();
        }
        if (!snapshots_.empty() && snapshots_.front().deadline <= next) {
            Wish wish = std::move(snapshots_.front());
            snapshots_.pop_front();
            if (snapshots_.empty()) std::erase(turns_, snapshots);
            lock.unlock();
            finish(wish, tl::unexpected(tooLate()), DropReason::Deadline);
            lock.lock();
        }
    }
}

}  // namespace scancast
