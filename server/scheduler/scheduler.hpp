// Who is rendered next. One render thread owns the device; sessions and snapshot requests put wishes in. A
// picture's pixels may still be on their way from the GPU while the next one is begun, and encoding runs
// beside both.
//
// - A session has a mailbox of size one: a newer wish overwrites the one that waits (latest wins).
// - Mailboxes take turns; all snapshots together are one more participant, first come first served.
// - Stills give way: they wait until nobody else wishes for anything, and one that is being drawn is put back
//   when a moving frame is wished for. After some patience a still takes turns like everybody, so it comes.
// - A large picture that there is no memory for is refused before it is begun.
// - The queue of snapshots is bounded, and each has a deadline that counts waiting and rendering.
// - Pictures that must be complete and lack blocks wait for them on a thread of its own, one at a time, and
//   take another turn when they are there: nobody else's picture waits for somebody's disk.
// - When the device is lost, the painter that takes over draws what was asked of it: nobody sees an error.
// - What a thread waits for is a condition of the state that they share (the functions named ...IsDue), and
// the
//   monitor wakes whoever can go on: no change has to remember whom to wake.
// - An exception ends the picture that it is about, with its error; the threads go on.
//
// Owned by the server, which outlives every session. *Thread safety*: every public function may be called
// from any thread; callbacks come from the scheduler's threads, or from inside the call, and must only post.
// Place in the pipeline: stream, net → **scheduler** → render, encode → stream, net.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <optional>
#include <stop_token>
#include <thread>

#include "server/base/metrics.hpp"
#include "server/catalog/memory_room.hpp"
#include "server/scheduler/picture.hpp"
#include "server/scheduler/picture_promise.hpp"
#include "threads/monitor.hpp"

namespace scancast {

struct SchedulerOptions {
    std::size_t maxSnapshots = 64;                      ///< waiting at most; one more is refused
    std::chrono::milliseconds snapshotDeadline{30000};  ///< from the request to the finished picture
    std::chrono::milliseconds stillPatience{2000};      ///< of an interruptible picture that gives way
    std::function<MemoryRoom()> room = memoryRoom;      ///< asked before a large picture is begun
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
    using Clock = std::chrono::steady_clock;
    using MailboxId = std::uint64_t;

    /// Starts the threads; the device is opened on the render thread, and wishes may come in before it is.
    Scheduler(OpenPainter openPainter, const SchedulerOptions& options, Metrics& metrics);
    /// stop(), then wait().
    ~Scheduler();
    Scheduler(const Scheduler&) = delete;
    Scheduler& operator=(const Scheduler&) = delete;

    DeviceStatus device() const;
    /// Waits until the device is open or has failed, or the time is up.
    DeviceStatus waitForDevice(std::chrono::milliseconds patience) const;

    MailboxId openMailbox();
    /// Forgets the waiting wish and stops the running one: the client is gone.
    void closeMailbox(MailboxId mailbox);
    /// Puts a wish in, overwriting one that waits there (whose `done` gets Cancelled), and stops the
    /// session's own running still.
    void wish(MailboxId mailbox, PictureOrder order, PictureDone done);
    /// As wish(), but only if one waits there to be overwritten; otherwise nothing happens and the answer is
    /// false.
    bool replaceWaiting(MailboxId mailbox, PictureOrder order, PictureDone done);
    /// Drops the session's waiting wish and stops its running still.
    void abandon(MailboxId mailbox);

    /// Queues a picture that everybody waits for. ResourceLimit when the queue is full or the server is
    /// stopping; then `done` is not called.
    Expected<void> snapshot(PictureOrder order, PictureDone done);

    /// First step of the end: no more snapshots; what was promised is still drawn.
    void drain();
    bool draining() const;
    /// Nothing waits and nothing is being made.
    bool idle() const;
    /// Second step: cancels everything and refuses more. Returns at once.
    void stop();
    /// After stop(): waits for the threads; no callback comes afterwards. Not from two threads at once.
    void wait();

  private:
    struct Wish {
        PictureOrder order;
        PicturePromise promise;
        Clock::time_point deadline = Clock::time_point::max();
        MailboxId mailbox = 0;
        std::optional<PreparedPicture> prepared{};
        std::size_t rivals = 0;  // moving frames that waited when its turn came
        Clock::time_point givesWayUntil{};
        bool lacking = false;  // samples, and it is drawn with all of them or not at all
    };
    struct Running {
        MailboxId mailbox = 0;
        bool interruptible = false;
        Clock::time_point deadline;
        std::stop_source stop;
        bool late = false;      ///< stopped by its deadline
        bool orphaned = false;  ///< its mailbox is gone
        Clock::time_point givesWayUntil{};
        bool gaveWay = false;  ///< stopped for somebody's moving frame: to be drawn again
    };
    /// A picture that a painter has begun.
    struct Begun {
        Wish wish;
        std::unique_ptr<PendingFrame> frame;
        DeviceInfo device;    ///< that is at it
        int painter = 0;      ///< painterNumber_ then
        double renderMs = 0;  ///< that the render thread has been at it
    };
    struct Rendered {
        Wish wish;
        Frame frame;
        DeviceInfo device;
        double renderMs = 0;
    };

