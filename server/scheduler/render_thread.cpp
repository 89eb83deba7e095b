// The scheduler's render thread: opens the device, takes requests, begins pictures and finishes them, and has
// another painter take over when the device is lost.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "renderer/image/clock.hpp"
#include "server/base/faults.hpp"
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
    auto opened = contained("Opening the device", [this] { usePainter(openPainter_(), std::nullopt); });
    if (opened) return;
    const Monitor::Lock lock(monitor_);
    device_.state = DeviceStatus::State::Failed;
    device_.error = std::move(opened.error());
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
    std::ignore = contained("Counting", [&] { metrics_.setDevice(status.info.name, status.info.renderer); });
    const Monitor::Lock lock(monitor_);
    if (painter_) prepare_ = painter_->prepare;
    device_ = std::move(status);
}

void Scheduler::replacePainter(const Error& lost) {
    LostDevice device{painter_->device, lost};
    const OpenPainter instead = painter_->instead;
    painter_.reset();  // a device is closed on the thread that opened it, and before another takes its place
    ++painterNumber_;
    metrics_.deviceLost();
    spdlog::error("The device {} was lost: {}", title(device.info), lost.message);
    auto opened =
        instead ? contained("Opening another device", instead) : Expected<Painter>(tl::unexpected(lost));
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

bool Scheduler::renderIsDue() const {
    // Room for the result first, and only then a request: what is taken is then as new as can be.
    return stopping_ || (encoding_.size() < maxEncoding && (begun_ || !turns_.empty()));
}

void Scheduler::renderLoop() {
    openDevice();
    std::optional<Begun> begun;  // its pixels may still be on their way
    while (contained("The render thread", [&] { return renderStep(begun); }).value_or(true)) {
    }
    if (begun) completeOne(std::move(*begun));
    painter_.reset();
    const Monitor::Lock lock(monitor_);
    rendering_ = false;
}

bool Scheduler::renderStep(std::optional<Begun>& begun) {
    {
        Monitor::Lock lock(monitor_);
        monitor_.wait(lock, [this] { return renderIsDue(); });
        if (stopping_) return false;
    }
    // What is finished waits for nobody else's picture to be begun.
    const auto finished = contained("The renderer", [&] { return begun && begun->frame->ready(); });
    if (begun && finished.value_or(true))
        completeOne(*std::exchange(begun, std::nullopt));
    else
        beginNext(begun);
    return true;
}

/// Begins the next picture, if one is asked for, and only then waits for the pixels of the one before.
void Scheduler::beginNext(std::optional<Begun>& begun) {
    std::optional<Request> request;  // ends, if it must, without the lock
    {
        const Monitor::Lock lock(monitor_);
        takeNext(request);
    }
    // A still or a snapshot may take long to begin, and a moving frame's pixels do not wait for that.
    if (request && request->order.complete && begun) completeOne(*std::exchange(begun, std::nullopt));
    std::optional<Begun> next;
    if (request) next = beginOne(std::move(*request));
    if (begun) completeOne(*std::exchange(begun, std::nullopt));
    begun = std::move(next);
    if (!begun) return;
    const Monitor::Lock lock(monitor_);
    begun_ = std::exchange(running_, std::nullopt);
}

// What waits for that turn, or nullptr. Called with the lock held.
const Scheduler::Request* Scheduler::waiting(MailboxId turn) const {
    if (turn == preparedOne) return prepared_.empty() ? nullptr : &prepared_.front();
    if (turn == snapshots) return snapshots_.empty() ? nullptr : &snapshots_.front();
    const auto at = mailboxes_.find(turn);
    return at == mailboxes_.end() || !at->second ? nullptr : &*at->second;
}

// The first in line, but for stills that give way to somebody behind them; goes to the end of the line where
// more waits for it. Called with the lock held.
Scheduler::MailboxId Scheduler::takeTurn() {
    const auto now = Clock::now();
    const auto takesIt = [&](MailboxId turn) {
        const Request* request = waiting(turn);
        return request && now >= request->givesWayUntil;
    };
    auto at = std::find_if(turns_.begin(), turns_.end(), takesIt);
    if (at == turns_.end()) at = turns_.begin();
    const MailboxId turn = *at;
    std::rotate(at, at + 1, turns_.end());
    if (turn != snapshots || snapshots_.size() <= 1) turns_.pop_back();
    return turn;
}

// Into `request`, if there is any. Called with the lock held.
void Scheduler::takeNext(std::optional<Request>& request) {
    if (turns_.empty()) return;
    const MailboxId turn = takeTurn();
    if (!waiting(turn)) return;
    if (turn == preparedOne || turn == snapshots) {
        Requests& line = turn == snapshots ? snapshots_ : prepared_;
        request = std::move(line.front());
        line.pop_front();
    } else {
        request = std::exchange(mailboxes_.at(turn), std::nullopt);
    }
    request->rivals = movingRequests();
    running_ = runningOf(*request);
}

// Called with the lock held.
std::size_t Scheduler::movingRequests() const {
    return std::size_t(std::count_if(mailboxes_.begin(), mailboxes_.end(), [](const auto& mailbox) {
        return mailbox.second && !mailbox.second->order.complete;
    }));
}

std::optional<Scheduler::Begun> Scheduler::beginOne(Request request) {
    auto begun = contained("The render thread", [&] { return tryBegin(request); });
    if (begun) return std::move(*begun);
    endFaulty(running_, request, std::move(begun.error()));
    return std::nullopt;
}

std::optional<Scheduler::Begun> Scheduler::tryBegin(Request& request) {
    std::stop_token token;
    {
        const Monitor::Look look(monitor_);
        token = running_->stop.get_token();
    }
    const auto start = Clock::now();
    bool deferred = false;
    auto frame = begin(request, token, deferred);
    request.prepared.reset();  // what is begun needs no samples any more
    if (!frame) {
        endWithout(running_, request, std::move(frame.error()), deferred);
        return std::nullopt;
    }
    DeviceInfo device = painter_->device;
    return Begun{std::move(request), std::move(*frame), std::move(device), painterNumber_,
                 millisecondsSince(start)};
}

Expected<void> Scheduler::checkMemory(const View& view) const {
    if (std::int64_t{view.width} * view.height <= smallPicturePixels) return {};
    return checkRoom(view, options_.room());
}

/// `deferred`: the picture lacks blocks that it must not lack.
Expected<std::unique_ptr<PendingFrame>> Scheduler::begin(Request& request, const std::stop_token& token,
                                                         bool& deferred) {
    while (painter_) {
        if (!request.prepared) {
            auto prepared =
                contained("The renderer", [&] { return painter_->prepare(request.order, false, token); });
            if (!prepared) return passOn(std::move(prepared));
            request.prepared = std::move(*prepared);
            request.order.planned = request.prepared->planned;
        }
        deferred = request.order.complete && !request.prepared->complete;
        if (deferred) return tl::unexpected(cancelled());
        request.lacking = request.order.onlyWhole && !request.prepared->complete;
        if (request.lacking)
            return fail(ErrorCode::Cancelled, "Samples of this picture are still to be read.");
        if (auto ok = checkMemory(request.order.view); !ok) return passOn(ok);
        auto frame = contained("The renderer",
                               [&] { return painter_->begin(request.order, *request.prepared, token); });
        if (!isLost(frame)) return frame;
        replacePainter(frame.error());
    }
    return tl::unexpected(device().error);
}

void Scheduler::completeOne(Begun begun) {
    auto completed = contained("The render thread", [&] { complete(begun); });
    if (!completed) endFaulty(begun_, begun.request, std::move(completed.error()));
}

void Scheduler::complete(Begun& begun) {
    std::stop_token token;
    {
        const Monitor::Look look(monitor_);
        token = begun_->stop.get_token();
    }
    const auto start = Clock::now();
    bool deferred = false;
    auto frame = finish(begun, token, deferred);
    begun.request.prepared.reset();
    if (!frame) return endWithout(begun_, begun.request, std::move(frame.error()), deferred);
    const double renderMs = begun.renderMs + millisecondsSince(start);
    metrics_.frameRendered(begun.request.order.view.style.method, renderMs / 1000,
                           frame->stats.samplesMissing == 0);
    metrics_.setDeviceMemory(frame->stats.deviceBytes);
    const Monitor::Lock lock(monitor_);
    encoding_.emplace_back();  // may fail for want of memory; what follows does not
    encoding_.back() = {std::move(begun.request), std::move(*frame), std::move(begun.device), renderMs};
    begun_.reset();
}

/// What was lost with its device is begun again with the painter that took over.
Expected<Frame> Scheduler::finish(Begun& begun, const std::stop_token& token, bool& deferred) {
    while (true) {
        auto frame = contained("The renderer", [&] { return begun.frame->finish(); });
        begun.frame.reset();
        if (!isLost(frame)) return frame;
        if (begun.painter == painterNumber_) replacePainter(frame.error());
        auto again = begin(begun.request, token, deferred);
        if (!again) return passOn(std::move(again));
        begun.frame = std::move(*again);
        begun.device = painter_->device;
        begun.painter = painterNumber_;
    }
}

/// The picture in `slot` ends without one: it waits for blocks, gave way to another, or failed.
void Scheduler::endWithout(std::optional<Running>& slot, Request& request, Error error, bool deferred) {
    Running how;
    {
        const Monitor::Lock lock(monitor_);
        how = *std::exchange(slot, std::nullopt);
        if (waitsOn(how, request, deferred)) return;
    }
    finishFailed(request, std::move(error), how);
}

// Called with the lock held.
bool Scheduler::waitsOn(const Running& how, Request& request, bool deferred) {
    if (!deferred || stopping_ || how.stop.stop_requested())
        return how.gaveWay && !how.orphaned && putBack(request);
    toPrepare_.emplace_back();  // may fail for want of memory; what follows does not
    toPrepare_.back() = std::move(request);
    return true;
}

}  // namespace scancast
