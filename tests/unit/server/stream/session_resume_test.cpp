// A session that goes on over another connection, in a time that the test makes.
#include "tests/unit/server/stream/session_fixture.hpp"

namespace scancast::test {
namespace {

class ResumedSession : public SessionTest {
  protected:
    ResumedSession() { connect(); }

    /// Another connection, which would be session s2.
    void connect() {
        SessionOptions options;
        options.id = "s" + std::to_string(++connections);
        options.maxPixels = 4'000'000;
        options.resumable = &store;
        port = {};
        session.emplace(options, world, port, metrics, now);
    }
    /// Moved, narrowed and told its limits; then the line breaks. Returns its token.
    std::string loseASession() {
        hello();
        const std::string token = port.texts.at(0)["resume"];
        say({{"type", "quality"}, {"fps", 40}, {"maxDetail", 8}, {"minResolution", 1.0}});
        say({{"type", "view"}, {"seq", 7}, {"cloud", "second"}, {"width", 300}, {"method", "cone"}});
        finish(0);
        pass(150);
        finish(1);
        session->connectionLost(false, now);
        return token;
    }
    json helloAgain(const std::string& token) {
        say({{"type", "hello"}, {"resume", token}, {"cloud", "first"}});
        return port.texts.at(0);
    }

    ResumeStore store;
    int connections = 0;
};

TEST_F(ResumedSession, GoesOnWithItsIdCloudViewLimitsAndNumbers) {
    const std::string token = loseASession();
    connect();
    now += std::chrono::seconds(59);
    const json welcome = helloAgain(token);
    EXPECT_EQ(welcome["resumed"], true);
    EXPECT_EQ(welcome["session"], "s1");
    EXPECT_EQ(welcome["cloud"], "second");
    EXPECT_EQ(welcome["seq"], 7);
    EXPECT_EQ(welcome["view"]["width"], 300);
    EXPECT_EQ(welcome["view"]["method"], "cone");
    EXPECT_NE(welcome["resume"], token);
    EXPECT_EQ(session->id(), "s1");
    pass(150);
    ASSERT_EQ(port.orders.size(), 1U) << "what was on screen is shown again, sharp";
    EXPECT_EQ(order(0).cloud, world.second);
    finish(0);
    EXPECT_TRUE(port.frames.at(0).final);
    EXPECT_EQ(port.frames[0].seq, 7U);
    EXPECT_EQ(port.frames[0].frameId, 3U) << "numbers go on";
    ack(3);
    EXPECT_FALSE(port.closed);
    view(8, 1);
    finish(1, 5000);
    ack(4);
    view(9, 2);
    EXPECT_EQ(order(2).view.width, 300) << "minResolution 1 holds still";
    EXPECT_GT(*order(2).view.quality.detail, 2) << "and so does maxDetail 8";
}

TEST_F(ResumedSession, DepthIsTheConnectionsAndSaidAgain) {
    for (const bool again : {true, false}) {
        say({{"type", "hello"}, {"depth", true}});
        const std::string token = port.texts.at(0)["resume"];
        session->connectionLost(false, now);
        connect();
        json hello = {{"type", "hello"}, {"resume", token}};
        if (again) hello["depth"] = true;
        say(hello);
        EXPECT_EQ(port.texts.at(0)["resumed"], true);
        pass(150);
        EXPECT_EQ(order(0).withDepth, again);
        session->connectionLost(true, now);
        connect();
    }
}

TEST_F(ResumedSession, WhoeverHasAFrameAndComesBackAtOnceIsNotSentItsNumberAgain) {
    hello();
    const std::string token = port.texts.at(0)["resume"];
    std::optional<SavedSession> saved;
    port.onFrame = [&](const FrameHeader& sent) {
        EXPECT_EQ(sent.frameId, 1U);
        saved = store.resume(token, "", now)
                    ->saved;  // by another connection, before this one has done anything more
    };
    view(7, 1);
    finish(0);
    ASSERT_TRUE(saved);
    EXPECT_EQ(saved->lastFrame, 1U);
}

TEST_F(ResumedSession, FramesThatWereUnderWayHoldNoPlaceInTheWindow) {
    const std::string token = loseASession();  // two frames, neither acknowledged
    connect();
    helloAgain(token);
    view(8, 1);
    view(9, 2);
    EXPECT_EQ(port.orders.size(), 2U);
}

TEST_F(ResumedSession, TooLateOrUnknownIsANewSessionAndSaidSo) {
    const std::string token = loseASession();
    now += std::chrono::seconds(61);
    connect();
    const json late = helloAgain(token);
    EXPECT_EQ(late["resumed"], false);
    EXPECT_EQ(late["session"], "s2");
    EXPECT_EQ(late["cloud"], "first");
    EXPECT_EQ(late["seq"], 0);
    EXPECT_NE(late["resume"], "");
    connect();
    const json unknown = helloAgain("no such token");
    EXPECT_EQ(unknown["resumed"], false);
    EXPECT_EQ(unknown["session"], "s3");
}

TEST_F(ResumedSession, ATokenIsGoodOnce) {
    const std::string token = loseASession();
    connect();
    EXPECT_EQ(helloAgain(token)["resumed"], true);
    connect();
    EXPECT_EQ(helloAgain(token)["resumed"], false);
}

TEST_F(ResumedSession, CanBeLostAgainAndAgain) {
    std::string token = loseASession();
    for (int i = 0; i < 3; ++i) {
        connect();
        const json welcome = helloAgain(token);
        EXPECT_EQ(welcome["session"], "s1");
        EXPECT_EQ(welcome["view"]["width"], 300);
        token = welcome["resume"];
        session->connectionLost(false, now);
    }
}

TEST_F(ResumedSession, WhoSaidGoodbyeOrBrokeTheRulesBeginsAnew) {
    hello();
    std::string token = port.texts.at(0)["resume"];
    session->connectionLost(true, now);
    connect();
    EXPECT_EQ(helloAgain(token)["resumed"], false);
    token = port.texts.at(0)["resume"];
    ack(5);
    EXPECT_EQ(port.closed, CloseCode::PolicyViolation);
    session->connectionLost(false, now);
    connect();
    EXPECT_EQ(helloAgain(token)["resumed"], false);
}

TEST_F(ResumedSession, ACloudThatIsGoneBeginsANewSession) {
    const std::string token = loseASession();
    connect();
    world.second = nullptr;
    EXPECT_EQ(helloAgain(token)["resumed"], false);
    EXPECT_EQ(port.texts[0]["cloud"], "first");
}

TEST_F(ResumedSession, TheConnectionThatLostItsSessionIsClosed) {
    hello();
    const std::string token = port.texts.at(0)["resume"];
    EXPECT_TRUE(store.resume(token, "", now));
    EXPECT_EQ(port.takenOver, 1);
    session->taken();
    EXPECT_EQ(port.closed, CloseCode::PolicyViolation);
    EXPECT_EQ(port.texts.back()["type"], "bye");
}

// On a server that has never heard of the session.
class SessionFromElsewhere : public ResumedSession {
  protected:
    SessionFromElsewhere() {
        store.setKeys({"shared"});
        other.setKeys({"shared"});
    }
    std::string tokenOf(const std::string& owner, std::uint32_t turn = 1) {
        return other.open({"s77", owner, turn})->token;
    }
    /// What a client says that has lost its server.
    static json helloWith(const std::string& token) {
        return {
            {"type", "hello"},
            {"resume", token},
            {"cloud", "second"},
            {"view", {{"width", 300}, {"height", 200}, {"method", "cone"}, {"camera", {{"eye", {5, 6, 7}}}}}},
            {"seq", 41},
            {"frame", 99},
            {"fps", 25}};
    }