    enum class Fate : std::uint8_t { Waits, Overwrote, Refused };  ///< of a wish
    /// In the order in which they came. Wishes go from one list to another without needing memory.
    using Wishes = std::list<Wish>;

    static constexpr MailboxId snapshots = 0;                // the participant that stands for all snapshots
    static constexpr MailboxId preparedOne = ~MailboxId(0);  // the one that stands for what has been prepared
    static constexpr std::size_t maxEncoding = 2;

    // What each thread waits for; with the lock held.
    bool renderIsDue() const;
    bool prepareIsDue() const { return stopping_ || (!toPrepare_.empty() && prepared_.empty()); }
    bool encodeIsDue() const { return !encoding_.empty() || (stopping_ && !rendering_); }
    Clock::time_point firstDeadline() const;

    // A thread is one step after another until one returns false.
    void renderLoop();
    bool renderStep(std::optional<Begun>& begun);
    void prepareLoop();
    bool prepareStep();
    void encodeLoop();
    bool encodeStep();
    void deadlineLoop();
    bool deadlineStep();

    void openDevice();
    void replacePainter(const Error& lost);
    void usePainter(Expected<Painter> opened, std::optional<LostDevice> lost);
    Fate placeWish(Wish& wish, Wishes& abandoned);
    std::optional<Wish> takeWaitingAfter(MailboxId& last);
    void standInLine(MailboxId turn);
    void takeNext(std::optional<Wish>& wish);
    MailboxId takeTurn();
    const Wish* waiting(MailboxId turn) const;
    Wish wishOf(MailboxId mailbox, PictureOrder order, PictureDone done) const;
    static Running runningOf(const Wish& wish);
    void makeWay();
    bool putBack(Wish& wish);
    std::size_t movingWishes() const;
    void beginNext(std::optional<Begun>& begun);
    std::optional<Begun> beginOne(Wish wish);
    std::optional<Begun> tryBegin(Wish& wish);
    void completeOne(Begun begun);
    void complete(Begun& begun);
    Expected<void> checkMemory(const View& view) const;
    Expected<std::unique_ptr<PendingFrame>> begin(Wish& wish, const std::stop_token& token, bool& deferred);
    Expected<Frame> finish(Begun& begun, const std::stop_token& token, bool& deferred);
    void endWithout(std::optional<Running>& slot, Wish& wish, Error error, bool deferred);
    bool waitsOn(const Running& how, Wish& wish, bool deferred);
    void prepareOne(Wishes& one);
    Expected<Picture> encoded(Rendered& job);
    std::optional<Wish> takeLate(Clock::time_point now);
    void finishFailed(Wish& wish, Error error, const Running& how);
    Wishes takePreparing(MailboxId mailbox, bool alsoMoving);
    void endFaulty(std::optional<Running>& slot, Wish& wish, Error fault) noexcept;
    void drop(Wish& wish, Error (*why)(), std::optional<DropReason> reason) noexcept;
    void drop(Wishes wishes, DropReason reason) noexcept;
    void finish(Wish& wish, Expected<Picture> result, std::optional<DropReason> dropped) noexcept;
    void stopRunning(MailboxId mailbox, bool alsoMoving);
    std::array<std::optional<Running>*, 3> allBusy() { return {&running_, &begun_, &preparing_}; }
    std::array<const std::optional<Running>*, 3> allBusy() const { return {&running_, &begun_, &preparing_}; }

    const OpenPainter openPainter_;
    const SchedulerOptions options_;
    Metrics& metrics_;

    mutable Monitor monitor_;  // guards what follows, up to the render thread's own
    DeviceStatus device_;
    std::map<MailboxId, std::optional<Wish>> mailboxes_;
    MailboxId lastMailbox_ = 0;
    Wishes snapshots_;
    std::deque<MailboxId> turns_;  // who has something waiting, in the order in which they are served
    // Being begun; begun before, and its pixels on their way; waiting for blocks.
    std::optional<Running> running_, begun_, preparing_;
    Wishes toPrepare_;  // at most one still of each mailbox, and maxSnapshots
    Wishes prepared_;   // holds on to its samples, hence only one
    PreparePicture prepare_;
    std::deque<Rendered> encoding_;
    bool rendering_ = true;  // the render thread may still add to encoding_
    bool stopping_ = false, draining_ = false;

    // The render thread's own.
    std::optional<Painter> painter_;
    int painterNumber_ = 0;  // counts those that were lost

    std::thread renderThread_, prepareThread_, encodeThread_, deadlineThread_;
};

}  // namespace scancast
