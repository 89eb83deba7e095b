// What a connection does for its stream session, whatever it speaks: a place among the sessions, a mailbox at
// the scheduler, an entry in the register, and the session's own time. WebSocket and MJPEG connections derive
// from it and add how frames travel.
//
// Lives on the strand of its socket, kept alive by the connection's pending operations; what other threads
// ask for is posted to it. Pipeline: connection ↔ **session host** ↔ session, scheduler, register.
#pragma once

#include <utility>  // before Asio: Boost 1.74 forgets it

#include <atomic>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <optional>

#include "server/net/net_context.hpp"
#include "server/stream/catalog_world.hpp"
#include "server/stream/session.hpp"

namespace scancast {

class SessionHost : public Connection,
                    public StreamPort,
                    public LiveSession,
                    public std::enable_shared_from_this<SessionHost> {
  public:
    using Clock = StreamSession::Clock;
    using Executor = boost::asio::steady_timer::executor_type;
    ~SessionHost() override;

    /// Its place among the connections, which it keeps to its end.
    void take(ConnectionRegister::Place place);
    void shutDown() override;
    void sayGoodbye() override { shutDown(); }
    void changeView(messages::ViewChange change, Changed done) override;
    void lookAround() override;
    void moveOn(const messages::Drain& drain) override;

    void order(std::uint64_t number, PictureOrder order) override;
    bool replaceWaiting(std::uint64_t number, PictureOrder order) override;
    void pick(std::uint64_t seq, std::shared_ptr<const Cloud> cloud,
              std::shared_ptr<const PlannedView> planned, double x, double y) override;
    void abandon() override;
    std::function<void()> onTaken() override;

    /// Something that was to be done for the session threw (handler.hpp): its connection closes.
    void fault() noexcept;

  protected:
    /// The context outlives the host; the executor is a strand. The grant is what let the client in: when it ends, so does
    /// the session. `record` is of the request that asks for the stream.
    SessionHost(const Executor& strand, NetContext& context, Grant grant, RequestRecord record);

    /// Takes one of --max-sessions; false, and there is no session, when all are taken. What the options say
    /// of identity, limits and patience is filled in here.
    bool openSession(ClientKind client, SessionOptions options = {});
    /// That this client may know of.
    VisibleClouds clouds() const { return visibleTo(grant_.identity, context_.catalog); }
    StreamSession* session() { return session_ ? &*session_ : nullptr; }
    std::string sessionId() const { return registration_->id(); }
    /// What was written for the session: for its last line in the log.
    void count(std::uint64_t bytes, bool isFrame) {
        record_.bytes += bytes;
        record_.frames += isFrame ? 1 : 0;
    }
    /// Why it ends, for the log; the first reason is the one.
    void endsBecause(std::string_view why) noexcept;
    /// By what its request is known.
    const RequestIds& ids() const { return record_.ids; }
    /// There will be no session, and this was answered: the log's line is that of any request.
    void refused(int status) { record_.status = status; }
    /// After every call into the session: sets the timer for its next tick.
    void keepTime();
    /// The client has gone: nothing is made for it any more, however long its connection takes to end.
    void leave();

    /// Neither gone nor about to close: the session may be told things.
    virtual bool listening() const = 0;
    /// Closes the socket as it is.
    virtual void cut() = 0;
    /// No longer listening().
    virtual void giveUp() noexcept = 0;

    NetContext& context_;

  private:
    ConnectionRegister::Place place_;
    void tell(RequestRecord::Event event) noexcept;
    using Weak = std::weak_ptr<SessionHost>;
    /// Posts `work(session)`, which is not done when the session is over by then.
    template <class Work>
    static void later(const Executor& strand, const Weak& weak, Work work);
    PictureDone doneFor(std::uint64_t number);

    /// Ends the session, if the grant has; else looks again when it will.
    void lookAtGrant();

    Executor strand_;
    const Grant grant_;
    const CatalogWorld world_;
    boost::asio::steady_timer timer_, grantTimer_;
    std::optional<Clock::time_point> armed_;
    RequestRecord record_;
    bool ended_ = false;                                 // and the log knows
    bool counted_ = false;                               // it is one of --max-sessions
    Scheduler::MailboxId mailbox_ = 0;                   // 0 = none
    std::unique_ptr<SessionRegistration> registration_;  // outlives the session
    std::optional<StreamSession> session_;
    std::atomic<bool> willLook_{false};
};

}  // namespace scancast
