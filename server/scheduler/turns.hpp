// Who is served next: the scheduler's policy, and all that it knows of the requests in its hands. No threads,
// no clock, no device: the caller says what time it is, does the work that it is handed, and says how that
// ended. What the server's threads do with it (scheduler.hpp) the tests' simulation does in virtual time
// (tests/simulation).
//
// - A session has a mailbox of size one: a newer request overwrites the one that waits (latest wins).
// - The device's time is shared by time, not by count: participants are mailboxes, and the snapshots of each
//   client together. Deficit round robin in its fluid form: while some ask, all of them are owed the time that
//   passes in equal parts, and who is drawn for pays it back; whoever is owed most comes next. (M. Shreedhar,
//   G. Varghese, "Efficient Fair Queuing Using Deficit Round-Robin", IEEE/ACM Transactions on Networking 4(3),
//   1996; A. K. Parekh, R. G. Gallager, "A Generalized Processor Sharing Approach to Flow Control", ibid. 1(3),
//   1993, of which the lag is what is owed here.)
// - A picture that takes long pauses between slices; meanwhile another may be drawn to its end inside the
//   pause: a moving frame inside a still or a snapshot, and any picture inside one that costs four times as
//   much, so that there are few at a time. It comes when its participant has not had its part.
// - Stills give way: they wait until nobody else asks for anything, and let every moving frame pass, until
//   their patience ends. Where a device does not pause, they are stopped and drawn again.
// - Stills and snapshots are begun only when there is memory for them beside the others that are drawn and encoded;
//   one alone is begun in any case, and moving frames, of which there are few at a time, do not wait.
// - Snapshots wait in a bounded queue, each with a deadline that counts waiting, rendering and encoding.
// - Pictures that must be complete and lack blocks wait for them aside, one at a time; one whose disk stalls
//   lets others go first, and gets the longer to itself the longer it has waited.
// - Moving frames and pictures that take longer have encoding lines of their own.
//
// A request is answered once: it leaves these lists by one named `ended`, with what became of it. Requests go
// from one list to another without needing memory. Owned by the scheduler, or a simulation; its lock or thread.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "files/machine.hpp"
#include "server/base/queue_lengths.hpp"
#include "server/base/transient_memory.hpp"
#include "server/scheduler/picture_order.hpp"
#include "server/scheduler/picture_promise.hpp"

namespace scancast {

struct TurnsOptions {
    /// Of frames of stills and snapshots that are drawn and encoded at the same time (picture_bytes.hpp).
    std::uint64_t maxFrameBytes = ~std::uint64_t(0);
    std::size_t maxSnapshots = 64;                      ///< waiting at most; one more is refused
    std::chrono::milliseconds snapshotDeadline{30000};  ///< from the request to the finished picture
    std::chrono::milliseconds stillPatience{2000};      ///< of an interruptible picture that gives way
    /// Of the machine: drawing takes all of them, and encoding one.
    int cores = machineCores();
};

/// A picture that waits for its encoder.
struct DrawnPicture {
    Frame frame;
    DeviceInfo device;    ///< that drew it
    double renderMs = 0;  ///< that it took, others within its pauses not counted
    TransientMemory::Hold held{};
};

class Turns {
  public:
    using Clock = std::chrono::steady_clock;
    using Time = Clock::time_point;
    using ParticipantId = std::uint64_t;  ///< 0 = none
    using SnapshotId = std::uint64_t;     ///< 0 = none

    enum class End : std::uint8_t {
        Open,         ///< not yet
        Done,         ///< with a picture
        Refused,      ///< its mailbox is not there, or the end has come
        Overwritten,  ///< a newer request of the mailbox came
        Abandoned,    ///< its mailbox does not want it any more
        Gone,         ///< the mailbox was closed, the snapshot's client left, or the end came
        Late,         ///< its deadline passed
        Lacking,      ///< an onlyWhole one, of which samples are still to be read
        Failed,       ///< `error` says why
    };

    enum class Kind : std::uint8_t { Moving, Still, Snapshot };

    struct Request {
        Request(PictureOrder what, PicturePromise whose)
            : order(std::move(what)), promise(std::move(whose)) {}

        PictureOrder order;
        PicturePromise promise;
        std::optional<PreparedPicture> prepared{};
        std::optional<DrawnPicture> drawn{};
        std::size_t rivals = 0;  ///< others who shared the device's time when its turn came

