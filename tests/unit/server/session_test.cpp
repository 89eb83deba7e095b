#include "server/stream/session.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "renderer/render.hpp"
#include "tests/support/fake_painter.hpp"

namespace scancast {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;

// Everything that the session says, written down.
class RecordingPort final : public StreamPort {
  public:
    struct Placed {
        std::uint64_t number;
        PictureOrder order;
    };

    void sendText(std::string text) override { texts.push_back(json::parse(text)); }
    void sendFrame(const FrameHeader& header, std::shared_ptr<const Bytes>) override {
        frames.push_back(header);
    }
    void order(std::uint64_t number, PictureOrder order) override {
        orders.push_back({number, std::move(order)});
    }
    bool replaceWaiting(std::uint64_t number, PictureOrder order) override {
        if (!canReplace) return false;
        ++replaced;
        orders.push_back({number, std::move(order)});
        return true;
    }
    void abandon() override { ++abandoned; }
    void close(CloseCode code, std::string) override { closed = code; }

    std::vector<json> texts;
    std::vector<FrameHeader> frames;
    std::vector<Placed> orders;
    bool canReplace = false;
    int replaced = 0, abandoned = 0;
    std::optional<CloseCode> closed;
};

class TwoClouds final : public StreamWorld {
  public:
    std::string defaultCloud() const override { return "first"; }
    tl::expected<std::shared_ptr<const Cloud>, Problem> cloud(std::string_view id) const override {
        if (id == "first") return first;
        if (id == "second") return second;
        return tl::unexpected(problemOf(404, "no such cloud"));
    }
    bool loading(std::string_view) const override { return isLoading; }
    Expected<void> check(const Cloud&, const View& view) const override {
        if (view.style.method == "nonsense") return fail(ErrorCode::NotFound, "no such method", "method");
        return {};
    }
    double ownDetail(const View&) const override { return 1; }
    std::vector<std::string> methodNames() const override { return {"paraboloid"}; }

    std::shared_ptr<const Cloud> first = test::tinyCloud(1), second = test::tinyCloud(2);
    bool isLoading = false;
};

class SessionTest : public ::testing::Test {
  protected:
    SessionTest() {
        SessionOptions options;
        options.id = "s1";
        options.maxPixels = 4'000'000;
        session.emplace(options, world, port, metrics, now);
    }

    void say(const json& message) { session->text(message.dump(), now); }
    void hello() { say({{"type", "hello"}, {"width", 640}, {"height", 480}}); }
    void view(std::uint64_t seq, double x) {
        say({{"type", "view"}, {"seq", seq}, {"camera", {{"eye", {x, -50, 30}}, {"target", {5, 5, 0}}}}});
    }
    void ack(std::uint64_t frame) { say({{"type", "ack"}, {"frame", frame}}); }
    void pass(int ms) {
        now += milliseconds(ms);
        session->tick(now);
    }
    /// The scheduler finishes the order that was placed as the n-th.
    void finish(std::size_t n, double renderMs = 1) {
        Picture picture;
        picture.bytes = std::make_shared<const Bytes>(Bytes{1, 2, 3});
        picture.width = port.orders.at(n).order.view.width;
        picture.height = port.orders.at(n).order.view.height;
        picture.renderMs = renderMs;
        session->pictureDone(port.orders.at(n).number, std::move(picture), now);
    }
    const PictureOrder& order(std::size_t n) const { return port.orders.at(n).order; }
    /// Hello, and its first still, out of the way.
    void greet() {
        hello();
        pass(150);
        finish(0);
        ack(1);
        port.orders.clear();
        port.frames.clear();
        port.texts.clear();
    }

