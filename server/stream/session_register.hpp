// Who is looking at what: every live session by its id, so that an administrator can list them, plain HTTP
// can drive one, and one session can follow what another one shows.
//
// The register is owned by the server and outlives every registration; a registration is owned by the session's connection
// and leaves the register when it is destroyed. *Thread safety*: every function may be called from any
// thread. Nobody is called from inside but LiveSession::lookAround(), which only posts. Place: net →
// **register** ← session.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/messages.hpp"
#include "protocol/problem.hpp"
#include "protocol/view/view.hpp"
#include "server/scheduler/picture_order.hpp"
#include "server/stream/quality.hpp"
#include "server/stream/still_schedule.hpp"

namespace scancast {

enum class ClientKind : std::uint8_t { WebSocket, Mjpeg };
std::string_view name(ClientKind kind);

/// When the client of session `index` of `count` is to leave a server that is there for `within`: no more of them at once than
/// another server draws first pictures for, and all in the first half of the time, so that who is refused can try again.
std::chrono::milliseconds departure(std::size_t index, std::size_t count, std::chrono::milliseconds within);

/// What a session shows.
struct SharedView {
    std::string cloudId;
    View view;
    std::uint64_t seq = 0;
};

/// A picture that a session has sent, as those that follow it may send it.
struct SharedPicture {
    std::shared_ptr<const Cloud> cloud;  ///< who sees the same one may see the picture
    View wanted, drawn;                  ///< a moving frame is drawn as its quality says
    std::optional<StillSchedule::Still> still{};
    MovingQuality quality{};  ///< of a moving frame
    double fps = 0;           ///< that the session's client wants at most
    EncodedPicture picture;
};

/// A session as strangers may reach it.
class LiveSession {
  public:
    using Changed = std::function<void(tl::expected<SharedView, Problem>)>;
    virtual ~LiveSession() = default;
    /// As if its client had sent this; posts. `done` is called once, on the session's strand, with what is
    /// shown then, unless the server ends first.
    virtual void changeView(messages::ViewChange change, Changed done) = 0;
    /// The followed session shows something else, has sent a picture or is gone, or a cloud was removed. Posts; calls that come
    /// before the session has looked count as one.
    virtual void lookAround() = 0;
    /// Its client is told to connect elsewhere. Posts. Clients that hear nothing stay to the end.
    virtual void moveOn(const messages::Drain&) {}
};

struct SessionFacts {
    std::string id;
    ClientKind client = ClientKind::WebSocket;
    std::chrono::system_clock::time_point since;
    std::optional<SharedView> shows;  ///< empty before the session has been greeted
    std::uint64_t frames = 0;         ///< sent
    std::string follows;              ///< id; empty = nobody
};

class SessionRegister;

/// A session's entry. One strand writes through it at a time.
class SessionRegistration {
  public:
    SessionRegistration(SessionRegister& sessions, std::string id)
        : sessions_(sessions), id_(std::move(id)) {}
    /// Leaves; followers are told.
    ~SessionRegistration();
    SessionRegistration(const SessionRegistration&) = delete;
    SessionRegistration& operator=(const SessionRegistration&) = delete;

    std::string id() const;
    /// For a session that goes on after its connection was lost: it takes its earlier id again. Whoever still
    /// has that one - a line that is dead, and does not know it yet - gets a new one.
    void resumeAs(const std::string& id);
    /// Followers are told.
    void show(SharedView view);
    void frameSent();
    /// Whether anybody follows it.
    bool leads() const;
    /// It has sent this: followers are told. Kept while there are any, until the next one.
    void share(std::shared_ptr<const SharedPicture> picture);
    /// Whether a picture of its that it may share is being made.
    void makes(bool one);
    struct LeadersPicture {
        std::shared_ptr<const SharedPicture>
            newest;            ///< that the followed session has sent; null when there is none
        bool makes = false;    ///< the next one
        bool follows = false;  ///< there is such a session
    };
    /// What there is of the followed session's pictures.
    LeadersPicture leadersPicture() const;
    /// What that session shows, if it can be followed: 404 when there is none of that id, 503 when it shows
    /// nothing yet, 409 for oneself and wherever a follower would be followed.
    tl::expected<SharedView, Problem> mayFollow(const std::string& leader) const;
    /// The same, and follows it from now on; refused, whom this one follows stays as it was.
    tl::expected<SharedView, Problem> follow(const std::string& leader);
    void unfollow();
    bool following() const;
    /// What the followed session shows now; empty when it has ended.
    std::optional<SharedView> leader() const;

  private:
    friend class SessionRegister;
    tl::expected<SharedView, Problem> mayFollowLocked(const std::string& leader) const;

    SessionRegister& sessions_;
    std::string id_;
};

class SessionRegister {
  public:
    /// A new entry; its id cannot be guessed, because who knows it may follow the session and drive it.
    std::unique_ptr<SessionRegistration> enter(ClientKind client, std::weak_ptr<LiveSession> session);
    /// In the order in which they came.
    std::vector<SessionFacts> list() const;
    std::shared_ptr<LiveSession> find(std::string_view id) const;
    /// Of the view that it shows; 0 when there is no such session, or it shows nothing.
    std::uint64_t seqOf(std::string_view id) const;
    /// Every session looks around: a cloud was removed.
    void wakeAll() const;
    /// Every session's client is told to connect elsewhere: one after the other, within half of that time.
    void moveAll(std::chrono::milliseconds within) const;

  private:
    friend class SessionRegistration;
    struct Entry {
        SessionFacts facts;
        std::uint64_t number = 0;
        std::weak_ptr<LiveSession> session;
        SessionRegistration* registration = nullptr;
        std::shared_ptr<const SharedPicture> picture{};  // for followers
        bool makes = false;                              // another one
    };
    using Sessions = std::vector<std::weak_ptr<LiveSession>>;

    void leave(const SessionRegistration& registration);
    void renameLocked(SessionRegistration& registration, const std::string& id);
    bool leadsLocked(const std::string& id) const;
    void endFollowingLocked(Entry& follower);
    Sessions followersLocked(const std::string& id) const;
    static void wake(const Sessions& sessions);

    mutable std::mutex mutex_;
    std::map<std::string, Entry, std::less<>> entries_;
    /// How many follow an id, of those that anybody follows; also when its session is gone, as long as they say that they do: the
    /// one that takes the id again leads them. Asked for every moving frame.
    std::map<std::string, std::size_t> followers_;
    std::uint64_t last_ = 0;
};

/// The body of GET /api/v1/sessions.
nlohmann::json sessionListJson(const std::vector<SessionFacts>& sessions);
/// What POST /api/v1/sessions/{id}/view answers.
nlohmann::json toJson(const SharedView& shows);

}  // namespace scancast
