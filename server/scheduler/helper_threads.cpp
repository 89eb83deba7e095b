// The scheduler's threads beside the render thread: one waits for blocks, one encodes, one keeps deadlines.
#include <algorithm>
#include <utility>

#include "renderer/image/clock.hpp"
#include "server/base/faults.hpp"
#include "server/scheduler/outcome.hpp"
#include "server/scheduler/scheduler.hpp"

namespace scancast {

// ---- prepare thread

void Scheduler::prepareLoop() {
    while (contained("The prepare thread", [&] { return prepareStep(); }).value_or(true)) {
    }
}

bool Scheduler::prepareStep() {
    Requests one;  // ends, if it must, without the lock
    {
        Monitor::Lock lock(monitor_);
        monitor_.wait(lock, [this] { return prepareIsDue(); });
        if (stopping_) return false;
        one.splice(one.end(), toPrepare_, toPrepare_.begin());
        preparing_ = runningOf(one.front());
    }
    auto done = contained("The prepare thread", [&] { prepareOne(one); });
    if (!done) endFaulty(preparing_, one.front(), std::move(done.error()));
    return true;
}

/// One request, which stays in the list unless it takes another turn.
void Scheduler::prepareOne(Requests& one) {
    Request& request = one.front();
    std::stop_token token;
    PreparePicture prepare;
    {
        const Monitor::Look look(monitor_);
        token = preparing_->stop.get_token();
        prepare = prepare_;
    }
    auto prepared = contained("The renderer", [&] { return prepare(request.order, true, token); });
    Running how;
    {
        const Monitor::Lock lock(monitor_);
        if (prepared && !stopping_ && !preparing_->stop.stop_requested()) {
            standInLine(preparedOne);
            preparing_.reset();
            request.prepared = std::move(*prepared);
            request.prepared->complete = true;  // damaged blocks have their stand-ins: nothing more will come
            prepared_.splice(prepared_.end(), one);
            return;
        }
        how = *std::exchange(preparing_, std::nullopt);
    }
    finishFailed(request, prepared ? cancelled() : std::move(prepared.error()), how);
}

// ---- encode thread

void Scheduler::encodeLoop() {
    while (contained("The encode thread", [&] { return encodeStep(); }).value_or(true)) {
    }
}

bool Scheduler::encodeStep() {
    Rendered job;
    {
        Monitor::Lock lock(monitor_);
        monitor_.wait(lock, [this] { return encodeIsDue(); });
        if (encoding_.empty()) return false;
        job = std::move(encoding_.front());  // its place stays taken, so that the bound counts it, too
    }
    auto picture = contained("The encoder", [&] { return encoded(job); });
    std::optional<DropReason> dropped;
    if (!picture) {
        const bool late = picture.error().code == ErrorCode::DeadlineExceeded;
        dropped = late ? DropReason::Deadline : DropReason::Failed;
    }
    finish(job.request, std::move(picture), dropped);
    job = {};
    const Monitor::Lock lock(monitor_);
    encoding_.pop_front();
    return true;
}

Expected<EncodedPicture> Scheduler::encoded(Rendered& job) {
    const auto start = Clock::now();
    auto bytes = encodePicture(job.frame, job.request.order.view, job.request.order.format);
    const double encodeMs = millisecondsSince(start);
    if (!bytes) return passOn(std::move(bytes));
    if (Clock::now() > job.request.deadline) return tl::unexpected(tooLate());
    metrics_.frameEncoded(encodeMs / 1000, bytes->size());
    EncodedPicture picture;
    picture.bytes = std::make_shared<const Bytes>(std::move(*bytes));
    picture.width = job.frame.width;
    picture.height = job.frame.height;
    picture.stats = std::move(job.frame.stats);
    picture.stats.add("encode", encodeMs);
    picture.renderMs = job.renderMs;
    picture.encodeMs = encodeMs;
    picture.rivals = job.request.rivals;
    picture.device = std::move(job.device);
    return picture;
}

// ---- deadline thread

void Scheduler::deadlineLoop() {
    while (contained("The deadline thread", [&] { return deadlineStep(); }).value_or(true)) {
    }
}

Scheduler::Clock::time_point Scheduler::firstDeadline() const {
    auto first = Clock::time_point::max();
    if (!snapshots_.empty()) first = snapshots_.front().deadline;  // all have the same patience: sorted
    for (const Requests* waiting : {&toPrepare_, &prepared_})
        for (const Request& request : *waiting) first = std::min(first, request.deadline);
    for (const auto* busy : allBusy())
        if (*busy && !(*busy)->late) first = std::min(first, (*busy)->deadline);
    return first;
}

bool Scheduler::deadlineStep() {
    std::optional<Request> late;
    {
        Monitor::Lock lock(monitor_);
        const auto first = firstDeadline();
        monitor_.waitUntil(lock, first, [&] { return stopping_ || firstDeadline() < first; });
        if (stopping_) return false;
        late = takeLate(Clock::now());
    }
    if (late) drop(*late, tooLate, DropReason::Deadline);
    return true;
}

// Stops what is late and under way, and returns one that is late and waits. Called with the lock held.
std::optional<Scheduler::Request> Scheduler::takeLate(Clock::time_point now) {
    for (auto* busy : allBusy()) {
        if (!*busy || (*busy)->late || (*busy)->deadline > now) continue;
        (*busy)->late = true;
        (*busy)->stop.request_stop();
    }
    for (Requests* waiting : {&snapshots_, &toPrepare_, &prepared_}) {
        const auto at = std::find_if(waiting->begin(), waiting->end(),
                                     [&](const Request& request) { return request.deadline <= now; });
        if (at == waiting->end()) continue;
        std::optional<Request> late = std::move(*at);
        waiting->erase(at);
        if (snapshots_.empty()) std::erase(turns_, snapshots);
        if (prepared_.empty()) std::erase(turns_, preparedOne);
        return late;
    }
    return std::nullopt;
}

}  // namespace scancast
