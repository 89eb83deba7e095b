#include "tests/simulation/simulated_server.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "server/scheduler/outcome.hpp"

namespace scancast::simulation {
namespace {

constexpr double sliceMs = 10, pollMs = 4, reopenMs = 300;

/// As many bytes as a picture of this size may have: shared, because nobody looks at them.
std::shared_ptr<const Bytes> someBytes(double pixels) {
    static std::map<std::size_t, std::shared_ptr<const Bytes>> known;
    const auto size = (std::size_t(pixels * 0.15) / 4096 + 1) * 4096;
    auto& bytes = known[size];
    if (!bytes) bytes = std::make_shared<const Bytes>(size);
    return bytes;
}

double pixelsOf(const PictureOrder& order) {
    return double(order.view.width) * order.view.height;
}

/// Clients give each of their views a place of its own to look from.
double viewOf(const PictureOrder& order) {
    return order.view.camera.eye.x;
}

double memoryOf(const Machine& machine) {
    return machine.frameMemoryMB * 1e6;
}

TurnsOptions options(const Machine& machine) {
    TurnsOptions options;
    options.maxFrameBytes = std::uint64_t(memoryOf(machine));
    options.maxSnapshots = 16;
    options.cores = 2;
    return options;
}

}  // namespace

Machine someMachine(Chance& chance) {
    Machine machine;
    machine.pauses = chance.happens(0.7);
    machine.pixelsComeLate = !machine.pauses && chance.happens(0.7);
    machine.perMegapixel = machine.pauses ? chance.scale(5, 80) : chance.scale(0.5, 10);
    machine.encodeShare = chance.between(0.1, 0.5);
    machine.coldViews = chance.happens(0.5) ? chance.unit() : 0;
    machine.loadMs = chance.scale(2, 300);
    if (chance.happens(0.3)) {
        machine.stallsPerMinute = chance.between(2, 20);
        machine.stallMs = chance.scale(100, 8000);
    }
    if (chance.happens(0.3)) machine.lossesPerMinute = chance.between(1, 12);
    machine.badGuess = chance.between(1, 4);
    if (chance.happens(0.3)) machine.frameMemoryMB = chance.scale(1, 200);
    return machine;
}

SimulatedServer::SimulatedServer(VirtualTime& time, Chance& chance, const Machine& machine)
    : time_(time), chance_(chance), machine_(machine), turns_(options(machine)) {
    turns_.setPauses(machine.pauses);
    mayStall();
    mayLoseDevice();
}

void SimulatedServer::violate(const std::string& what) {
    if (!violation_)
        violation_ = fmt::format("at {:.3f} s: {}",
                                 inMilliseconds(time_.now() - Time(std::chrono::hours(1))) / 1000, what);
}

// ---- who asks

SimulatedServer::Requests SimulatedServer::newRequest(PictureOrder order, PictureDone done) {
    order.price = drawMs(order) * chance_.scale(1 / machine_.badGuess, machine_.badGuess);
    const auto wrapped = [this, done = std::move(done),
                          before = std::make_shared<int>(0)](Expected<EncodedPicture> result) {
        ++answered_;
        if (++*before != 1) violate("an order was answered twice");
        if (!result && result.error().code == ErrorCode::Internal) violate("an order was lost");
        done(std::move(result));
    };
    Requests one;
    one.emplace_back(std::move(order), PicturePromise(wrapped));
    return one;
}

template <class Change>
void SimulatedServer::change(const Change& change) {
    Requests ended;
    change(ended);
    answer(ended);
    settle();
}

// Who is told only takes note, and acts in an event of its own.
void SimulatedServer::answer(Requests& ended) {
    for (Turns::Request& request : ended)
        if (request.end != Turns::End::Done) request.promise.keep(tl::unexpected(errorOf(request)));
}

Turns::ParticipantId SimulatedServer::openMailbox() {
    mostParticipants_ = std::max(mostParticipants_, newest_.size() + 8);
    const auto mailbox = turns_.openMailbox();
    newest_[mailbox] = 0;
    return mailbox;
}

void SimulatedServer::closeMailbox(Turns::ParticipantId mailbox) {
    newest_.erase(mailbox);
    waitsSince_.erase(mailbox);
    change([&](Requests& ended) { turns_.closeMailbox(mailbox, ended); });
}

void SimulatedServer::asked(Turns::ParticipantId mailbox, const PictureOrder& order) {
    if (viewOf(order) < newest_[mailbox]) violate("the simulation asks for an older view");
    newest_[mailbox] = viewOf(order);
    if (order.interruptible)
        waitsSince_.erase(mailbox);
    else
        waitsSince_.emplace(mailbox, time_.now());
}

void SimulatedServer::request(Turns::ParticipantId mailbox, PictureOrder order, PictureDone done) {
    ++ordered_;
    asked(mailbox, order);
    Requests one = newRequest(std::move(order), std::move(done));
    change([&](Requests& ended) { turns_.place(mailbox, one, time_.now(), ended); });
}

bool SimulatedServer::replaceWaiting(Turns::ParticipantId mailbox, PictureOrder order, PictureDone done) {
    Requests one = newRequest(order, std::move(done));
    bool replaced = false;
    change([&](Requests& ended) {
        replaced = turns_.replaceWaiting(mailbox, one, time_.now(), ended);
        if (!replaced) return one.front().promise.release();
        ++ordered_;
        asked(mailbox, order);
    });
    return replaced;
}

void SimulatedServer::abandon(Turns::ParticipantId mailbox) {
    waitsSince_.erase(mailbox);
    change([&](Requests& ended) { turns_.abandon(mailbox, ended); });
}

Turns::SnapshotId SimulatedServer::snapshot(PictureOrder order, PictureDone done) {
    Requests one = newRequest(std::move(order), std::move(done));
    Expected<Turns::SnapshotId> queued;
    change([&](Requests&) { queued = turns_.snapshot(one, time_.now()); });
    if (queued)
        ++ordered_;
    else
        one.front().promise.release();
    return queued.value_or(0);
}

void SimulatedServer::abandonSnapshot(Turns::SnapshotId snapshot) {
    change([&](Requests& ended) { turns_.abandonSnapshot(snapshot, ended); });
}

bool SimulatedServer::worksOn(Turns::SnapshotId snapshot) {
    const auto isIt = [&](Turns::Taken request) { return request->number == snapshot; };
    if (slicing_ && isIt(drawing_.back().request)) return true;
    if (preparing_ && isIt(*preparing_)) return true;
    for (const auto line : {Turns::Line::Frames, Turns::Line::Pictures})
        if (encoding_[std::size_t(line)] && isIt(turns_.toEncode(line))) return true;
    return false;
}

// ---- machines: after everything that happens, whoever can go on does

void SimulatedServer::settle() {
    draw();
    prepare();
    for (const auto line : {Turns::Line::Frames, Turns::Line::Pictures}) encode(line);
    keepTime();
    check();
}

double SimulatedServer::drawMs(const PictureOrder& order) const {
    const int samples = order.view.quality.samples.value_or(order.complete ? defaultSamples : 1);
    const double detail = order.view.quality.detail.value_or(1);
    return 0.5 + machine_.perMegapixel * pixelsOf(order) / 1e6 * samples / std::max(1.0, detail * detail);
}

void SimulatedServer::draw() {
    if (slicing_ || reopening_) return;
    while (drawing_.empty()) {
        const auto taken = turns_.take(time_.now());
        if (!taken) return;
        if ((*taken)->order.complete && underWay_) completeUnderWay();
        begin(*taken);
    }
    if (drawing_.back().request->stop.stop_requested()) return slicePassed(0);
    slicing_ = true;
    const double most = machine_.pauses ? sliceMs : pollMs;
    const double ms = std::min(drawing_.back().leftMs, most * chance_.between(0.3, 1));
    time_.after(ms, [this, ms, slice = ++slice_] {
        if (slice == slice_) slicePassed(ms);
    });
}

// As the render thread does (server/scheduler/render_thread.cpp): what lacks blocks is found out first.
void SimulatedServer::begin(Turns::Taken taken) {
    const Turns::Request& request = *taken;
    if (request.kind != Turns::Kind::Snapshot && viewOf(request.order) != newest_[request.by])
        violate("a mailbox's older request was drawn");
    if (request.kind == Turns::Kind::Moving) {
        const auto since = waitsSince_.find(request.by);
        if (since != waitsSince_.end()) {
            longestWait_ = std::max(longestWait_, inMilliseconds(time_.now() - since->second));
            waitsSince_.erase(since);
        }
    }
    if (!request.prepared && isMissing(request.order)) {
        Requests ended;
        if (request.order.complete) {
            turns_.lacksBlocks(taken, time_.now(), ended);
            return answer(ended);
        }
        load(request.order);
        if (request.order.onlyWhole) {
            turns_.lacks(taken, time_.now(), ended);
            return answer(ended);
        }
    }
    const double ms = drawMs(request.order);
    double& longest = request.kind == Turns::Kind::Moving ? longestMoving_ : longestOther_;
    longest = std::max(longest, ms);
    within_ += !drawing_.empty();
    drawing_.push_back({taken, ms, ms});
}

void SimulatedServer::slicePassed(double ms) {
    slicing_ = false;
    Active& top = drawing_.back();
    top.leftMs -= ms;
    if (top.request->stop.stop_requested()) {
        const auto taken = top.request;
        drawing_.pop_back();
        return change([&](Requests& ended) { turns_.failed(taken, cancelled(), time_.now(), ended); });
    }
    if (top.leftMs <= 1e-9) return drawnToTheEnd();
    if (machine_.pauses) {
        const std::size_t depth = drawing_.size();
        while (drawing_.size() == depth) {
            const auto taken = turns_.takeWithin(time_.now());
            if (!taken) break;
            begin(*taken);
        }
    }
    settle();
}

void SimulatedServer::drawnToTheEnd() {
    const Active done = drawing_.back();
    drawing_.pop_back();
    ++drawn_;
    const bool late = machine_.pixelsComeLate && drawing_.empty() && !done.request->order.complete;
    if (!late) {
        if (drawing_.empty() && underWay_) completeUnderWay();
        turns_.drawn(done.request, time_.now());
        return settle();
    }
    turns_.letGo(done.request, time_.now());
    if (underWay_) completeUnderWay();
    underWay_ = done;
    time_.after(chance_.between(0.5, 8), [this, number = done.request->number] {
        if (!underWay_ || underWay_->request->number != number || slicing_) return;
        completeUnderWay();
        settle();
    });
    settle();
}

void SimulatedServer::completeUnderWay() {
    const Active done = *std::exchange(underWay_, std::nullopt);
    turns_.resume(done.request, time_.now());
    if (!done.request->stop.stop_requested()) return turns_.drawn(done.request, time_.now());
    Requests ended;
    turns_.failed(done.request, cancelled(), time_.now(), ended);
    answer(ended);
}

void SimulatedServer::mayLoseDevice() {
    if (machine_.lossesPerMinute <= 0 || calm_) return;
    time_.after(60e3 / machine_.lossesPerMinute * chance_.between(0.2, 1.8), [this] {
        mayLoseDevice();
        if (!calm_) loseDevice();
    });
}

// What is drawn within another picture waits for another turn; the other one is drawn again.
void SimulatedServer::loseDevice() {
    if (reopening_ || underWay_) return;
    ++lost_;
    reopening_ = true;
    slicing_ = false;
    ++slice_;
    change([&](Requests& ended) {
        while (drawing_.size() > 1) {
            turns_.putBack(drawing_.back().request, time_.now(), ended);
            drawing_.pop_back();
        }
    });
    if (!drawing_.empty()) drawing_.back().leftMs = drawing_.back().allMs;
    time_.after(reopenMs, [this] {
        reopening_ = false;
        settle();
    });
}

// ---- the disk

void SimulatedServer::mayStall() {
    if (machine_.stallsPerMinute <= 0 || calm_) return;
    time_.after(60e3 / machine_.stallsPerMinute * chance_.between(0.2, 1.8), [this] {
        if (!calm_) stall(machine_.stallMs * chance_.between(0.1, 1));
        mayStall();
    });
}

void SimulatedServer::stall(double ms) {
    stalledUntil_ = time_.now() + milliseconds(ms);
}

bool SimulatedServer::isMissing(const PictureOrder& order) {
    if (seen_.insert(viewOf(order)).second && chance_.happens(machine_.coldViews))
        readBy_[viewOf(order)] = Time::max();
    const auto read = readBy_.find(viewOf(order));
    return read != readBy_.end() && read->second > time_.now();
}

void SimulatedServer::load(const PictureOrder& order) {
    const auto read = readBy_.find(viewOf(order));
    if (read == readBy_.end() || read->second != Time::max()) return;
    read->second =
        std::max(time_.now(), stalledUntil_) + milliseconds(machine_.loadMs * chance_.scale(0.1, 10));
}

void SimulatedServer::prepare() {
    if (preparing_ && (*preparing_)->stop.stop_requested()) {
        const auto taken = *std::exchange(preparing_, std::nullopt);
        return change([&](Requests& ended) { turns_.blocksFailed(taken, cancelled(), time_.now(), ended); });
    }
    if (preparing_) return;
    preparing_ = turns_.takeToPrepare(time_.now());
    if (!preparing_) return;
    const PictureOrder& order = (*preparing_)->order;
    load(order);
    const auto read = readBy_.find(viewOf(order));
    const Time ready = read == readBy_.end() ? time_.now() : read->second;
    time_.at(ready, [this, number = (*preparing_)->number, ready] {
        if (!preparing_ || (*preparing_)->number != number) return;
        const auto taken = *std::exchange(preparing_, std::nullopt);
        taken->prepared.emplace();
        change([&](Requests& ended) { turns_.blocksCame(taken, time_.now(), ended); });
    });
}

// ---- encoders, deadlines

void SimulatedServer::encode(Turns::Line line) {
    bool& busy = encoding_[std::size_t(line)];
    if (busy || !turns_.hasToEncode(line)) return;
    busy = true;
    const auto& request = *turns_.toEncode(line);
    const double one = machine_.encodeShare * machine_.perMegapixel * pixelsOf(request.order) / 1e6;
    const double ms = one * (request.order.format == PictureFormat::Png ? 10 : 1);
    if (line == Turns::Line::Frames) longestEncoding_ = std::max(longestEncoding_, ms);
    encodeOn(line, ms, ms);
}

// Encoders look whether they are to stop.
void SimulatedServer::encodeOn(Turns::Line line, double leftMs, double allMs) {
    const double ms = std::min(leftMs, pollMs);
    time_.after(ms, [this, line, left = leftMs - ms, allMs] {
        if (left <= 1e-9 || turns_.toEncode(line)->stop.stop_requested())
            encoded(line, allMs - left);
        else
            encodeOn(line, left, allMs);
    });
}

void SimulatedServer::encoded(Turns::Line line, double ms) {
    encoding_[std::size_t(line)] = false;
    const auto taken = turns_.toEncode(line);
    EncodedPicture picture;
    picture.bytes = someBytes(pixelsOf(taken->order));
    picture.width = taken->order.view.width;
    picture.height = taken->order.view.height;
    picture.stats.samplesMissing = !taken->order.complete && isMissing(taken->order) ? 1 : 0;
    picture.renderMs = drawMs(taken->order);
    picture.encodeMs = ms;
    picture.rivals = taken->rivals;
    if (taken->end != Turns::End::Open)
        taken->promise.keep(tl::unexpected(cancelled()));
    else if (time_.now() > taken->deadline)
        taken->promise.keep(tl::unexpected(tooLate()));
    else
        taken->promise.keep(std::move(picture));
    change([&](Requests& ended) { turns_.encoded(taken, milliseconds(ms), time_.now(), ended); });
}

void SimulatedServer::keepTime() {
    const Time next = turns_.nextTime();
    if (next >= timer_) return;
    timer_ = next;
    time_.at(next, [this, next] {
        if (timer_ != next) return;
        timer_ = Time::max();
        change([&](Requests& ended) { turns_.passTime(time_.now(), ended); });
    });
}

// ---- what must hold at every step

void SimulatedServer::check() {
    if (turns_.snapshotsWaiting() > 16) violate("more snapshots wait than may");
    if (turns_.mostInLine() > 4) violate("more frames wait for an encoder than may");
    if (turns_.depth() > 4) violate("pictures lie too deep within each other");
    if (turns_.picturesInHand() > 1 && double(turns_.frameBytes()) > memoryOf(machine_))
        violate("stills and snapshots in hand take more memory than there is");
    // Nobody starves: a moving frame waits for as long as everybody else may have owed to them and draw one
    // frame, and where the device does not pause, one of their pictures.
    const double each =
        250 + 2 * longestMoving_ + longestEncoding_ + (machine_.pauses ? 4 * longestMoving_ : longestOther_);
    const double most = double(mostParticipants_) * each + 2 * reopenMs * (machine_.lossesPerMinute > 0);
    for (const auto& [mailbox, since] : waitsSince_)
        if (inMilliseconds(time_.now() - since) > most)
            violate(
                fmt::format("a moving frame has waited for {:.0f} ms, and {:.0f} is the most that is right",
                            inMilliseconds(time_.now() - since), most));
}

}  // namespace scancast::simulation