        // What follows is the policy's to change.
        Kind kind = Kind::Snapshot;
        ParticipantId by = 0;
        Time asked{};              ///< when it came
        std::uint64_t turns = 0;   ///< that it has had on the device: more than one where it gave way
        std::uint64_t number = 0;  ///< in the order in which they came; of a snapshot its id
        Time deadline = Time::max();
        Time givesWayUntil{};
        std::stop_source stop{std::nostopstate};  ///< of the work on it; anew with each turn
        std::chrono::nanoseconds prepareTime{0};  ///< that it has been waited for so far
        bool gaveWay = false;                     ///< stopped, to be drawn or waited for again
        End end = End::Open;
        std::optional<Error> error{};  ///< Failed
    };
    using Requests = std::list<Request>;
    /// A request that somebody works on: stays where it is until he says how that ended.
    using Taken = Requests::iterator;

    explicit Turns(const TurnsOptions& options) : options_(options) {}

    // ---- who asks

    ParticipantId openMailbox();
    /// Forgets the waiting request and stops what is being made: the client is gone. Needs no memory.
    void closeMailbox(ParticipantId mailbox, Requests& ended);
    /// `one` request for the mailbox; overwrites the one that waits, and stops its still.
    void place(ParticipantId mailbox, Requests& one, Time now, Requests& ended);
    /// The same where one waits to be overwritten; else false, and nothing changes.
    bool replaceWaiting(ParticipantId mailbox, Requests& one, Time now, Requests& ended);
    /// Drops the mailbox's waiting request and its stills.
    void abandon(ParticipantId mailbox, Requests& ended);
    /// `one` picture for order.client. ResourceLimit when the queue is full or the end is near; then it stays.
    Expected<SnapshotId> snapshot(Requests& one, Time now);
    /// Wherever it is.
    void abandonSnapshot(SnapshotId snapshot, Requests& ended);
    /// No more snapshots.
    void drain() { draining_ = true; }
    /// Nothing more at all: what waits is ended, what is being made is stopped.
    void stop(Requests& ended);
    bool draining() const { return draining_ || stopping_; }
    bool stopping() const { return stopping_; }
    /// Nothing waits and nothing is being made.
    bool idle() const;

    // ---- drawing: one at a time, and others within its pauses

    /// Whether the device pauses in its pictures; else stills are stopped for moving frames.
    void setPauses(bool pauses) { pauses_ = pauses; }
    /// Whether take() has something.
    bool hasTurn() const;
    /// What is drawn next. The time from here on is its participant's.
    std::optional<Taken> take(Time now);
    /// In a pause of the one being drawn: what is drawn before that goes on, if anything.
    std::optional<Taken> takeWithin(Time now);
    /// Time passes, for whoever is being drawn. Not needed before functions that are told the time.
    void charge(Time now);
    /// Begun, and its pixels on their way: another may be begun meanwhile. Returns to the device by resume().
    void letGo(Taken taken, Time now);
    bool hasUnderWay() const { return !underWay_.empty(); }
    void resume(Taken taken, Time now);
    /// Drawn: it is encoded next.
    void drawn(Taken taken, Time now);
    /// It lacks blocks that it must not lack: waits for them, unless it was stopped.
    void lacksBlocks(Taken taken, Time now, Requests& ended);
    /// It lacks samples, and was to be drawn with all of them or not at all.
    void lacks(Taken taken, Time now, Requests& ended);
    /// It ends with this, unless it was stopped to give way: then it is drawn later.
    void failed(Taken taken, Error error, Time now, Requests& ended);
    /// Through no fault of its own: waits for another turn, unless there is a newer one.
    void putBack(Taken taken, Time now, Requests& ended);

    // ---- waiting for blocks: one at a time

    bool hasToPrepare() const { return !toPrepare_.empty() && preparing_.empty() && preparedCount_ == 0; }
    std::optional<Taken> takeToPrepare(Time now);
    /// Its blocks are there (in `prepared`): takes its turn with them.
    void blocksCame(Taken taken, Time now, Requests& ended);
    /// They did not come. It was stopped, perhaps for another that waits: then it goes on later.
    void blocksFailed(Taken taken, Error error, Time now, Requests& ended);

    // ---- encoding: one at a time in each line

