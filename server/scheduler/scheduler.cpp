#include "server/scheduler/scheduler.hpp"

#include <utility>

#include "server/scheduler/outcome.hpp"

namespace scancast {
Scheduler::Scheduler(OpenPainter openPainter, const SchedulerOptions& options, Metrics& metrics)
    : openPainter_(std::move(openPainter)), options_(options), metrics_(metrics), turns_(options) {
    renderThread_ = std::thread([this] { renderLoop(); });
    prepareThread_ = std::thread([this] { prepareLoop(); });
    frameThread_ = std::thread([this] { encodeLoop(Line::Frames); });
    pictureThread_ = std::thread([this] { encodeLoop(Line::Pictures); });
    deadlineThread_ = std::thread([this] { deadlineLoop(); });
}

Scheduler::~Scheduler() {
    stop();
    wait();
}

void Scheduler::wait() {
    for (std::thread* thread :
         {&renderThread_, &prepareThread_, &frameThread_, &pictureThread_, &deadlineThread_}) {
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
                       [this] { return device_.state != DeviceStatus::State::Opening || turns_.stopping(); });
    return device_;
}

// ---- who asks

Scheduler::MailboxId Scheduler::openMailbox() {
    const Monitor::Lock lock(monitor_);
    return turns_.openMailbox();
}

// Called by destructors: nothing here needs memory.
void Scheduler::closeMailbox(MailboxId mailbox) {
    change([&](Requests& ended) { turns_.closeMailbox(mailbox, ended); });
}

void Scheduler::request(MailboxId mailbox, PictureOrder order, PictureDone done) {
    PicturePromise promise(std::move(done));
    const auto placed = contained("The scheduler", [&] {
        Requests one;
        one.emplace_back(std::move(order), std::move(promise));
        change([&](Requests& ended) { turns_.place(mailbox, one, Clock::now(), ended); });
    });
    if (!placed) promise.keep(tl::unexpected(placed.error()));
}

bool Scheduler::replaceWaiting(MailboxId mailbox, PictureOrder order, PictureDone done) {
    Requests one;
    one.emplace_back(std::move(order), PicturePromise(std::move(done)));
    bool replaced = false;
    change([&](Requests& ended) { replaced = turns_.replaceWaiting(mailbox, one, Clock::now(), ended); });
    if (!replaced) one.front().promise.release();
    return replaced;
}

void Scheduler::abandon(MailboxId mailbox) {
    change([&](Requests& ended) { turns_.abandon(mailbox, ended); });
}

Expected<Scheduler::SnapshotId> Scheduler::snapshot(PictureOrder order, PictureDone done) {
    Requests one;
    const auto queued = contained("The queue of pictures", [&]() -> Expected<SnapshotId> {
        one.emplace_back(std::move(order), PicturePromise(std::move(done)));
        const Monitor::Lock lock(monitor_);
        return turns_.snapshot(one, Clock::now());
    });
    if (!one.empty()) one.front().promise.release();
    return queued;
}

void Scheduler::abandonSnapshot(SnapshotId snapshot) {
    change([&](Requests& ended) { turns_.abandonSnapshot(snapshot, ended); });
}

void Scheduler::drain() {
    const Monitor::Lock lock(monitor_);
    turns_.drain();
}

bool Scheduler::draining() const {
    const Monitor::Look look(monitor_);
    return turns_.draining();
}

bool Scheduler::idle() const {
    const Monitor::Look look(monitor_);
    return turns_.idle();
}

void Scheduler::stop() {
    change([&](Requests& ended) { turns_.stop(ended); });
}

// ---- how pictures end; without the lock, because `done` is somebody else's code

void Scheduler::answer(Requests ended) noexcept {
    for (Turns::Request& request : ended)
        std::ignore = contained("The scheduler", [&] {
            answer(request, tl::unexpected(errorOf(request)), dropReason(request.end));
        });
}

QueueLengths Scheduler::queues() const {
    const Monitor::Look look(monitor_);
    return turns_.lengths();
}

void Scheduler::answer(Turns::Request& request, Expected<EncodedPicture> result,
                       std::optional<DropReason> dropped) noexcept {
    std::ignore = contained("Counting", [&] {
        if (dropped) metrics_.frameDropped(*dropped);
        if (request.kind == Turns::Kind::Snapshot && request.order.price > 0)
            metrics_.priceEnded(result ? std::nullopt : std::optional(dropped.value_or(DropReason::Gone)),
                                request.order.price / 1000);
    });
    request.promise.keep(std::move(result));
}

// Of an exception that came out of the work on it.
void Scheduler::endFaulty(Taken request, Error fault) {
    change([&](Requests& ended) { turns_.failed(request, std::move(fault), Clock::now(), ended); });
}

std::stop_token Scheduler::tokenOf(Taken request) const {
    const Monitor::Look look(monitor_);
    return request->stop.get_token();
}

}  // namespace scancast
