#include "tests/unit/server/stream/session_fixture.hpp"

namespace scancast::test {
namespace {

TEST_F(SessionTest, HelloIsAnsweredByWelcomeWithTheDefaultView) {
    hello();
    ASSERT_EQ(port.texts.size(), 1U);
    const json& welcome = port.texts[0];
    EXPECT_EQ(welcome["type"], "welcome");
    EXPECT_EQ(welcome["session"], "s1");
    EXPECT_EQ(welcome["cloud"], "first");
    EXPECT_EQ(welcome["view"]["width"], 640);
    EXPECT_EQ(welcome["limits"]["maxPixels"], 4'000'000);
}

TEST_F(SessionTest, WithoutAViewTheWelcomesViewIsShownAsAStill) {
    hello();
    EXPECT_TRUE(port.orders.empty());
    pass(150);
    ASSERT_EQ(port.orders.size(), 1U);
    EXPECT_TRUE(order(0).interruptible);
    finish(0);
    ASSERT_EQ(port.frames.size(), 1U);
    EXPECT_TRUE(port.frames[0].final);
    EXPECT_EQ(port.frames[0].seq, 0U);
    EXPECT_EQ(port.frames[0].frameId, 1U);
}

TEST_F(SessionTest, AViewIsShownMovingAndAfterAPauseAsFinalStill) {
    greet();
    view(7, 20);
    ASSERT_EQ(port.orders.size(), 1U);
    EXPECT_EQ(order(0).view.quality.samples, 1);
    EXPECT_FALSE(order(0).interruptible);
    finish(0);
    ASSERT_EQ(port.frames.size(), 1U);
    EXPECT_TRUE(port.frames[0].moving);
    EXPECT_FALSE(port.frames[0].final);
    EXPECT_EQ(port.frames[0].seq, 7U);
    pass(149);
    EXPECT_EQ(port.orders.size(), 1U);
    pass(1);
    ASSERT_EQ(port.orders.size(), 2U);
    // The still is the view itself: what a snapshot of the same words would render.
    EXPECT_EQ(order(1).view.quality, Quality{});
    EXPECT_EQ(order(1).view.camera.eye.x, 20);
    EXPECT_TRUE(order(1).interruptible);
    finish(1);
    ASSERT_EQ(port.frames.size(), 2U);
    EXPECT_FALSE(port.frames[1].moving);
    EXPECT_TRUE(port.frames[1].final);
    EXPECT_EQ(port.frames[1].seq, 7U);
}

TEST_F(SessionTest, EveryFrameHasDepthWhereHelloAsksForItAndNoneElsewhere) {
    say({{"type", "hello"}, {"width", 640}, {"height", 480}, {"depth", true}});
    view(1, 5);
    finish(0);
    ack(1);
    pass(150);
    finish(1);
    ASSERT_EQ(port.frames.size(), 2U);
    EXPECT_TRUE(port.frames[0].moving);
    EXPECT_TRUE(port.frames[1].final);
    for (const auto& depth : port.depths) {
        ASSERT_TRUE(depth);
        EXPECT_EQ(*depth, (Bytes{4, 5}));
    }
    EXPECT_EQ(port.frames[0].pictureLength, 3U) << "depth is not of the picture";
}

TEST_F(SessionTest, WithoutHellosWordNoOrderIsWithDepth) {
    greet();
    view(1, 5);
    EXPECT_FALSE(order(0).withDepth);
    finish(0);
    EXPECT_EQ(port.depths.at(0), nullptr);
}

TEST_F(SessionTest, AfterFinalNothingIsSentUntilSomethingChanges) {
    greet();
    view(1, 20);
    finish(0);
    ack(2);
    pass(150);
    finish(1);
    ack(3);
    for (int i = 0; i < 100; ++i) pass(1000);
    EXPECT_EQ(port.orders.size(), 2U);
    EXPECT_EQ(port.frames.size(), 2U);
    EXPECT_FALSE(session->wakeAt());
    view(2, 21);
    EXPECT_EQ(port.orders.size(), 3U);
}

TEST_F(SessionTest, AtMostTwoFramesAreUnacknowledgedAndTheLatestViewWins) {
    greet();
    for (std::uint64_t seq = 1; seq <= 50; ++seq) {
        view(seq, double(seq));
        for (std::size_t n = port.frames.size(); n < port.orders.size(); ++n) finish(n);
    }
    EXPECT_EQ(port.frames.size(), 2U);
    EXPECT_EQ(port.orders.size(), 2U);
    ack(port.frames[0].frameId);
    ASSERT_EQ(port.orders.size(), 3U);
    EXPECT_EQ(order(2).view.camera.eye.x, 50);  // 3 … 49 were overwritten
    finish(2);
    EXPECT_EQ(port.frames.back().seq, 50U);
}

/// 60 views a second, 30 frames wanted: every second view is drawn the moment that it comes.
TEST_F(SessionTest, FramesAreBegunAsOftenAsWantedOfAViewThatHasJustCome) {
    greet();
    std::uint64_t frame = 1;
    for (std::uint64_t seq = 1; seq <= 60; ++seq) {
        now += std::chrono::microseconds(16'667 - 34'000);
        view(seq, double(seq));
        if (port.orders.size() == port.frames.size()) continue;
        EXPECT_EQ(order(port.orders.size() - 1).view.camera.eye.x, double(seq));
        finish(port.orders.size() - 1);
        ack(++frame);
    }
    EXPECT_EQ(port.frames.size(), 30U);
}

/// A view that comes too early to be drawn, and is the last one, is drawn all the same, and in time.
TEST_F(SessionTest, AViewThatCameTooEarlyIsDrawnWhenTheNextOneShouldHaveCome) {
    greet();
    view(1, 1);
    finish(0);
    ack(2);
    now += milliseconds(5 - 34);
    view(2, 2);
    EXPECT_EQ(port.orders.size(), 1U);
    ASSERT_TRUE(session->wakeAt());
    EXPECT_LE(*session->wakeAt(), now + milliseconds(33));
    now = *session->wakeAt();
    session->tick(now);
    ASSERT_EQ(port.orders.size(), 2U);
    EXPECT_EQ(order(1).view.camera.eye.x, 2);
}

/// One frame is always on its way; now and then the link must be quiet until that one has come. Whoever calls
/// at wakeAt() must then not be called again and again in the meantime.
TEST_F(SessionTest, IsNeverToBeWokenForNothing) {
    greet();
    std::uint64_t acked = 1;
    int held = 0;
    for (std::uint64_t seq = 1; seq <= 400; ++seq) {
        view(seq, double(seq));
        const bool begun = port.orders.size() > port.frames.size();
        held += begun ? 0 : 1;
        if (begun) finish(port.orders.size() - 1);
        session->tick(now);
        if (session->wakeAt()) {
            EXPECT_GT(*session->wakeAt(), now) << "view " << seq;
        }
        now += milliseconds(20);
        session->tick(now);
        if (session->wakeAt()) {
            EXPECT_GT(*session->wakeAt(), now) << "after view " << seq;
        }
        const std::uint64_t newest = port.frames.back().frameId;
        if (!begun) ack(acked = newest);
        if (newest > acked + 1) ack(++acked);
    }
    EXPECT_GT(held, 0) << "the link was never to be quiet: this proves nothing";
}

TEST_F(SessionTest, AWaitingOrderIsReplacedByTheNewerView) {
    greet();
    view(1, 1);
    view(2, 2);
    ASSERT_EQ(port.orders.size(), 2U);
    port.canReplace = true;
    view(3, 3);
    EXPECT_EQ(port.replaced, 1);
    ASSERT_EQ(port.orders.size(), 3U);
    // The scheduler says of the replaced one that it was cancelled; that must not count as its replacement's
    // end.
    session->pictureDone(port.orders[1].number, fail(ErrorCode::Cancelled, "replaced"), now);
    finish(0);
    finish(2);
    ASSERT_EQ(port.frames.size(), 2U);
    EXPECT_EQ(port.frames[0].seq, 1U);
    EXPECT_EQ(port.frames[1].seq, 3U);
}

TEST_F(SessionTest, ANewViewInterruptsTheStill) {
    greet();
    view(1, 1);
    finish(0);
    ack(2);
    pass(150);
    ASSERT_EQ(port.orders.size(), 2U);
    const int before = port.abandoned;
    view(2, 2);
    EXPECT_EQ(port.abandoned, before + 1);
    ASSERT_EQ(port.orders.size(), 3U);  // the interrupted still holds no place
    EXPECT_FALSE(order(2).interruptible);
    finish(1);  // it was too late to stop: what it shows is old, and not sent
    EXPECT_EQ(port.frames.size(), 1U);
}

TEST_F(SessionTest, TheFinalStillIsNeverDropped) {
    greet();
    view(1, 1);
    view(2, 2);
    finish(0);
    finish(1);
    pass(10'000);  // the client takes its time
    EXPECT_EQ(port.orders.size(), 2U);
    EXPECT_FALSE(session->wakeAt());  // nothing to do but wait for it
    ack(port.frames[0].frameId);
    ASSERT_EQ(port.orders.size(), 3U);
    EXPECT_TRUE(order(2).interruptible);
    finish(2);
    EXPECT_TRUE(port.frames.back().final);
    EXPECT_EQ(port.frames.back().seq, 2U);
}

TEST_F(SessionTest, SlowFramesLowerMovingQualityButNotTheStill) {
    greet();
    view(1, 1);
    finish(0, 400);
    ack(2);
    view(2, 2);
    ASSERT_EQ(port.orders.size(), 2U);
    EXPECT_GT(*order(1).view.quality.detail, 1);
    EXPECT_LT(order(1).view.width, 640);
    EXPECT_GE(order(1).view.width, 320);
    finish(1, 400);
    ack(3);
    pass(150);
    ASSERT_EQ(port.orders.size(), 3U);
    EXPECT_EQ(order(2).view.width, 640);
    EXPECT_EQ(order(2).view.quality, Quality{});
}

TEST_F(SessionTest, SizeAndCloudAreSwitchedByView) {
    greet();
    say({{"type", "view"}, {"seq", 1}, {"width", 300}, {"height", 200}});
    EXPECT_EQ(order(0).view.width, 300);
    EXPECT_EQ(order(0).cloud, world.first);
    finish(0);
    ack(2);
    pass(40);
    say({{"type", "view"}, {"seq", 2}, {"cloud", "second"}, {"method", "cone"}});
    ASSERT_EQ(port.orders.size(), 2U);
    EXPECT_EQ(order(1).cloud, world.second);
    EXPECT_EQ(order(1).view.width, 300);
    EXPECT_EQ(order(1).view.style.method, "cone");
}

// Every refusal leaves a problem, no order, and the state as it was: shown by the next good view.
TEST_F(SessionTest, RefusedMessagesLeaveTheStateAsItWas) {
    greet();
    const std::vector<json> bad{
        {{"type", "view"}, {"seq", 1}, {"camera", {{"fvo", 50}}}},
        {{"type", "view"}, {"seq", 1}, {"camera", {{"fov", 500}}}},
        {{"type", "view"}, {"seq", 1}, {"width", 300}, {"typo", true}},
        {{"type", "view"}, {"seq", 1}, {"camera", {{"eye", {1, 1, 1}}, {"target", {1, 1, 1}}}}},
        {{"type", "view"}, {"seq", 1}, {"width", 16000}, {"height", 16000}},
        {{"type", "view"}, {"seq", 1}, {"method", "nonsense"}},
        {{"type", "view"}, {"seq", 1}, {"cloud", "third"}},
        {{"type", "view"}, {"seq", 1}, {"cloud", "second"}, {"typo", 1}},
        {{"type", "hello"}},
        {{"type", "dance"}},
        {{"type", "pick"}, {"seq", 1}, {"x", 1}},
    };
    for (const json& message : bad) {
        port.texts.clear();
        say(message);
        ASSERT_EQ(port.texts.size(), 1U) << message;
        EXPECT_EQ(port.texts[0]["type"], "problem") << message;
        EXPECT_TRUE(port.orders.empty()) << message;
        EXPECT_FALSE(port.closed) << message;
    }
    say({{"type", "view"}, {"seq", 2}});
    ASSERT_EQ(port.orders.size(), 1U);
    View expected = defaultView(*world.first, 640, 480);
    expected.quality.samples = 1;
    expected.quality.detail = 1;
    EXPECT_EQ(order(0).view, expected);
}

TEST_F(SessionTest, PicksAreAnsweredOneByOneAndOnlySoManyAtOnce) {
    greet();
    for (int seq = 1; seq <= 5; ++seq) say({{"type", "pick"}, {"seq", seq}, {"x", 10}, {"y", 20}});
    ASSERT_EQ(port.picks.size(), 4U);
    EXPECT_EQ(port.picks[0], std::tuple(1U, 10.0, 20.0));
    ASSERT_EQ(port.texts.size(), 1U);
    EXPECT_EQ(port.texts[0]["problem"]["status"], 429);
    EXPECT_EQ(port.texts[0]["seq"], 5);
    session->pickDone(1, json{{"position", {1, 2, 3}}});
    session->pickDone(2, json());
    session->pickDone(3, fail(ErrorCode::InvalidArgument, "x: outside", "x"));
    EXPECT_EQ(port.texts[1], json({{"type", "picked"}, {"seq", 1}, {"point", {{"position", {1, 2, 3}}}}}));
    EXPECT_EQ(port.texts[2], json({{"type", "picked"}, {"seq", 2}, {"point", nullptr}}));
    EXPECT_EQ(port.texts[3]["problem"]["status"], 400);
    say({{"type", "pick"}, {"seq", 6}, {"x", 10}, {"y", 20}});
    EXPECT_EQ(port.picks.size(), 5U);
}

TEST_F(SessionTest, TooManyPixelsIs413) {
    greet();
    say({{"type", "view"}, {"seq", 4}, {"width", 16000}, {"height", 16000}});
    EXPECT_EQ(port.texts.at(0)["problem"]["status"], 413);
    EXPECT_EQ(port.texts.at(0)["seq"], 4);
}

TEST_F(SessionTest, ARefusedHelloMayBeSaidAgain) {
    say({{"type", "hello"}, {"cloud", "third"}});
    EXPECT_EQ(port.texts.at(0)["type"], "problem");
    say({{"type", "hello"}, {"colour", "red"}});
    EXPECT_EQ(port.texts.at(1)["type"], "problem");
    hello();
    EXPECT_EQ(port.texts.at(2)["type"], "welcome");
}

TEST_F(SessionTest, CloseCodes) {
    session->text("{no json", now);
    EXPECT_EQ(port.closed, CloseCode::InvalidPayload);
    EXPECT_EQ(port.texts.back()["type"], "bye");
}

TEST_F(SessionTest, TheFirstMessageMustBeHello) {
    view(1, 1);
    EXPECT_EQ(port.closed, CloseCode::UnsupportedData);
}

TEST_F(SessionTest, BinaryMessagesAreNotUnderstood) {
    greet();
    session->binary();
    EXPECT_EQ(port.closed, CloseCode::UnsupportedData);
}

TEST_F(SessionTest, AcknowledgingWhatWasNeverSentIsAgainstTheRules) {
    greet();
    ack(2);
    EXPECT_EQ(port.closed, CloseCode::PolicyViolation);
}

TEST_F(SessionTest, WhoSaysNothingIsSentAway) {
    EXPECT_EQ(session->wakeAt(), now + milliseconds(10000));
    pass(10000);
    EXPECT_EQ(port.closed, CloseCode::PolicyViolation);
}

TEST_F(SessionTest, ShutdownSaysByeAndDropsEverything) {
    greet();
    view(1, 1);
    session->goAway();
    EXPECT_EQ(port.closed, CloseCode::GoingAway);
    EXPECT_EQ(port.texts.back()["code"], 1001);
    finish(0);
    view(2, 2);
    pass(1000);
    EXPECT_TRUE(port.frames.empty());
    EXPECT_EQ(port.orders.size(), 1U);
}

TEST_F(SessionTest, AFailedPictureIsReportedWithItsSeqAndTheSessionGoesOn) {
    greet();
    view(5, 1);
    session->pictureDone(port.orders[0].number, fail(ErrorCode::DeviceLost, "gone"), now);
    ASSERT_EQ(port.texts.size(), 1U);
    EXPECT_EQ(port.texts[0]["problem"]["status"], 503);
    EXPECT_EQ(port.texts[0]["seq"], 5);
    view(6, 2);
    EXPECT_EQ(port.orders.size(), 2U);
}

TEST_F(SessionTest, PingIsAnsweredAndStatsComeAtMostOnceASecond) {
    greet();
    say({{"type", "ping"}, {"id", 42}});
    EXPECT_EQ(port.texts.at(0), (json{{"type", "pong"}, {"id", 42}}));
    port.texts.clear();
    std::uint64_t frame = 1;
    for (std::uint64_t seq = 1; seq <= 30; ++seq) {
        now += milliseconds(100);
        view(seq, double(seq));
        finish(seq - 1);
        ack(++frame);
    }
    int stats = 0;
    for (const json& text : port.texts) stats += text["type"] == "stats" ? 1 : 0;
    EXPECT_GE(stats, 2);
    EXPECT_LE(stats, 4);
}

TEST_F(SessionTest, EachFinalStillHasItsStats) {
    greet();
    for (std::uint64_t seq = 1; seq <= 3; ++seq) {
        view(seq, double(seq));
        finish(port.orders.size() - 1);
        ack(port.frames.back().frameId);
        pass(200);  // quiet
        port.texts.clear();
        finish(port.orders.size() - 1);
        ASSERT_TRUE(port.frames.back().final);
        ASSERT_EQ(port.texts.size(), 1U);
        EXPECT_EQ(port.texts[0]["type"], "stats");
        EXPECT_EQ(port.texts[0]["seq"], seq);
        EXPECT_EQ(port.texts[0]["frame"], port.frames.back().frameId);
        ack(port.frames.back().frameId);
    }
}

// What the renderer says of its frame (render_test.cpp: a reason exactly where the view leaves the method open) is told as it is.
TEST_F(SessionTest, StatsSayTheMethodAndWhyWhereNobodyNamedIt) {
    greet();
    std::uint64_t frame = 1;
    const auto statsOf = [&](std::uint64_t seq, FrameStats of) {
        port.texts.clear();
        pass(1100);
        view(seq, double(seq));
        finish(port.orders.size() - 1, 1, std::move(of));
        ack(++frame);
        for (const json& text : port.texts)
            if (text["type"] == "stats") return text;
        return json::object();
    };
    FrameStats chosen, named;
    chosen.method = "disc";
    chosen.methodReason = "it has normals";
    named.method = "cone";
    chosen.color = "elevation";
    chosen.colormap = "turbo";
    chosen.colorRange = {31.5, 60};
    const json open = statsOf(1, chosen);
    EXPECT_EQ(open.value("method", ""), "disc");
    EXPECT_EQ(open.value("methodReason", ""), "it has normals");
    EXPECT_EQ(open.value("color", ""), "elevation");
    EXPECT_EQ(open.value("colormap", ""), "turbo");
    EXPECT_EQ(open.value("range", json()), (json{31.5, 60.0}));
    const json fixed = statsOf(2, named);
    EXPECT_EQ(fixed.value("method", ""), "cone");
    EXPECT_EQ(fixed.value("methodReason", "?"), "") << "nobody left it open";
    EXPECT_TRUE(fixed.at("range").is_null()) << "no ramp";
}

TEST_F(SessionTest, QualityMessageMovesTheLimits) {
    greet();
    say({{"type", "quality"}, {"minResolution", 1.0}, {"maxDetail", 8}});
    view(1, 1);
    finish(0, 5000);
    ack(2);
    view(2, 2);
    EXPECT_EQ(order(1).view.width, 640);
    EXPECT_GT(*order(1).view.quality.detail, 2);
}

// A frame of a live cloud is shown as a new view is, at once and as a moving frame; stills come when none follows.
TEST_F(SessionTest, EachFrameOfALiveCloudIsShownAtOnce) {
    world.isLive = true;
    hello();
    ASSERT_EQ(port.orders.size(), 0U);
    pass(200);
    finish(0);  // the still of the welcome's view
    ack(1);
    for (std::uint64_t n = 1; n <= 5; ++n) {
        now += milliseconds(50);
        world.first = tinyCloud(n + 1);
        session->lookAround(now);
        ASSERT_EQ(port.orders.size(), 1 + n);
        EXPECT_EQ(order(n).cloud, world.first);
        EXPECT_FALSE(order(n).complete);
        finish(n);
        EXPECT_TRUE(port.frames.back().moving);
        ack(1 + n);
    }
    pass(200);
    ASSERT_EQ(port.orders.size(), 7U);
    EXPECT_TRUE(order(6).complete) << "the last one stands";
    EXPECT_EQ(order(6).cloud, world.first);
}

}  // namespace
}  // namespace scancast::test
