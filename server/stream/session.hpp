// One client's stream as a state machine: messages and finished pictures in, messages, frames and orders out.
// No sockets, no threads, no clock of its own: the caller says what time it is.
//
//   hello → welcome → (view → moving frames → quiet → stills, sharper as blocks arrive → final still)*
//
// A cloud that is still being read is looked at coarsely; when a finer one takes its place, so does the
// picture. A frame of a live cloud is shown like a new view: a moving frame at once, stills when none follows.
//
// Owned by a WebSocket connection, which calls it from its strand only. Place in the pipeline: net →
// **session** → scheduler → session → net.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/frame_header.hpp"
#include "protocol/messages.hpp"
#include "protocol/problem.hpp"
#include "server/base/metrics.hpp"
#include "server/scheduler/picture_order.hpp"
#include "server/scheduler/video_places.hpp"
#include "server/stream/frame_pace.hpp"
#include "server/stream/quality_controller.hpp"
#include "server/stream/resume_store.hpp"
#include "server/stream/scene.hpp"
#include "server/stream/send_window.hpp"
#include "server/stream/session_register.hpp"
#include "server/stream/still_schedule.hpp"

namespace scancast {

/// What a session tells the world. Called from inside the session's functions; must not call back into it.
class StreamPort {
  public:
    virtual ~StreamPort() = default;
    virtual void sendText(std::string text) = 0;
    /// One binary message: the header, `depth` where it is not null, then the picture.
    virtual void sendFrame(const FrameHeader& header, std::shared_ptr<const Bytes> picture,
                           std::shared_ptr<const Bytes> depth) = 0;
    /// Into the scheduler's mailbox; the result comes back through pictureDone() with this order's number.
    virtual void order(std::uint64_t number, PictureOrder order) = 0;
    /// Overwrites the request that waits in the mailbox, if one does.
    virtual bool replaceWaiting(std::uint64_t number, PictureOrder order) = 0;
    /// What lies under that pixel; the answer comes back through pickDone() with this number.
    virtual void pick(std::uint64_t seq, std::shared_ptr<const Cloud> cloud,
                      std::shared_ptr<const PlannedView> planned, double x, double y) = 0;
    /// Empties the mailbox and stops a running still.
    virtual void abandon() = 0;
    /// After everything sent so far. Nothing is called on the port afterwards.
    virtual void close(CloseCode code, std::string reason) = 0;
    /// What to call when another connection takes this session over; from any thread, may outlive the
    /// session.
    virtual std::function<void()> onTaken() = 0;
};

struct SessionOptions {
    std::string id;     ///< of a new session; one that is resumed keeps its own
    std::string owner;  ///< who it belongs to: nobody else goes on with it
    SessionRegistration* registration =
        nullptr;                  ///< its entry in the register; empty = it has none, and follows nobody
    bool mayFollow = true;        ///< others; what they show may be more than its client may see
    bool endsWithLeader = false;  ///< ends when the session that it follows does
    /// Frames that are made before one is acknowledged; empty = as many as the line holds (send_window.hpp).
    std::optional<std::size_t> window;
    ResumeStore* resumable = nullptr;    ///< null = sessions cannot be resumed
    const VideoPlaces* video = nullptr;  ///< null = moving frames are JPEG
    std::uint64_t maxPixels = 0;         ///< of a picture
    std::chrono::milliseconds helloPatience{10000};
    std::chrono::milliseconds statsInterval{1000};
    StillTimes stills;
    std::chrono::milliseconds cloudInterval{250};  ///< between looks whether a cloud has been loaded
};

class StreamSession {
  public:
    using Clock = std::chrono::steady_clock;
    using Time = Clock::time_point;

    /// The three outlive the session.
    StreamSession(SessionOptions options, const StreamWorld& world, StreamPort& port, Metrics& metrics,
                  Time now);

    void text(std::string_view message, Time now);
    void binary();
    void pictureDone(std::uint64_t number, Expected<EncodedPicture> result, Time now);
    /// `point` as messages::Picked has it.
    void pickDone(std::uint64_t seq, Expected<nlohmann::json> point);
    /// A `view` that came by another way than text(): what is shown then, or why it was refused.
    tl::expected<SharedView, Problem> change(const messages::ViewChange& change, Time now);
    /// Others may have changed something: the session that this one follows, or the clouds that there are.
    void lookAround(Time now);
    /// Call at wakeAt(), or any time.
    void tick(Time now);
    std::optional<Time> wakeAt() const;
    /// The server will be gone soon: its client is told when to connect elsewhere, once, and after the welcome.
    void moveOn(const messages::Drain& drain);
    /// The server shuts down.
    void goAway();
    /// Who opened it may look no longer; the reason is a sentence.
    void dismiss(std::string reason);
    /// Another connection goes on with this session.
    void taken();
    /// Its connection is no more. `done`: the client said so itself, and will not come back for it.
    void connectionLost(bool done, Time now);
    bool closed() const { return state_ == State::Closed; }
    /// Its hello was accepted.
    bool greeted() const { return state_ != State::Greeting; }
    const std::string& id() const { return id_; }

  private:
    enum class State : std::uint8_t { Greeting, Open, Closed };

