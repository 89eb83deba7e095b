// A live session that looks after itself: a thread of its own receives, acknowledges, and connects again when
// the connection is lost; what arrives is told by callbacks. A server that says that it will be gone is left for another one
// at the same address, which goes on with the session, before it goes. The other one is opened on the same thread: while it is, which
// takes two round trips and four seconds at most, nothing of the first one is told, and nothing goes to it.
//
//     client::LiveStream stream(*url, {.cloud = "town"}, {.frame = [&](client::ReceivedFrame frame) {
//     show(frame); }}); stream.show(view);   // from any thread; the latest wins
//
// Its functions may be called from any thread, callbacks included; callbacks run on its thread, one at a
// time, and none after the destructor. Built on Stream.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "client/cpp/backoff.hpp"
#include "client/cpp/stream.hpp"

namespace scancast::client {

/// Any of them may be empty.
struct LiveListener {
    /// It has been acknowledged; who takes long gets fewer frames, two of them old at most.
    std::function<void(ReceivedFrame)> frame;
    std::function<void(const messages::Stats&)> stats;
    std::function<void(const messages::Picked&)> picked;
    std::function<void(const messages::ProblemReport&)> problem;  ///< a message was refused
    /// Connected, at first and again; `resumed` when it is the session from before. Comes without `lost` where one server hands
    /// over to another.
    std::function<void(const messages::Welcome&, bool resumed)> connected;
    /// The connection is gone; the next attempt is made after `wait`.
    std::function<void(const Error&, std::chrono::milliseconds wait)> lost;
    /// The first attempt failed, or trying again would not help. Nothing comes afterwards.
    std::function<void(const Error&)> ended;
};

struct LiveOptions {
    /// Also how long the destructor may wait for a server that does not answer.
    Timeouts timeouts{std::chrono::seconds(5), std::chrono::seconds(10)};
    Credentials credentials;
    Backoff backoff;
    /// After so long without a word the server is asked for one.
    std::chrono::milliseconds silence{15'000};
};

class LiveStream {
  public:
    LiveStream(ServerUrl url, messages::Hello hello, LiveListener listener, LiveOptions options = {});
    ~LiveStream();  ///< says goodbye and waits for the thread; never call it from a callback
    LiveStream(const LiveStream&) = delete;
    LiveStream& operator=(const LiveStream&) = delete;

    /// Asks for a view, of another cloud when one is named; returns the number that its frames will have. One
    /// that has not been sent is replaced, and what was asked for last is asked for again after a loss.
    std::uint64_t show(const View& view, const std::string& cloud = {});
    /// Limits of quality, picks, pings: kept until there is a connection, at most 64; false beyond that.
    bool send(const ClientMessage& message);

  private:
    void run(const std::stop_token& stop);
    Expected<Stream> open(const Timeouts& timeouts);
    Error serve(Stream& stream, const std::stop_token& stop, std::optional<Stream>& next);
    bool moveOn(std::optional<Stream>& next);
    void sayWhatIsSeen();
    Expected<void> sendWaiting(Stream& stream);
    void remember(const messages::QualityLimits& limits);
    Expected<void> handle(Stream& stream, StreamEvent event);
    void attach(Stream* stream);
    bool waitFor(const std::stop_token& stop, std::chrono::milliseconds time);

    const ServerUrl url_;
    const LiveListener listener_;
    const LiveOptions options_;
    messages::Hello hello_;  // the thread's own, as is what follows
    std::string session_;
    bool wasConnected_ = false;
    bool saysView_ = true;                                         // older servers refuse a hello with a view
    std::string cloud_;                                            // that is shown
    messages::ViewChange first_;                                   // what the last welcome said
    std::optional<std::chrono::steady_clock::time_point> moveAt_;  // the server has said that it will be gone
    int moves_ = 0;                                                // that were tried since

    std::mutex mutex_;
    std::condition_variable_any changed_;
    Stream* stream_ = nullptr;  // while there is one to interrupt
    std::uint64_t lastSeq_ = 0;
    std::optional<messages::ViewChange> view_;  // what is to be seen
    bool viewWaits_ = false;                    // it has not been sent over this connection
    std::optional<messages::QualityLimits> quality_;
    std::vector<ClientMessage> waiting_;
    std::jthread thread_;  // last: it uses all of the above
};

}  // namespace scancast::client
