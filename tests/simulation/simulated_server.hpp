// The scheduler in virtual time: its policy (server/scheduler/turns.hpp) as it is, and machines in place of
// its threads, which take as long as chance says: a device that draws in slices - or one that does not
// pause -, and is lost now and then; a disk that stalls; encoders. Whatever the policy must never do is checked
// here at every step; what clients must see, by them.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/scheduler/turns.hpp"
#include "tests/simulation/virtual_time.hpp"

namespace scancast::simulation {

/// What its parts can do; drawn by lot for each world.
struct Machine {
    bool pauses = true;           ///< the device, within pictures; else it draws each in one go
    bool pixelsComeLate = false;  ///< as from a GPU
    double perMegapixel = 20;     ///< ms to draw one sample for each of a million pixels
    double encodeShare = 0.3;     ///< of a frame's drawing, that encoding it takes
    double loadMs = 30;           ///< that the disk takes for a view of which something is to be read
    double coldViews = 0.3;       ///< share of such views
    double stallsPerMinute = 0, stallMs = 0;
    double lossesPerMinute = 0;  ///< of the device
    double frameMemoryMB = 1e6;  ///< for stills and snapshots in hand
    double badGuess = 1.5;       ///< prices are wrong by up to this factor
};

Machine someMachine(Chance& chance);

class SimulatedServer {
  public:
    SimulatedServer(VirtualTime& time, Chance& chance, const Machine& machine);
    SimulatedServer(const SimulatedServer&) = delete;
    SimulatedServer& operator=(const SimulatedServer&) = delete;

    // As the scheduler's; `done` is called from inside events.
    Turns::ParticipantId openMailbox();
    void closeMailbox(Turns::ParticipantId mailbox);
    void request(Turns::ParticipantId mailbox, PictureOrder order, PictureDone done);
    bool replaceWaiting(Turns::ParticipantId mailbox, PictureOrder order, PictureDone done);
    void abandon(Turns::ParticipantId mailbox);
    /// 0 = refused; then `done` is not called.
    Turns::SnapshotId snapshot(PictureOrder order, PictureDone done);
    void abandonSnapshot(Turns::SnapshotId snapshot);

    /// Whether a machine is at it; what is paused costs nothing.
    bool worksOn(Turns::SnapshotId snapshot);
    /// What also comes by chance: the device is lost, which another takes the place of; the disk answers nothing for a while.
    void loseDevice();
    void stall(double ms);
    /// From now on no disk stalls and no device is lost.
    void calmDown() { calm_ = true; }
    bool idle() const { return turns_.idle() && ordered_ == answered_; }
    /// What must not have been; the first thing of that kind.
    const std::optional<std::string>& violation() const { return violation_; }
    void violate(const std::string& what);

    std::uint64_t drawn() const { return drawn_; }
    std::uint64_t within() const { return within_; }
    std::uint64_t lost() const { return lost_; }
    double longestWait() const { return longestWait_; }

  private:
    struct Active {
        Turns::Taken request;
        double leftMs = 0, allMs = 0;
    };
    using Requests = Turns::Requests;

    Requests newRequest(PictureOrder order, PictureDone done);
    template <class Change>
    void change(const Change& change);
    void answer(Requests& ended);
    void asked(Turns::ParticipantId mailbox, const PictureOrder& order);
    double drawMs(const PictureOrder& order) const;

    void settle();
    void draw();
    void begin(Turns::Taken taken);
    void slicePassed(double ms);
    void drawnToTheEnd();
    void completeUnderWay();
    void mayLoseDevice();
    void prepare();
    void encode(Turns::Line line);
    void encodeOn(Turns::Line line, double leftMs, double allMs);
    void encoded(Turns::Line line, double ms);
    void keepTime();
    void mayStall();
    bool isMissing(const PictureOrder& order);
    void load(const PictureOrder& order);
    void check();

    VirtualTime& time_;
    Chance& chance_;
    const Machine machine_;
    // What is left in `turns_` at the end is answered then.
    std::optional<std::string> violation_;
    std::uint64_t ordered_ = 0, answered_ = 0;
    Turns turns_;
    std::vector<Active> drawing_;  ///< the last one within a pause of the one before it
    std::optional<Active> underWay_;
    std::uint64_t slice_ = 0;  ///< the one that is being drawn
    bool slicing_ = false, reopening_ = false, calm_ = false;
    std::optional<Turns::Taken> preparing_;
    std::array<bool, 2> encoding_{};
    std::map<double, Time> readBy_;  ///< cold views: when they are in memory; max() = not asked for
    std::set<double> seen_;
    Time timer_ = Time::max(), stalledUntil_{};

    std::map<Turns::ParticipantId, double> newest_;  ///< of each mailbox, the view that was asked for last
    std::map<Turns::ParticipantId, Time> waitsSince_;
    std::uint64_t drawn_ = 0, within_ = 0, lost_ = 0;
    double longestWait_ = 0, longestMoving_ = 0, longestOther_ = 0, longestEncoding_ = 0;
    std::size_t mostParticipants_ = 1;
};

}  // namespace scancast::simulation
