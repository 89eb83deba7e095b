// Draws what is asked for: the threads, and the state that they share. Who is served next is turns.hpp's to say.
//
// - One render thread owns the device. A picture's pixels may still be on their way from the GPU while the next
//   one is begun. A picture that takes long pauses between slices of some milliseconds, and others are drawn
//   within its pauses, on the same thread; no byte depends on it.
// - Two threads encode beside it, moving frames and what takes longer; one waits for blocks, one for deadlines.
// - A large picture that there is no memory for is refused before it is begun.
// - What was prepared for something that is gone before it is drawn is prepared again: nobody sees an error.
// - When the device is lost, the painter that takes over draws what was asked of it: nobody sees an error.
// - What a thread waits for is a condition of the state that they share, and the monitor wakes whoever can go
//   on: no change has to remember whom to wake.
// - An exception ends the picture that it is about, with its error; the threads go on.
//
// Owned by the server, which outlives every session. *Thread safety*: every public function may be called
// from any thread; callbacks come from the scheduler's threads, or from inside the call, and must only post.
// Place in the pipeline: stream, net → **scheduler** → render, encode → stream, net.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <thread>
#include <vector>

#include "server/base/busy_share.hpp"
#include "server/base/metrics.hpp"
#include "server/base/transient_memory.hpp"
#include "server/catalog/memory_room.hpp"
#include "server/scheduler/picture_order.hpp"
#include "server/scheduler/turns.hpp"
#include "threads/monitor.hpp"

namespace scancast {

struct SchedulerOptions : TurnsOptions {
    std::function<MemoryRoom()> room = memoryRoom;  ///< asked before a large picture is begun
    TransientMemory memory{};                       ///< where frames and encoded pictures are counted
    int encodeThreads = 1;                          ///< of one JPEG; 0 = all cores
};

/// A device that was there and is gone.
struct LostDevice {
    DeviceInfo info;
    Error error;
};

/// How the device is doing.
struct DeviceStatus {
    enum class State : std::uint8_t { Opening, Ready, Failed };
    State state = State::Opening;
    DeviceInfo info;                   ///< Ready
    Error error;                       ///< Failed
    std::optional<LostDevice> lost{};  ///< the one before, in whose place this one draws
};

class Scheduler {
  public:
    using Clock = Turns::Clock;
    using MailboxId = Turns::ParticipantId;
    using SnapshotId = Turns::SnapshotId;

    /// Starts the threads; the device is opened on the render thread, and requests may come in before it is.
    Scheduler(OpenPainter openPainter, const SchedulerOptions& options, Metrics& metrics);
    /// stop(), then wait().
    ~Scheduler();
    Scheduler(const Scheduler&) = delete;
    Scheduler& operator=(const Scheduler&) = delete;

    DeviceStatus device() const;
    /// Waits until the device is open or has failed, or the time is up.
    DeviceStatus waitForDevice(std::chrono::milliseconds patience) const;

    /// How long the render thread has been away: at a picture, since it began or last paused, or at opening a
    /// device. 0 while it waits for work: a thread that is stuck is away for ever. Never waits.
    std::chrono::milliseconds silence() const;

    /// Of the last seconds, the share in which the render thread was at work: 1 when more is asked for than it draws.
    double saturation() const { return busy_.of(Clock::now()); }

    MailboxId openMailbox();
    /// Forgets the waiting request and stops the running one: the client is gone.
    void closeMailbox(MailboxId mailbox);
    /// Puts a request in, overwriting one that waits there (whose `done` gets Cancelled), and stops the
    /// session's own running still.
    void request(MailboxId mailbox, PictureOrder order, PictureDone done);
    /// As request(), but only if one waits there to be overwritten; otherwise nothing happens and the answer is
    /// false.
    bool replaceWaiting(MailboxId mailbox, PictureOrder order, PictureDone done);
    /// Drops the session's waiting request and stops its running still.
    void abandon(MailboxId mailbox);

    /// Queues a picture. ResourceLimit when the queue is full or the server is stopping; then `done` is not
    /// called.
    Expected<SnapshotId> snapshot(PictureOrder order, PictureDone done);
    /// Nobody waits for it any more: what it is being made of stops.
    void abandonSnapshot(SnapshotId snapshot);