    struct Order {
        std::uint64_t number = 0, seq = 0;
        Time viewTime, placed;
        std::optional<StillSchedule::Still> still;  // empty = a moving frame
        MovingQuality quality;                      // of a moving frame
        View wanted, view;                          // view: as it is drawn
        std::shared_ptr<const Cloud> cloud;
        bool taken = false;    // from the session that this one follows
        bool asVideo = false;  // if it can be
    };
    static bool isStill(const Order& order) { return order.still.has_value(); }

    void handle(const messages::Hello& hello, Time now);
    void handle(const messages::ViewChange& change, Time now);
    void handle(const messages::QualityLimits& quality, Time now);
    void handle(const messages::Pick& pick, Time now);
    void handle(const messages::Ack& ack, Time now);
    void handle(const messages::Ping& ping, Time now);

    void begin(Scene scene, bool resumed, Time now);
    std::optional<Scene> resume(const messages::Hello& hello, Time now);
    std::optional<Scene> remembered(SavedSession saved);
    void remember();
    void show(Scene scene, Time now);
    bool following() const { return options_.registration != nullptr && options_.registration->following(); }
    void chooseCodec(messages::Welcome& welcome);
    bool drawsVideo() const;
    bool continuesVideo(const EncodedPicture& picture);
    static Coding codingOf(const EncodedPicture& picture);
    void noteVideo(const Order& order, const EncodedPicture& picture);
    void followLeader(Time now);
    void sayNotShown(Problem problem);
    void leaderLeft();
    void refuse(Problem problem, std::optional<std::uint64_t> seq);
    void pump(Time now);
    void orderDue(Time now);
    void place(Order order, Time now);
    void viewChanged(Time now);
    void lookForNewerCloud(Time now);
    void leaveOutLost(Time now);
    bool stillComing() const;
    Order nextOrder(std::optional<StillSchedule::Still> still);
    View viewOf(const Order& order) const;
    PictureOrder pictureOf(const Order& order) const;
    void deliver(const Order& order, EncodedPicture picture, Time now);
    void sendStats(const Order& order, const EncodedPicture& picture, Time now);
    void close(CloseCode code, std::string reason);
    bool fits(const SharedPicture& picture) const;
    void takeShared(Time now);
    void noteShared(const std::shared_ptr<const SharedPicture>& newest, Time now);
    void noteMaking();
    void abandonOwn();
    void forgetLeader();
    Clock::duration patienceWithLeader() const;
    Clock::duration patienceWithStill() const;
    void share(const Order& order, const EncodedPicture& picture);
    std::optional<Time> due() const;
    bool hasRoom(Time now) const;
    bool hasQuiet(Time now) const;
    std::size_t unacknowledged() const { return std::size_t(lastFrame_ - ackedFrame_); }

    const SessionOptions options_;
    const StreamWorld& world_;
    StreamPort& port_;
    Metrics& metrics_;

    State state_ = State::Greeting;
    Time opened_;
    Scene scene_;
    MovingLimits limits_;
    QualityController quality_;
    const SceneResolver scenes_;
    std::string id_;
    std::optional<ResumeStore::Key> ticket_;
    std::uint32_t turn_ = 1;                  // of its token: connections that it has had
    std::optional<messages::Drain> leaving_;  // what its client is told, or has been
    bool withDepth_ = false;                  // what this connection's hello asked for
    std::vector<Codec> codecs_;               // the same
    std::shared_ptr<VideoStream> video_;      // of moving frames, where it has one
    std::uint64_t lastVideo_ = 0;             // number of the newest of its pictures that was sent
    bool jpegInstead_ = false;  // its last moving frame could not be video: JPEGs say how large frames are
    std::uint64_t finalOrder_ = 0;  // number of the newest final still that was sent

    SendWindow window_;
    bool fresh_ = false;  // a view came for which nothing has been ordered
    Time freshSince_;
    std::shared_ptr<const SharedPicture> shared_;  // the last one of the followed session's that was sent
    bool awaits_ = false;                          // pictures of that session, in place of its own
    bool leaderHasThisSize_ = false;
    std::shared_ptr<const SharedPicture> seen_;  // the newest that could have been sent
    Time seenAt_;
    Clock::duration leadersInterval_{};  // between its moving frames
    bool leaderRests_ = false;           // pictures of its did not come
    bool leaderMakes_ = false;           // one that is for its followers
    bool makes_ = false;                 // the same of this session, as it was told last
    std::optional<Problem> notShown_;    // why what the leader shows is not shown, which has been said
    bool room_ = false;                  // for another frame, when last looked
    bool quiet_ = false;  // ... but none is ordered, because one is to find the link without a queue
    std::optional<Camera> before_;  // the camera of the view before, while the camera moves
    Time beforeTime_;
    FramePace pace_;
    StillSchedule stills_;
    std::optional<Time> nextLook_;  // for the cloud that takes the place of the one that is shown
    Time viewTime_;                 // arrival of the newest view
    std::deque<Order>
        outstanding_;  // in the scheduler's hands, oldest first; the last one may still be waiting
    std::uint64_t lastOrder_ = 0;
    std::uint64_t lastFrame_ = 0, ackedFrame_ = 0;
    std::deque<Time> sentTimes_;  // of the last second, for fps
    Time nextStats_, lookedAt_;
    std::uint64_t overtaken_ = 0;
    int picks_ = 0;  // without an answer yet
};

}  // namespace scancast
