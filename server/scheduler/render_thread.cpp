// The scheduler's render thread: opens the device, takes requests, begins pictures and finishes them, draws
// others within their pauses, and has another painter take over when the device is lost.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "renderer/image/clock.hpp"
#include "server/base/faults.hpp"
#include "server/scheduler/outcome.hpp"
#include "server/scheduler/picture_bytes.hpp"
#include "server/scheduler/scheduler.hpp"

namespace scancast {
namespace {

template <class T>
bool isLost(const Expected<T>& result) {
    return !result && result.error().code == ErrorCode::DeviceLost;
}

/// What it was prepared for is not there any more.
template <class T>
bool isUnavailable(const Expected<T>& result) {
    return !result && result.error().code == ErrorCode::Unavailable;
}

/// Of one picture; what is gone twice may be on its way back.
constexpr int mostTries = 3;

std::string_view name(Turns::Kind kind) {
    switch (kind) {
        case Turns::Kind::Moving:
            return "moving";
        case Turns::Kind::Still:
            return "still";
        case Turns::Kind::Snapshot:
            return "snapshot";
    }
    return "unknown";
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
    turns_.setPauses(painter_ && painter_->device.pauses);
    device_ = std::move(status);
}

void Scheduler::replacePainter(const Error& lost) {
    LostDevice device{painter_->device, lost};
    const OpenPainter instead = painter_->instead;
    lost_.reset();
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

std::chrono::milliseconds Scheduler::silence() const {
    const Clock::duration since = awaySince_;
    if (since == Clock::duration{}) return {};
    return std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now().time_since_epoch() - since);
}

// ---- one picture after the other

void Scheduler::renderLoop() {
    openDevice();
    while (contained("The render thread", [&] { return renderStep(); }).value_or(true)) {
    }
    if (begun_) completeOne(*std::exchange(begun_, std::nullopt));
    painter_.reset();
    awaySince_ = Clock::duration{};
    const Monitor::Lock lock(monitor_);
    rendering_ = false;
}

bool Scheduler::renderStep() {
    {
        Monitor::Lock lock(monitor_);
        awaySince_ = Clock::duration{};
        busy_.end(Clock::now());
        monitor_.wait(lock, [this] { return renderIsDue(); });
        busy_.begin(Clock::now());
        comeBack();
        if (turns_.stopping()) return false;
    }
    // What is finished waits for nobody else's picture to be begun.
    const auto finished = contained("The renderer", [&] { return begun_ && begun_->frame->ready(); });
    if (begun_ && finished.value_or(true))
        completeOne(*std::exchange(begun_, std::nullopt));
    else
        beginNext();
    return true;
}

/// What `take` says, and how long it has waited for its first turn.
template <class Take>
std::optional<Scheduler::Taken> Scheduler::nextTurn(const Take& take) {
    std::optional<Taken> request;
    std::optional<Clock::duration> waited;
    Turns::Kind kind{};
    {
        const Monitor::Lock lock(monitor_);
        const auto now = Clock::now();
        request = take(now);
        if (request && (*request)->turns == 1) waited = now - (*request)->asked;
        if (request) kind = (*request)->kind;
    }
    if (waited) {
        std::ignore = contained("Counting", [&] {
            metrics_.pictureWaited(name(kind), std::chrono::duration<double>(*waited).count());
        });
    }
    return request;
}

/// Begins the next picture, if one is asked for, and only then waits for the pixels of the one before.
void Scheduler::beginNext() {
    const std::optional<Taken> request = nextTurn([this](Clock::time_point now) { return turns_.take(now); });
    std::optional<Begun> next;
    if (request) {
        // A still or a snapshot may take long to begin, and a moving frame's pixels do not wait for that.
        if ((*request)->order.complete && begun_) completeOne(*std::exchange(begun_, std::nullopt));
        next = beginOne(*request);
    }
    if (next) {
        const Monitor::Lock lock(monitor_);
        turns_.letGo(next->request, Clock::now());
    }
    if (begun_) completeOne(*std::exchange(begun_, std::nullopt));
    begun_ = std::move(next);
}

/// In a pause of the picture that is being drawn: others, each to its end, as long as it is their turn.
void Scheduler::drawWithin() {
    comeBack();
    const auto start = Clock::now();
    while (!lost_) {
        const std::optional<Taken> request =
            nextTurn([this](Clock::time_point now) { return turns_.takeWithin(now); });
        if (!request) break;
        ++within_;
        if (auto begun = beginOne(*request)) completeOne(std::move(*begun));
        --within_;
    }
    paused_ += Clock::now() - start;
}

std::optional<Scheduler::Begun> Scheduler::beginOne(Taken request) {
    auto begun = contained("The render thread", [&] { return tryBegin(request); });
    if (begun) return std::move(*begun);
    endFaulty(request, std::move(begun.error()));
    return std::nullopt;
}

std::optional<Scheduler::Begun> Scheduler::tryBegin(Taken request) {
    const std::stop_token token = tokenOf(request);
    const auto pausedAround = std::exchange(paused_, {});
    const auto start = Clock::now();
    Why why = Why::Failed;
    auto frame = contained("The renderer", [&] { return begin(*request, token, why); });
    const double renderMs = millisecondsSince(start + paused_);
    paused_ = pausedAround;
    request->prepared.reset();  // what is begun needs no samples any more
    if (frame) return Begun{request, std::move(*frame), painter_->device, painterNumber_, renderMs};
    endWithout(request, std::move(frame.error()), why);
    return std::nullopt;
}

Expected<void> Scheduler::checkMemory(const PictureOrder& order) const {
    const View& view = order.view;
    if (std::int64_t{view.width} * view.height <= smallPicturePixels) return {};
    return checkRoom(view, bytesToDraw(order), options_.room());
}

Expected<std::unique_ptr<PendingFrame>> Scheduler::begin(Turns::Request& request,
                                                         const std::stop_token& token, Why& why) {
    if (lost_ && within_ == 0) replacePainter(Error(*lost_));
    int triesLeft = mostTries;
    while (painter_) {
        if (!request.prepared) {
            auto prepared =
                contained("The renderer", [&] { return painter_->prepare(request.order, false, token); });
            if (!prepared) return passOn(std::move(prepared));
            request.prepared = std::move(*prepared);
            request.order.planned = request.prepared->planned;
        }
        if (!request.prepared->complete) {
            why = request.order.complete ? Why::LacksBlocks : request.order.onlyWhole ? Why::Lacks : why;
            if (why != Why::Failed) return tl::unexpected(cancelled());
        }
        if (auto ok = checkMemory(request.order); !ok) return passOn(ok);
        auto frame = contained("The renderer", [&] {
            return painter_->begin(request.order, *request.prepared, token, [this] { drawWithin(); });
        });
        if (isUnavailable(frame) && --triesLeft > 0) {
            request.prepared.reset();
            continue;
        }
        if (!isLost(frame)) return frame;
        if (within_ > 0) {
            lost_ = frame.error();
            why = Why::DeviceLost;
            return frame;
        }
        replacePainter(frame.error());
    }
    return tl::unexpected(device().error);
}

void Scheduler::completeOne(Begun begun) {
    if (within_ == 0) {  // else it never left the device
        const Monitor::Lock lock(monitor_);
        turns_.resume(begun.request, Clock::now());
    }
    auto completed = contained("The render thread", [&] { complete(begun); });
    if (!completed) endFaulty(begun.request, std::move(completed.error()));
}

void Scheduler::complete(Begun& begun) {
    const std::stop_token token = tokenOf(begun.request);
    const auto start = Clock::now();
    Why why = Why::Failed;
    auto frame = finish(begun, token, why);
    begun.request->prepared.reset();
    if (!frame) return endWithout(begun.request, std::move(frame.error()), why);
    DrawnPicture drawn{std::move(*frame), std::move(begun.device), begun.renderMs + millisecondsSince(start)};
    const PictureOrder& order = begun.request->order;
    drawn.held = options_.memory.hold(MemoryUse::Frames, bytesToDraw(order));
    metrics_.frameRendered(begun.request->order.view.style.method, drawn.renderMs / 1000,
                           drawn.frame.stats.samplesMissing == 0);
    metrics_.setDeviceMemory(drawn.frame.stats.deviceBytes);
    const Monitor::Lock lock(monitor_);
    begun.request->drawn = std::move(drawn);
    turns_.drawn(begun.request, Clock::now());
}

/// What was lost with its device is begun again with the painter that took over, and what cannot be had of it, from anew.
Expected<Frame> Scheduler::finish(Begun& begun, const std::stop_token& token, Why& why) {
    for (int triesLeft = mostTries;;) {
        auto frame = contained("The renderer", [&] { return begun.frame->finish(); });
        begun.frame.reset();
        const bool isAgain = isUnavailable(frame) && --triesLeft > 0;
        if (!isLost(frame) && !isAgain) return frame;
        if (isLost(frame) && within_ > 0) {
            lost_ = frame.error();
            why = Why::DeviceLost;
            return frame;
        }
        if (isLost(frame) && begun.painter == painterNumber_) replacePainter(frame.error());
        if (isAgain) begun.request->prepared.reset();
        auto again = begin(*begun.request, token, why);
        if (!again) return passOn(std::move(again));
        begun.frame = std::move(*again);
        begun.device = painter_->device;
        begun.painter = painterNumber_;
    }
}

/// It ends without a picture, for now or for good.
void Scheduler::endWithout(Taken request, Error error, Why why) {
    change([&](Requests& ended) {
        const auto now = Clock::now();
        switch (why) {
            case Why::LacksBlocks:
                return turns_.lacksBlocks(request, now, ended);
            case Why::Lacks:
                return turns_.lacks(request, now, ended);
            case Why::DeviceLost:
                return turns_.putBack(request, now, ended);
            case Why::Failed:
                return turns_.failed(request, std::move(error), now, ended);
        }
    });
}

}  // namespace scancast
