#include "client/cpp/live_stream.hpp"

#include <gtest/gtest.h>

#include <atomic>

#include "tests/unit/client/fake_session.hpp"

namespace scancast::client {
namespace {

using namespace std::chrono_literals;
using test::FakePeer;
using test::FakeServer;

/// What happened, in order, as words; written by the stream's thread and the fake server's.
class Diary {
  public:
    void note(std::string what) {
        const std::lock_guard lock(mutex_);
        entries_.push_back(std::move(what));
        changed_.notify_all();
    }
    /// Waits until somebody has noted this; false when nobody does in a time that only a hang takes.
    bool saw(const std::string& what) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(
            lock, 60s, [&] { return std::find(entries_.begin(), entries_.end(), what) != entries_.end(); });
    }
    std::string all() const {
        const std::lock_guard lock(mutex_);
        std::string text;
        for (const auto& entry : entries_) text += entry + "; ";
        return text;
    }

  private:
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::string> entries_;
};

LiveListener listenerOf(Diary& diary) {
    LiveListener listener;
    listener.frame = [&](const ReceivedFrame& frame) {
        diary.note("frame " + std::to_string(frame.header.seq) + (frame.header.final ? " final" : ""));
    };
    listener.problem = [&](const messages::ProblemReport& report) {
        diary.note("problem " + report.problem.detail);
    };
    listener.connected = [&](const messages::Welcome& welcome, bool resumed) {
        diary.note("connected " + welcome.session + (resumed ? " resumed" : ""));
    };
    listener.lost = [&](const Error&, std::chrono::milliseconds) { diary.note("lost"); };
    listener.ended = [&](const Error& error) { diary.note("ended " + std::string(name(error.code))); };
    return listener;
}

LiveOptions quick() {
    LiveOptions options;
    options.backoff = {1ms, 20ms, 2};
    return options;
}

/// Sessions in turn; the last one again and again.
FakeServer::Script inTurn(std::vector<std::function<void(FakePeer&)>> sessions) {
    FakeServer::Script script;
    script.session = [sessions, next = std::make_shared<std::atomic<std::size_t>>(0)](FakePeer& peer) {
        sessions[std::min((*next)++, sessions.size() - 1)](peer);
    };
    return script;
}

/// Notes every message until the client is gone.
void listen(FakePeer& peer, Diary& diary) {
    for (std::string text; peer.readText(text);) {
        const auto message = parseClientMessage(text);
        if (!message) return diary.note("nonsense " + text);
        if (const auto* view = std::get_if<messages::ViewChange>(&*message))
            diary.note("view " + std::to_string(view->seq) + " width " + view->changes["width"].dump());
        if (const auto* ack = std::get_if<messages::Ack>(&*message))
            diary.note("ack " + std::to_string(ack->frame));
        if (const auto* limits = std::get_if<messages::QualityLimits>(&*message))
            diary.note("quality " + std::to_string(limits->minQuality.value_or(0)));
        if (std::holds_alternative<messages::Ping>(*message)) diary.note("ping");
    }
}

void sendFrame(FakePeer& peer, std::uint64_t id, std::uint64_t seq) {
    FrameHeader header;
    header.frameId = id;
    header.seq = seq;
    header.width = header.height = 8;
    header.still = header.final = true;
    peer.sendBinary(test::frameBytes(header, "picture"));
}

View viewOf(int width) {
    View view;
    view.width = width;
    return view;
}

TEST(LiveStream, FramesComeByThemselvesAndAreAcknowledged) {
    Diary diary;
    const FakeServer fake(inTurn({[&](FakePeer& peer) {
        std::string text;
        if (!test::welcome(peer) || !peer.readText(text)) return;
        sendFrame(peer, 1, 1);
        peer.sendText(printMessage(messages::ProblemReport{1, problemOf(400, "just so")}));
        listen(peer, diary);
    }}));
    LiveStream stream(fake.url(), {}, listenerOf(diary), quick());
    EXPECT_EQ(stream.show(viewOf(100)), 1U);
    EXPECT_TRUE(diary.saw("frame 1 final")) << diary.all();
    EXPECT_TRUE(diary.saw("ack 1")) << diary.all();
    EXPECT_TRUE(diary.saw("problem just so")) << diary.all();
    EXPECT_EQ(stream.show(viewOf(101)), 2U);
    EXPECT_TRUE(diary.saw("view 2 width 101")) << diary.all();
}

TEST(LiveStream, ComesBackWithItsTokenAndAsksAgain) {
    Diary diary;
    const auto session = [&](const char* token, bool stays) {
        return [&diary, token, stays](FakePeer& peer) {
            messages::Hello hello;
            if (!test::welcome(peer, "s1", token, &hello)) return;
            diary.note("hello " + hello.resume);
            if (stays) return listen(peer, diary);
            std::string text;
            while (peer.readText(text) && text.find("\"view\"") == std::string::npos) {
            }  // and hangs up
        };
    };
    const FakeServer fake(inTurn({session("one", false), session("two", false), session("three", true)}));
    LiveStream stream(fake.url(), {}, listenerOf(diary), quick());
    EXPECT_TRUE(stream.send(messages::QualityLimits{{}, {}, {}, 77}));
    stream.show(viewOf(200));
    EXPECT_TRUE(diary.saw("hello ")) << diary.all();
    EXPECT_TRUE(diary.saw("hello one")) << diary.all();
    EXPECT_TRUE(diary.saw("hello two")) << diary.all();
    EXPECT_TRUE(diary.saw("connected s1 resumed")) << diary.all();
    EXPECT_TRUE(diary.saw("quality 77")) << diary.all();
    EXPECT_TRUE(diary.saw("view 1 width 200")) << diary.all();
}

// One server hands over to another: nobody is told of a loss, and until the other one has taken over the first one draws.
TEST(LiveStream, MovesToAnotherServerBeforeTheFirstOneIsGone) {
    Diary diary;
    std::atomic<bool> taken = false;
    FakeServer::Script script = inTurn(
        {[&](FakePeer& peer) {
             std::string text;
             if (!test::welcome(peer, "s1", "t1") || !peer.readText(text)) return;
             sendFrame(peer, 1, 1);
             peer.sendText(printMessage(messages::Drain{1, 60'000}));
             while (!taken && peer.readText(text)) {
             }
             while (peer.readText(text)) {
             }
             diary.note("first is over " + std::to_string(peer.closeCode()));
         },
         [&](FakePeer& peer) {
             std::string text;
             if (!peer.readText(text)) return;
             // It refuses at first: the client stays where it is, and tries again.
             peer.sendText(printMessage(messages::ProblemReport{{}, problemOf(503, "not yet")}));
         },
         [&](FakePeer& peer) {
             messages::Hello hello;
             if (!test::welcome(peer, "s1", "t2", &hello)) return;
             diary.note("hello " + hello.resume + " of " + hello.cloud + " seq " + std::to_string(hello.seq) +
                        " frame " + std::to_string(hello.frame) + " width " + hello.view["width"].dump());
             taken = true;
             sendFrame(peer, 2, 1);
             listen(peer, diary);
         }});
    script.atOnce = true;
    const FakeServer fake(script);
    LiveStream stream(fake.url(), {}, listenerOf(diary), quick());
    stream.show(viewOf(100));
    EXPECT_TRUE(diary.saw("hello t1 of town seq 1 frame 1 width 100")) << diary.all();
    EXPECT_TRUE(diary.saw("connected s1 resumed")) << diary.all();
    EXPECT_TRUE(diary.saw("first is over 1000")) << diary.all();
    stream.show(viewOf(101));
    EXPECT_TRUE(diary.saw("view 2 width 101")) << diary.all();
    EXPECT_EQ(diary.all().find("lost"), std::string::npos) << diary.all();
    EXPECT_EQ(diary.all().find("ended"), std::string::npos) << diary.all();
}

// It knows no view in a hello, and refuses the whole: then what is to be seen is said afterwards, as ever.
TEST(LiveStream, AnOlderServerIsToldTheViewAfterwards) {
    Diary diary;
    const FakeServer fake(
        inTurn({[&](FakePeer& peer) {
                    std::string text;
                    if (test::welcome(peer, "s1", "t1")) peer.readText(text);
                },
                [&](FakePeer& peer) {
                    std::string text;
                    if (!peer.readText(text)) return;
                    Error error{ErrorCode::InvalidArgument, "view: unknown", "view"};
                    peer.sendText(printMessage(messages::ProblemReport{{}, problemOf(error)}));
                },
                [&](FakePeer& peer) {
                    messages::Hello hello;
                    if (!test::welcome(peer, "s1", "t2", &hello)) return;
                    diary.note("hello " + hello.resume + " " + hello.view.dump());
                    listen(peer, diary);
                }}));
    LiveStream stream(fake.url(), {}, listenerOf(diary), quick());
    stream.show(viewOf(100));
    EXPECT_TRUE(diary.saw("hello t1 null")) << diary.all();
    EXPECT_TRUE(diary.saw("view 1 width 100")) << diary.all();
}

// It knows such hellos; only the view itself is nothing for it, now.
TEST(LiveStream, AViewThatIsRefusedIsSaidAgainTheNextTime) {
    Diary diary;
    const auto session = [&](bool stays) {
        return [&diary, stays](FakePeer& peer) {
            messages::Hello hello;
            if (!test::welcome(peer, "s1", "t", &hello)) return;
            diary.note(stays ? "last " + hello.view["width"].dump() : "hello " + hello.view.dump());
            std::string text;
            peer.readText(text);
            if (stays) listen(peer, diary);
        };
    };
    const auto refuses = [](FakePeer& peer) {
        std::string text;
        if (!peer.readText(text)) return;
        Error error{ErrorCode::InvalidArgument, "param.gain: not with this cloud", "param.gain"};
        peer.sendText(printMessage(messages::ProblemReport{{}, problemOf(error)}));
    };
    const FakeServer fake(inTurn({session(false), refuses, session(false), session(true)}));
    LiveStream stream(fake.url(), {}, listenerOf(diary), quick());
    stream.show(viewOf(100));
    EXPECT_TRUE(diary.saw("hello null")) << diary.all();
    EXPECT_TRUE(diary.saw("last 100")) << diary.all();
}

TEST(LiveStream, AnotherSessionIsNoResumedOne) {
    Diary diary;
    const FakeServer fake(inTurn({[](FakePeer& peer) { test::welcome(peer, "s1"); },
                                  [&](FakePeer& peer) {
                                      if (test::welcome(peer, "s2")) listen(peer, diary);
                                  }}));
    LiveStream stream(fake.url(), {}, listenerOf(diary), quick());
    EXPECT_TRUE(diary.saw("connected s1")) << diary.all();
    EXPECT_TRUE(diary.saw("lost")) << diary.all();
    EXPECT_TRUE(diary.saw("connected s2")) << diary.all();
}

TEST(LiveStream, WhatIsAskedForMeanwhileIsAskedForOnceTheLatestWins) {
    Diary diary;
    const FakeServer fake(inTurn({[&](FakePeer& peer) {
        diary.saw("asked");  // until then the client has no connection
        if (test::welcome(peer)) listen(peer, diary);
    }}));
    LiveStream stream(fake.url(), {}, listenerOf(diary), quick());
    for (int width = 1; width <= 50; ++width) stream.show(viewOf(width));
    diary.note("asked");
    EXPECT_TRUE(diary.saw("view 50 width 50")) << diary.all();
    EXPECT_EQ(diary.all().find("view 49"), std::string::npos) << diary.all();
}

TEST(LiveStream, TheFirstFailureIsTheEnd) {
    Diary diary;
    const LiveStream stream(test::nobodysUrl(), {}, listenerOf(diary), quick());
    EXPECT_TRUE(diary.saw("ended io")) << diary.all();
    EXPECT_EQ(diary.all().find("lost"), std::string::npos) << diary.all();
}

TEST(LiveStream, WhatWouldFailAgainIsTheEnd) {
    Diary diary;
    const FakeServer fake(inTurn({[](FakePeer& peer) { test::welcome(peer); },
                                  [](FakePeer& peer) {
                                      std::string text;
                                      peer.readText(text);
                                      peer.sendText("no message");
                                  }}));
    const LiveStream stream(fake.url(), {}, listenerOf(diary), quick());
    EXPECT_TRUE(diary.saw("lost")) << diary.all();
    EXPECT_TRUE(diary.saw("ended malformed")) << diary.all();
}

TEST(LiveStream, ASilentServerIsAskedForAWord) {
    Diary diary;
    const FakeServer fake(inTurn({[&](FakePeer& peer) {
        if (test::welcome(peer)) listen(peer, diary);
    }}));
    auto options = quick();
    options.silence = 20ms;
    const LiveStream stream(fake.url(), {}, listenerOf(diary), options);
    EXPECT_TRUE(diary.saw("ping")) << diary.all();
}

TEST(LiveStream, ASilentServerIsLeft) {
    Diary diary;
    const FakeServer fake(inTurn({[](FakePeer& peer) {
        test::welcome(peer);
        for (std::string text; peer.readText(text);) {
        }
    }}));
    auto options = quick();
    options.silence = 20ms;
    options.timeouts.answer = 4s;
    const LiveStream stream(fake.url(), {}, listenerOf(diary), options);
    EXPECT_TRUE(diary.saw("lost")) << diary.all();
}

TEST(LiveStream, EndsWhileItWaitsToTryAgain) {
    Diary diary;
    const FakeServer fake(inTurn({[](FakePeer& peer) { test::welcome(peer); }}));
    auto options = quick();
    options.backoff = {24h, 24h, 1};
    const LiveStream stream(fake.url(), {}, listenerOf(diary), options);
    EXPECT_TRUE(diary.saw("lost")) << diary.all();
}

TEST(LiveStream, WhatWaitsHasABound) {
    Diary diary;
    const FakeServer fake(inTurn({[&](FakePeer&) { diary.saw("full"); }}));
    LiveStream stream(fake.url(), {}, listenerOf(diary), quick());
    for (int i = 0; i < 64; ++i) EXPECT_TRUE(stream.send(messages::Ping{}));
    EXPECT_FALSE(stream.send(messages::Ping{}));
    diary.note("full");
}

TEST(Backoff, GrowsToItsBoundAndSpreads) {
    const Backoff backoff{100ms, 1000ms, 2};
    EXPECT_EQ(backoff.delay(0, 0), 100ms);
    EXPECT_EQ(backoff.delay(2, 0), 400ms);
    EXPECT_EQ(backoff.delay(50, 0), 1000ms);
    EXPECT_EQ(backoff.delay(100000, 0), 1000ms);
    EXPECT_EQ(backoff.delay(0, 0.5), 75ms);
}

}  // namespace
}  // namespace scancast::client