    /// First step of the end: no more snapshots; what was promised is still drawn.
    void drain();
    bool draining() const;
    /// What waits now.
    QueueLengths queues() const;
    /// Nothing waits and nothing is being made.
    bool idle() const;
    /// Second step: cancels everything and refuses more. Returns at once.
    void stop();
    /// After stop(): waits for the threads; no callback comes afterwards. Not from two threads at once.
    void wait();

  private:
    using Requests = Turns::Requests;
    using Taken = Turns::Taken;
    using Line = Turns::Line;

    /// A picture that a painter has begun.
    struct Begun {
        Taken request;
        std::unique_ptr<PendingFrame> frame;
        DeviceInfo device;    ///< that is at it
        int painter = 0;      ///< painterNumber_ then
        double renderMs = 0;  ///< that the render thread has been at it
    };
    /// Why a picture ends, for now, without one.
    enum class Why : std::uint8_t {
        Failed,
        LacksBlocks,  ///< and must not
        Lacks,        ///< samples, and it is drawn with all of them or not at all
        DeviceLost,   ///< within another picture, which must end before another device can take over
    };

    // What each thread waits for; with the lock held.
    bool renderIsDue() const { return turns_.stopping() || turns_.hasUnderWay() || turns_.hasTurn(); }
    bool prepareIsDue() const { return turns_.stopping() || turns_.hasToPrepare(); }
    bool encodeIsDue(Line line) const {
        return turns_.hasToEncode(line) || (turns_.stopping() && !rendering_);
    }

    // A thread is one step after another until one returns false.
    void renderLoop();
    bool renderStep();
    void prepareLoop();
    bool prepareStep();
    void encodeLoop(Line line);
    bool encodeStep(Line line);
    void deadlineLoop();
    bool deadlineStep();

    void openDevice();
    void replacePainter(const Error& lost);
    void usePainter(Expected<Painter> opened, std::optional<LostDevice> lost);
    void comeBack() { awaySince_ = Clock::now().time_since_epoch(); }

    void beginNext();
    void drawWithin();
    template <class Take>
    std::optional<Taken> nextTurn(const Take& take);
    std::optional<Begun> beginOne(Taken request);
    std::optional<Begun> tryBegin(Taken request);
    void completeOne(Begun begun);
    void complete(Begun& begun);
    Expected<void> checkMemory(const PictureOrder& order) const;
    Expected<std::unique_ptr<PendingFrame>> begin(Turns::Request& request, const std::stop_token& token,
                                                  Why& why);
    Expected<Frame> finish(Begun& begun, const std::stop_token& token, Why& why);
    void endWithout(Taken request, Error error, Why why);
    void endFaulty(Taken request, Error fault);
    Expected<EncodedPicture> encoded(Turns::Request& request, const std::stop_token& token);
    std::stop_token tokenOf(Taken request) const;

    template <class Change>
    void change(const Change& change);
    void answer(Requests ended) noexcept;
    void answer(Turns::Request& request, Expected<EncodedPicture> result,
                std::optional<DropReason> dropped) noexcept;

    const OpenPainter openPainter_;
    const SchedulerOptions options_;
    Metrics& metrics_;

    mutable Monitor monitor_;  // guards what follows, up to the render thread's own
    DeviceStatus device_;
    Turns turns_;
    PreparePicture prepare_;
    bool rendering_ = true;  // the render thread may still have something encoded
    // Beside the lock, so that whoever asks whether threads are stuck does not wait for one; 0 = not away.
    std::atomic<Clock::duration> awaySince_{Clock::now().time_since_epoch()};

    BusyShare busy_;

    // The render thread's own.
    std::optional<Painter> painter_;
    int painterNumber_ = 0;              // counts those that were lost
    std::optional<Begun> begun_;         // its pixels may still be on their way
    int within_ = 0;                     // pictures in whose pauses the current one is drawn
    std::optional<Error> lost_;          // the painter is lost, and those pictures still draw with it
    std::chrono::nanoseconds paused_{};  // that the current picture has been paused

    std::thread renderThread_, prepareThread_, frameThread_, pictureThread_, deadlineThread_;
};

template <class Change>
void Scheduler::change(const Change& change) {
    Requests ended;
    {
        const Monitor::Lock lock(monitor_);
        change(ended);
    }
    answer(std::move(ended));
}

}  // namespace scancast