    ResumeStore other;
};

TEST_F(SessionFromElsewhere, GoesOnWithWhatTheClientSaw) {
    say(helloWith(tokenOf("")));
    const json welcome = port.texts.at(0);
    EXPECT_EQ(welcome["resumed"], true);
    EXPECT_EQ(welcome["session"], "s77");
    EXPECT_EQ(welcome["cloud"], "second");
    EXPECT_EQ(welcome["seq"], 41);
    EXPECT_EQ(welcome["view"]["width"], 300);
    EXPECT_EQ(welcome["view"]["method"], "cone");
    EXPECT_EQ(welcome["view"]["camera"]["eye"], json({5.0, 6.0, 7.0}));
    pass(150);
    ASSERT_EQ(port.orders.size(), 1U) << "a still at once: nothing moves";
    finish(0);
    EXPECT_EQ(port.frames.at(0).seq, 41U);
    EXPECT_EQ(port.frames.at(0).frameId, 100U) << "numbers go on";
    ack(99);
    EXPECT_FALSE(port.closed);
    // And from here on as if it had always been here.
    const std::string token = welcome["resume"];
    session->connectionLost(false, now);
    connect();
    EXPECT_EQ(helloAgain(token)["session"], "s77");
    EXPECT_EQ(port.texts.at(0)["cloud"], "second");
}

TEST_F(SessionFromElsewhere, WhatCannotBeBelievedIsANewSessionWithThatView) {
    std::string turned = tokenOf("");
    turned[turned.size() / 2] = turned[turned.size() / 2] == 'x' ? 'y' : 'x';
    const std::string past = ResumeStore({.tokenLife = std::chrono::seconds(-1)}).open({"s77", ""})->token;
    for (const std::string& token : {turned, past, tokenOf("another owner"), std::string("nonsense")}) {
        connect();
        say(helloWith(token));
        const json welcome = port.texts.at(0);
        EXPECT_EQ(welcome["resumed"], false) << token;
        EXPECT_NE(welcome["session"], "s77") << token;
        EXPECT_EQ(welcome["cloud"], "second") << "he may look at that without any token";
        EXPECT_EQ(welcome["view"]["method"], "cone");
        EXPECT_EQ(welcome["seq"], 41);
        pass(150);
        finish(port.orders.size() - 1);
        EXPECT_EQ(port.frames.at(0).frameId, 1U);
    }
}

TEST_F(SessionFromElsewhere, WhoSaysNotWhatHeSawBeginsAnew) {
    say({{"type", "hello"}, {"resume", tokenOf("")}, {"cloud", "first"}});
    EXPECT_EQ(port.texts.at(0)["resumed"], false);
}

TEST_F(SessionFromElsewhere, ACloudThatIsNotThereIsRefused) {
    world.second = nullptr;
    say(helloWith(tokenOf("")));
    EXPECT_EQ(port.texts.at(0)["type"], "problem");
    EXPECT_EQ(port.texts.at(0)["problem"]["status"], 404);
    EXPECT_FALSE(session->greeted());
}

TEST_F(SessionTest, AHelloMaySayWhatIsSeenFirst) {
    say({{"type", "hello"}, {"width", 64}, {"height", 48}, {"view", {{"method", "cone"}}}, {"seq", 3}});
    EXPECT_EQ(port.texts.at(0)["view"]["method"], "cone");
    EXPECT_EQ(port.texts.at(0)["view"]["width"], 64);
    EXPECT_EQ(port.texts.at(0)["seq"], 3);
    pass(150);
    finish(0);
    EXPECT_EQ(port.frames.at(0).seq, 3U);
}

TEST_F(SessionTest, AHelloWithAViewThatCannotBeIsRefused) {
    say({{"type", "hello"}, {"view", {{"camera", {{"fvo", 3}}}}}});
    EXPECT_EQ(port.texts.at(0)["problem"]["errors"][0]["parameter"], "camera.fvo");
    EXPECT_FALSE(session->greeted());
    hello();
    EXPECT_TRUE(session->greeted()) << "he may say another one";
}

TEST_F(SessionTest, IsToldOnceThatTheServerGoesAndDrawnForAllTheSame) {
    session->moveOn({700, 9000});
    EXPECT_TRUE(port.texts.empty()) << "a welcome comes first";
    hello();
    ASSERT_EQ(port.texts.size(), 2U);
    EXPECT_EQ(port.texts[0]["type"], "welcome");
    EXPECT_EQ(port.texts[1],
              json({{"type", "drain"}, {"afterMilliseconds", 700}, {"withinMilliseconds", 9000}}));
    session->moveOn({800, 9000});
    EXPECT_EQ(port.texts.size(), 2U);
    EXPECT_FALSE(port.closed);
    pass(150);
    finish(0);
    view(1, 1);
    EXPECT_EQ(port.orders.size(), 2U);
}

TEST_F(SessionTest, WithoutAStoreThereIsNoToken) {
    say({{"type", "hello"}, {"resume", "whatever"}});
    EXPECT_EQ(port.texts.at(0)["resume"], "");
    EXPECT_EQ(port.texts.at(0)["resumed"], false);
}

}  // namespace
}  // namespace scancast::test
