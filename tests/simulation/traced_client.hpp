// A client of which nothing good is expected: it sends what a trace says (trace.hpp), when it says so, acknowledges
// what and when it likes, and comes and goes. At its end of the connection a real stream session, in the register and the
// resume store like a real one; what the session must keep to with anybody is checked where it comes out.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/view/view.hpp"
#include "server/stream/session.hpp"
#include "tests/simulation/simulated_server.hpp"

namespace scancast::simulation {

/// What all sessions of a simulated server share; outlives them.
struct Shared {
    SimulatedServer& server;
    VirtualTime& time;
    const StreamWorld& world;
    Metrics& metrics;
    SessionRegister& sessions;
    ResumeStore& resumable;
};

/// One connection. As server/net/session_host.hpp: whatever comes from elsewhere is posted, and void when the session has
/// ended by then.
class TracedClient final : public StreamPort,
                           public LiveSession,
                           public std::enable_shared_from_this<TracedClient> {
  public:
    /// `number`: of no other client of this server.
    static std::shared_ptr<TracedClient> connect(int number, const Shared& shared);
    ~TracedClient() override;

    void say(std::string_view message);
    void sayBinary();
    /// Acknowledges all that was sent.
    void acknowledge();
    /// `done`: it said so before.
    void leave(bool done);
    bool gone() const { return !session_; }
    /// What it has been told; empty before.
    const std::string& sessionId() const { return id_; }
    const std::string& token() const { return token_; }
    std::uint64_t lastFrame() const { return lastFrame_.value_or(0); }

    void changeView(messages::ViewChange change, Changed done) override;
    void lookAround() override;

    void sendText(std::string text) override;
    void sendFrame(const FrameHeader& header, std::shared_ptr<const Bytes> picture,
                   std::shared_ptr<const Bytes> depth) override;
    void order(std::uint64_t number, PictureOrder order) override;
    bool replaceWaiting(std::uint64_t number, PictureOrder order) override;
    void pick(std::uint64_t seq, std::shared_ptr<const Cloud>, std::shared_ptr<const PlannedView>, double,
              double) override;
    void abandon() override;
    void close(CloseCode code, std::string reason) override;
    std::function<void()> onTaken() override;

  private:
    TracedClient(int number, const Shared& shared);
    template <class Work>
    void inSession(const Work& work);
    template <class Work>
    std::function<void()> later(Work work);
    void keepTime();
    PictureDone doneFor(std::uint64_t number);
    PictureOrder placed(PictureOrder order);
    void mayStillBeTold(const char* what);

    const int number_;
    const Shared shared_;
    Turns::ParticipantId mailbox_ = 0;
    std::unique_ptr<SessionRegistration> registration_;
    std::optional<StreamSession> session_;
    bool closed_ = false;  ///< by the session, which is about to end
    std::string id_, token_;
    std::optional<std::uint64_t> lastFrame_;
    std::uint64_t acked_ = 0;
    Time timer_ = Time::max();
    std::uint64_t places_ = 0;
    std::optional<Camera> camera_;
};

}  // namespace scancast::simulation
