// The scheduler's threads beside the render thread: one waits for blocks, two encode, one keeps deadlines.
#include <utility>

#include "renderer/image/clock.hpp"
#include "server/base/faults.hpp"
#include "server/scheduler/outcome.hpp"
#include "server/scheduler/scheduler.hpp"
#include "server/scheduler/video_stream.hpp"

namespace scancast {
namespace {

/// The session's video takes the frame, or else it is encoded by itself; `picture` says which.
Expected<Bytes> encodedFrame(const Frame& frame, const PictureOrder& order, EncodedPicture& picture,
                             const std::stop_token& token, int threads) {
    auto coded = order.video ? order.video->encode(frame, order.view.quality.jpegQuality) : std::nullopt;
    if (!coded) return encodePicture(frame, order.view, order.format, token, threads);
    picture.codec = Codec::H264;
    picture.videoNumber = coded->number;
    picture.key = coded->key;
    return std::move(coded->bytes);
}

}  // namespace

// ---- prepare thread

void Scheduler::prepareLoop() {
    while (contained("The prepare thread", [&] { return prepareStep(); }).value_or(true)) {
    }
}

bool Scheduler::prepareStep() {
    std::optional<Taken> request;
    PreparePicture prepare;
    {
        Monitor::Lock lock(monitor_);
        monitor_.wait(lock, [this] { return prepareIsDue(); });
        if (turns_.stopping()) return false;
        prepare = prepare_;
        request = turns_.takeToPrepare(Clock::now());
    }
    const std::stop_token token = tokenOf(*request);
    auto prepared = contained("The renderer", [&] { return prepare((*request)->order, true, token); });
    change([&](Requests& ended) {
        if (!prepared) return turns_.blocksFailed(*request, std::move(prepared.error()), Clock::now(), ended);
        (*request)->prepared = std::move(*prepared);
        (*request)->prepared->complete = true;  // damaged blocks have their stand-ins: nothing more will come
        turns_.blocksCame(*request, Clock::now(), ended);
    });
    return true;
}

// ---- encode threads

void Scheduler::encodeLoop(Line line) {
    while (contained("The encode thread", [&] { return encodeStep(line); }).value_or(true)) {
    }
}

bool Scheduler::encodeStep(Line line) {
    Taken request;
    {
        Monitor::Lock lock(monitor_);
        monitor_.wait(lock, [&] { return encodeIsDue(line); });
        if (!turns_.hasToEncode(line)) return false;
        request = turns_.toEncode(line);
    }
    const auto start = Clock::now();
    const std::stop_token token = tokenOf(request);
    auto picture = contained("The encoder", [&] { return encoded(*request, token); });
    const auto took = Clock::now() - start;
    std::optional<DropReason> dropped;
    if (!picture) {
        const ErrorCode code = picture.error().code;
        dropped = code == ErrorCode::DeadlineExceeded ? DropReason::Deadline
                  : code == ErrorCode::Cancelled      ? DropReason::Gone
                                                      : DropReason::Failed;
    }
    answer(*request, std::move(picture), dropped);
    Requests answered;  // only now: who waits until nothing is being made waits for the answer, too
    const Monitor::Lock lock(monitor_);
    turns_.encoded(request, took, Clock::now(), answered);
    return true;
}

Expected<EncodedPicture> Scheduler::encoded(Turns::Request& request, const std::stop_token& token) {
    DrawnPicture& drawn = *request.drawn;
    const auto start = Clock::now();
    if (request.order.remade) {
        auto remade = request.order.remade(drawn.frame, token);
        if (!remade) return passOn(std::move(remade));
        drawn.frame = std::move(*remade);
    }
    EncodedPicture picture;
    auto bytes = encodedFrame(drawn.frame, request.order, picture, token, options_.encodeThreads);
    if (!bytes) return passOn(std::move(bytes));
    auto depth = request.order.withDepth ? encodeDepth(drawn.frame) : Bytes{};
    if (!depth) return passOn(std::move(depth));
    const double encodeMs = millisecondsSince(start);
    if (Clock::now() > request.deadline) return tl::unexpected(tooLate());
    metrics_.frameEncoded(encodeMs / 1000, bytes->size() + depth->size());
    const MemoryUse use = request.kind == Turns::Kind::Snapshot ? MemoryUse::Answers : MemoryUse::Streams;
    picture.bytes = options_.memory.shared(use, std::move(*bytes), std::move(request.order.kept));
    if (request.order.withDepth) picture.depth = options_.memory.shared(use, std::move(*depth));
    picture.width = drawn.frame.width;
    picture.height = drawn.frame.height;
    picture.stats = std::move(drawn.frame.stats);
    picture.stats.add("encode", encodeMs);
    picture.renderMs = drawn.renderMs;
    picture.encodeMs = encodeMs;
    picture.rivals = request.rivals;
    picture.device = std::move(drawn.device);
    drawn.frame = {};
    drawn.held = {};
    return picture;
}

// ---- deadline thread

void Scheduler::deadlineLoop() {
    while (contained("The deadline thread", [&] { return deadlineStep(); }).value_or(true)) {
    }
}

bool Scheduler::deadlineStep() {
    Requests ended;
    {
        Monitor::Lock lock(monitor_);
        const auto next = turns_.nextTime();
        monitor_.waitUntil(lock, next, [&] { return turns_.stopping() || turns_.nextTime() < next; });
        if (turns_.stopping()) return false;
        turns_.passTime(Clock::now(), ended);
    }
    answer(std::move(ended));
    return true;
}

}  // namespace scancast
