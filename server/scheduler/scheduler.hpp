// Who is rendered next. One render thread owns the device; sessions and snapshot requests put requests in. A
// picture's pixels may still be on their way from the GPU while the next one is begun, and encoding runs
// beside both.
//
// - A session has a mailbox of size one: a newer request overwrites the one that waits (latest wins).
// - Mailboxes take turns; all snapshots together are one more participant, first come first served.
// - Stills give way: they wait until nobody else asks for anything, and one that is being drawn is put back
//   when a moving frame is asked for. After some patience a still takes turns like everybody, so it comes.
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
#include "server/scheduler/picture_order.hpp"
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

    /// Starts the threads; the device is opened on the render thread, and requests may come in before it is.
    Scheduler(OpenPainter openPainter, const SchedulerOptions& options, Metrics& metrics);
    /// stop(), then wait().
    ~Scheduler();
    Scheduler(const Scheduler&) = delete;
    Scheduler& operator=(const Scheduler&) = delete;

    DeviceStatus device() const;
    /// Waits until the device is open or has failed, or the time is up.
    DeviceStatus waitForDevice(std::chrono::milliseconds patience) const;

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
    struct Request {
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
        Request request;
        std::unique_ptr<PendingFrame> frame;
        DeviceInfo device;    ///< that is at it
        int painter = 0;      ///< painterNumber_ then
        double renderMs = 0;  ///< that the render thread has been at it
    };
    struct Rendered {
        Request request;
        Frame frame;
        DeviceInfo device;
        double renderMs = 0;
    };

    enum class Fate : std::uint8_t { Waits, Overwrote, Refused };  ///< of a request
    /// In the order in which they came. Requests go from one list to another without needing memory.
    using Requests = std::list<Request>;

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
    Fate place(Request& request, Requests& abandoned);
    std::optional<Request> takeWaitingAfter(MailboxId& last);
    void standInLine(MailboxId turn);
    void takeNext(std::optional<Request>& request);
    MailboxId takeTurn();
    const Request* waiting(MailboxId turn) const;
    Request requestOf(MailboxId mailbox, PictureOrder order, PictureDone done) const;
    static Running runningOf(const Request& request);
    void interruptStill();
    bool putBack(Request& request);
    std::size_t movingRequests() const;
    void beginNext(std::optional<Begun>& begun);
    std::optional<Begun> beginOne(Request request);
    std::optional<Begun> tryBegin(Request& request);
    void completeOne(Begun begun);
    void complete(Begun& begun);
    Expected<void> checkMemory(const View& view) const;
    Expected<std::unique_ptr<PendingFrame>> begin(Request& request, const std::stop_token& token,
                                                  bool& deferred);
    Expected<Frame> finish(Begun& begun, const std::stop_token& token, bool& deferred);
    void endWithout(std::optional<Running>& slot, Request& request, Error error, bool deferred);
    bool waitsOn(const Running& how, Request& request, bool deferred);
    void prepareOne(Requests& one);
    Expected<EncodedPicture> encoded(Rendered& job);
    std::optional<Request> takeLate(Clock::time_point now);
    void finishFailed(Request& request, Error error, const Running& how);
    Requests takePreparing(MailboxId mailbox, bool alsoMoving);
    void endFaulty(std::optional<Running>& slot, Request& request, Error fault) noexcept;
    void drop(Request& request, Error (*why)(), std::optional<DropReason> reason) noexcept;
    void drop(Requests requests, DropReason reason) noexcept;
    void finish(Request& request, Expected<EncodedPicture> result,
                std::optional<DropReason> dropped) noexcept;
    void stopRunning(MailboxId mailbox, bool alsoMoving);
    std::array<std::optional<Running>*, 3> allBusy() { return {&running_, &begun_, &preparing_}; }
    std::array<const std::optional<Running>*, 3> allBusy() const { return {&running_, &begun_, &preparing_}; }

    const OpenPainter openPainter_;
    const SchedulerOptions options_;
    Metrics& metrics_;

    mutable Monitor monitor_;  // guards what follows, up to the render thread's own
    DeviceStatus device_;
    std::map<MailboxId, std::optional<Request>> mailboxes_;
    MailboxId lastMailbox_ = 0;
    Requests snapshots_;
    std::deque<MailboxId> turns_;  // who has something waiting, in the order in which they are served
    // Being begun; begun before, and its pixels on their way; waiting for blocks.
    std::optional<Running> running_, begun_, preparing_;
    Requests toPrepare_;  // at most one still of each mailbox, and maxSnapshots
    Requests prepared_;   // holds on to its samples, hence only one
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