    enum class Line : std::uint8_t { Frames, Pictures };
    bool hasToEncode(Line line) const { return !lineOf(line).empty(); }
    /// Its place stays taken, so that the bound counts it, too.
    Taken toEncode(Line line) { return lineOf(line).begin(); }
    /// It has been answered; `took`: of encoding.
    void encoded(Taken taken, std::chrono::nanoseconds took, Time now, Requests& ended);
    /// Whether something has been begun and not been drawn.
    bool drawing() const { return !drawing_.empty() || !underWay_.empty(); }

    // ---- time

    /// When passTime() has something to do, as things stand; max() = never.
    Time nextTime() const;
    /// Ends what is late and waits, stops what is late and under way; lets another wait for its blocks.
    void passTime(Time now, Requests& ended);

    // ---- for who watches over it

    std::size_t snapshotsWaiting() const { return snapshotCount_; }
    QueueLengths lengths() const;
    std::size_t mostInLine() const { return std::max(lines_[0].size(), lines_[1].size()); }
    std::size_t depth() const { return drawing_.size(); }
    /// Stills and snapshots that are drawn and encoded, and the memory that they take.
    std::size_t picturesInHand() const;
    std::uint64_t frameBytes() const;
    /// The device's time that the participant has not had of its part; less than 0 = it had too much.
    std::chrono::nanoseconds owed(ParticipantId participant) const;

  private:
    struct Participant {
        Requests waiting;   ///< of a mailbox at most one
        Requests prepared;  ///< with its samples
        std::chrono::nanoseconds owed{0};
        bool asks() const { return !waiting.empty() || !prepared.empty(); }
    };
    using Participants = std::map<ParticipantId, Participant>;
    struct Choice {
        Participants::iterator of;
        Requests* from = nullptr;
        const Request& request() const { return from->front(); }
    };

    static Line lineFor(const Request& request) {
        return request.kind == Kind::Moving ? Line::Frames : Line::Pictures;
    }
    Requests& lineOf(Line line) { return lines_[std::size_t(line)]; }
    const Requests& lineOf(Line line) const { return lines_[std::size_t(line)]; }
    bool hasRoom(Line line) const;
    bool hasMemory(const Request& request) const;
    template <class Visit>
    void forEachInHand(const Visit& visit) const;
    bool hasTurn(const Participant& participant, Line line) const;

    std::optional<Choice> front(Participants::iterator participant);
    template <class Eligible>
    std::optional<Choice> choose(Time now, const Eligible& eligible);
    bool goesBefore(const Choice& candidate, const Request& running, Time now) const;
    Taken begin(const Choice& choice, Time now);
    std::size_t sharers(ParticipantId besides, Time now) const;
    bool shares(ParticipantId id, const Participant& participant, Time now) const;
    void spend(ParticipantId participant, std::chrono::nanoseconds time, Time now);

    void enter(Participant& participant, bool prepared, Requests& from, Taken request);
    void leave(Participant& participant, bool prepared, Taken request, Requests& to);
    void endIn(Requests& list, Taken request, End how, Requests& ended);
    void endWaiting(Participant& participant, bool prepared, Taken request, End how, Requests& ended);
    void endWaiting(Participant& participant, End how, Requests& ended);
    void endStills(Participant& participant, Requests& ended);
    template <class Wanted>
    void endAside(const Wanted& wanted, End how, Requests& ended);
    template <class Wanted>
    void stopWork(const Wanted& wanted, End how);
    void stopStills(Time now);
    bool returnTo(Requests& from, Taken taken);
    void waitAside(Requests& from, Taken taken);
    std::optional<Time> othersPrepareAt() const;
    void forgetIdleClients();

    const TurnsOptions options_;
    Participants participants_;
    std::map<std::string, ParticipantId> clients_;  ///< participants that are snapshots of one client
    std::uint64_t lastId_ = 0, lastNumber_ = 0;

    // What waits for a turn is in its participant's lists, and counted.
    std::array<std::size_t, 2> waiting_{};  ///< for each encoding line
    std::size_t preparedCount_ = 0;         ///< of these, with their samples
    std::size_t snapshotCount_ = 0;  ///< snapshots that wait for a turn without samples, or for samples

    Requests drawing_;   ///< the last one is being drawn, within a pause of the one before it
    Requests underWay_;  ///< begun; pixels on their way
    Requests toPrepare_, preparing_;
    std::array<Requests, 2> lines_;  ///< to be encoded, and being
    Time charged_{};                 ///< the last of drawing_ has been charged up to then
    Time preparingSince_{};
    bool pauses_ = false;
    bool draining_ = false, stopping_ = false;
};

}  // namespace scancast
