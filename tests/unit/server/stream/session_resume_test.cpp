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
        saved = store.resume(token, now);  // by another connection, before this one has done anything more
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
    EXPECT_TRUE(store.resume(token, now));
    EXPECT_EQ(port.takenOver, 1);
    session->taken();
    EXPECT_EQ(port.closed, CloseCode::PolicyViolation);
    EXPECT_EQ(port.texts.back()["type"], "bye");
}

TEST_F(SessionTest, WithoutAStoreThereIsNoToken) {
    say({{"type", "hello"}, {"resume", "whatever"}});
    EXPECT_EQ(port.texts.at(0)["resume"], "");
    EXPECT_EQ(port.texts.at(0)["resumed"], false);
}

}  // namespace
}  // namespace scancast::test