    TwoClouds world;
    RecordingPort port;
    Metrics metrics{"test"};
    StreamSession::Time now{std::chrono::hours(1)};
    std::optional<StreamSession> session;
};

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
        {{"type", "pick"}, {"seq", 1}, {"x", 1}, {"y", 1}},
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

/// A store of which everything is always still to come; what pictures lack is what the test says.
class NeverWhole final : public SampleStore {
  public:
    std::optional<SampleRun> find(std::uint32_t) override { return std::nullopt; }
    Expected<SampleRun> load(std::uint32_t, std::stop_token) override { return fail(ErrorCode::Io, "never"); }
    std::vector<Expected<SampleRun>> loadAll(std::span<const std::uint32_t>, std::stop_token) override {
        return {};
    }
    void request(std::uint64_t, std::vector<Wish>) override {}
    bool whole() const override { return false; }
    bool damaged(std::uint32_t) const override { return false; }
    std::uint64_t capacity() const override { return 1000; }
    std::uint64_t bytesResident() const override { return 0; }
};

class ColdCloud : public SessionTest {
  protected:
    void SetUp() override {
        auto cloud = std::make_shared<Cloud>(*test::tinyCloud(1));
        const auto nodes = cloud->octree.nodes();
        cloud->octree = Octree(std::vector<Node>(nodes.begin(), nodes.end()), std::make_shared<NeverWhole>());
        world.first = cloud;
    }
    void finishMissing(std::size_t n, std::uint64_t missing) {
        Picture picture;
        picture.bytes = std::make_shared<const Bytes>(Bytes{1, 2, 3});
        picture.width = picture.height = 8;
        picture.stats.samplesMissing = missing;
        session->pictureDone(port.orders.at(n).number, std::move(picture), now);
        ack(port.frames.back().frameId);
    }
};

TEST_F(ColdCloud, StillsGetSharperUntilNothingIsMissingThenComesTheFinalOne) {
    hello();
    pass(150);
    ASSERT_EQ(port.orders.size(), 1U);
    EXPECT_FALSE(order(0).complete);
    EXPECT_TRUE(order(0).interruptible);
    EXPECT_EQ(order(0).view.quality.samples, 1);
    finishMissing(0, 500);
    EXPECT_EQ(port.orders.size(), 1U) << "not at once: blocks take time";
    EXPECT_TRUE(session->wakeAt());
    pass(100);
    ASSERT_EQ(port.orders.size(), 2U);
    finishMissing(1, 100);
    pass(100);
    finishMissing(2, 0);
    ASSERT_EQ(port.orders.size(), 4U) << "complete: the final one follows without a pause";
    EXPECT_TRUE(order(3).complete);
    EXPECT_FALSE(order(3).view.quality.samples);
    finishMissing(3, 0);
    ASSERT_EQ(port.frames.size(), 4U);
    EXPECT_TRUE(port.frames[0].still && !port.frames[0].final && !port.frames[0].moving);
    EXPECT_TRUE(port.frames[3].still && port.frames[3].final);
    pass(10'000);
    EXPECT_EQ(port.orders.size(), 4U) << "after the final still nothing is sent";
    EXPECT_FALSE(session->wakeAt());
}

TEST_F(ColdCloud, StillsWithoutProgressEndInTheFinalOneThatWaits) {
    hello();
    pass(150);
    for (std::size_t n = 0; n < 100 && !order(n).complete; ++n) {
        finishMissing(n, 500);
        pass(100);
        ASSERT_EQ(port.orders.size(), n + 2);
    }
    EXPECT_TRUE(port.orders.back().order.complete);
    EXPECT_LT(port.orders.size(), 10U);
}

TEST_F(ColdCloud, AFailedStillIsNotTriedForEver) {
    hello();
    pass(150);
    session->pictureDone(port.orders[0].number, fail(ErrorCode::Internal, "broken"), now);
    ASSERT_EQ(port.orders.size(), 2U);
    session->pictureDone(port.orders[1].number, fail(ErrorCode::Internal, "broken"), now);
    pass(1000);
    EXPECT_EQ(port.orders.size(), 2U);
}

TEST_F(ColdCloud, ANewViewEndsTheStills) {
    hello();
    pass(150);
    view(1, 10);
    EXPECT_EQ(port.abandoned, 1);
    ASSERT_EQ(port.orders.size(), 2U);
    EXPECT_FALSE(order(1).complete);
    EXPECT_FALSE(order(1).interruptible);
}

TEST_F(ColdCloud, MovingFramesLookAhead) {
    hello();
    pass(100);
    view(1, 10);
    now += milliseconds(100);
    view(2, 12);
    ASSERT_GE(port.orders.size(), 2U);
    const auto ahead = order(1).ahead;
    ASSERT_TRUE(ahead);
    EXPECT_GT(ahead->eye.x, 14) << "0.3 s on, at 2 in 0.1 s";
}

TEST_F(SessionTest, WhoStandsStillSeesTheFinerCloudThatTakesThePlaceOfTheCoarse) {
    world.isLoading = true;
    hello();
    pass(150);
    finish(0);
    ack(1);
    ASSERT_TRUE(session->wakeAt()) << "a cloud that is being loaded is looked after";
    pass(250);
    EXPECT_EQ(port.orders.size(), 1U) << "it is still the same";
    const auto finer = test::tinyCloud(77);
    world.first = finer;
    world.isLoading = false;
    pass(250);
    pass(150);
    ASSERT_EQ(port.orders.size(), 2U);
    EXPECT_EQ(order(1).cloud, finer);
    EXPECT_TRUE(order(1).complete);
    finish(1);
    ack(2);
    EXPECT_FALSE(session->wakeAt()) << "loaded: nothing more to look for";
}

}  // namespace
}  // namespace scancast
