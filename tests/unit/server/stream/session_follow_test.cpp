// Followers send their leader's pictures: what is ordered of the scheduler is counted, and whose bytes each is sent. Simulated time, one
// device that draws one picture after the other, clients that acknowledge at once, later, or never.
#include <gtest/gtest.h>

#include <set>

#include "tests/support/needs_video.hpp"
#include "tests/support/sized.hpp"
#include "tests/unit/server/stream/session_fixture.hpp"

namespace scancast::test {
namespace {

constexpr int many = sized(200, 20);

class Audience {
  public:
    struct Member final : StreamPort, LiveSession {
        void sendText(std::string text) override { texts.push_back(json::parse(text)); }
        void sendFrame(const FrameHeader& header, std::shared_ptr<const Bytes> picture,
                       std::shared_ptr<const Bytes> depth) override {
            frames.push_back(header);
            pictures.push_back(std::move(picture));
            withDepth += depth ? 1 : 0;
            if (ackAfter >= 0) acks.emplace_back(audience->ms_ + ackAfter, header.frameId);
        }
        void order(std::uint64_t number, PictureOrder order) override {
            ++orders;
            if (order.video) ++videoOrders;
            if (order.video) video = order.video;
            audience->device_.push_back({this, number, std::move(order)});
        }
        bool replaceWaiting(std::uint64_t, PictureOrder) override { return false; }
        void pick(std::uint64_t, std::shared_ptr<const Cloud>, std::shared_ptr<const PlannedView>, double,
                  double) override {}
        void abandon() override {
            ++abandoned;
            const Job* drawn = audience->drawnAt_ < 0 ? nullptr : &audience->device_.front();
            std::erase_if(audience->device_, [&](const Job& job) {
                return job.of == this && (&job != drawn || job.order.interruptible);
            });
        }
        void close(CloseCode, std::string) override {}
        std::function<void()> onTaken() override {
            return [] {};
        }
        void changeView(messages::ViewChange, Changed) override {}
        void lookAround() override { looks = true; }

        std::size_t count(bool moving) const {
            return std::size_t(std::ranges::count(frames, moving, &FrameHeader::moving));
        }

        Audience* audience = nullptr;
        std::int64_t ackAfter = 1;  // ms; less than 0 = never
        bool looks = false;
        std::size_t orders = 0, videoOrders = 0, withDepth = 0, abandoned = 0;
        std::shared_ptr<VideoStream> video;  // of the newest order that has one
        std::vector<json> texts;
        std::vector<FrameHeader> frames;
        std::vector<std::shared_ptr<const Bytes>> pictures;
        std::deque<std::pair<std::int64_t, std::uint64_t>> acks;
        std::unique_ptr<SessionRegistration> registration;
        std::optional<StreamSession> session;
    };

    std::shared_ptr<Member> enter(json hello, const StreamWorld& world, std::int64_t ackAfter = 1) {
        auto member = std::make_shared<Member>();
        member->audience = this;
        member->ackAfter = ackAfter;
        member->registration = sessions.enter(ClientKind::WebSocket, member);
        SessionOptions options;
        options.id = member->registration->id();
        options.maxPixels = 4'000'000;
        options.registration = member->registration.get();
        options.video = &places;
        member->session.emplace(options, world, *member, metrics, time());
        hello["type"] = "hello";
        member->session->text(hello.dump(), time());
        members.push_back(member);
        return member;
    }
    std::shared_ptr<Member> follow(const Member& leader, json hello = json::object(),
                                   std::int64_t ackAfter = 1) {
        hello["follow"] = leader.registration->id();
        return enter(std::move(hello), world, ackAfter);
    }
    /// The leader's camera moves; without one, all rest.
    void run(int ms, Member* leader = nullptr) {
        for (const std::int64_t end = ms_ + ms; ms_ < end; ++ms_) step(leader);
    }
    std::size_t orders() const {
        std::size_t sum = 0;
        for (const auto& member : members) sum += member->orders;
        return sum;
    }

    StreamSession::Time time() const {
        return StreamSession::Time(std::chrono::hours(1) + milliseconds(ms_));
    }

    const VideoPlaces places{1};
    TwoClouds world;
    Metrics metrics{"test"};
    SessionRegister sessions;
    std::vector<std::shared_ptr<Member>> members;
    double drawMs = 12;

  private:
    struct Job {
        Member* of = nullptr;
        std::uint64_t number = 0;
        PictureOrder order;
    };

    void step(Member* leader) {
        if (leader != nullptr && ms_ % 16 == 0)
            leader->session->text(json{{"type", "view"},
                                       {"seq", ++seq_},
                                       {"camera", {{"eye", {double(ms_), -50, 30}}, {"target", {5, 5, 0}}}}}
                                      .dump(),
                                  time());
        if (!device_.empty() && drawnAt_ < 0) drawnAt_ = ms_ + std::int64_t(drawMs);
        if (drawnAt_ >= 0 && drawnAt_ <= ms_) draw();
        for (std::size_t i = 0; i < members.size(); ++i) {
            Member& member = *members[i];
            while (!member.acks.empty() && member.acks.front().first <= ms_) {
                member.session->text(json{{"type", "ack"}, {"frame", member.acks.front().second}}.dump(),
                                     time());
                member.acks.pop_front();
            }
            if (std::exchange(member.looks, false)) member.session->lookAround(time());
            if (const auto wake = member.session->wakeAt(); wake && *wake <= time()) {
                member.session->tick(time());
                const auto next = member.session->wakeAt();
                EXPECT_TRUE(!next || *next > time()) << "it would be woken again and again";
            }
        }
    }

    void draw() {
        drawnAt_ = -1;
        if (device_.empty()) return;
        const Job job = std::move(device_.front());
        device_.pop_front();
        EncodedPicture picture;
        picture.bytes = std::make_shared<const Bytes>(Bytes(1000));
        if (job.order.withDepth) picture.depth = std::make_shared<const Bytes>(Bytes(10));
        picture.width = job.order.view.width;
        picture.height = job.order.view.height;
        picture.renderMs = drawMs;
        job.of->session->pictureDone(job.number, std::move(picture), time());
    }

    std::int64_t ms_ = 0, drawnAt_ = -1;
    std::uint64_t seq_ = 0;
    std::deque<Job> device_;
};

TEST(Followers, TwoHundredCostNoMoreThanOne) {
    Audience audience;
    const auto leader = audience.enter(json::object(), audience.world);
    audience.run(300);
    for (int i = 0; i < many; ++i) audience.follow(*leader);
    audience.run(4000);  // each draws its first picture by itself
    const std::size_t before = audience.orders(), frames = leader->frames.size();
    std::vector<std::size_t> had;
    for (const auto& member : audience.members) had.push_back(member->count(true));
    audience.run(3000, leader.get());
    audience.run(1500);
    const double pictures = double(leader->frames.size() - frames);
    EXPECT_GE(pictures, 80);
    EXPECT_LE(double(audience.orders() - before), 1.2 * pictures) << "drawn and encoded";
    for (std::size_t i = 1; i < audience.members.size(); ++i) {
        const auto& member = *audience.members[i];
        ASSERT_GE(double(member.count(true) - had[i]), 0.9 * (pictures - 1)) << i;
        ASSERT_TRUE(member.frames.back().final) << i;
        ASSERT_EQ(member.pictures.back(), leader->pictures.back()) << "the same bytes, not equal ones";
        ASSERT_EQ(member.frames.back().frameId, member.frames.size()) << "numbered by itself";
        ASSERT_FALSE(member.session->wakeAt()) << "it has all that it wants";
    }
    const std::string text = audience.metrics.text();
    EXPECT_NE(text.find("scancast_frames_shared_total"), std::string::npos);
}

// However long a picture takes: what the leader's costs is paid once, and who waits for it has it as soon as it would have had its own.
TEST(Followers, OfABusyServerTheyCostNoMoreThanOne) {
    Audience audience;
    const auto leader = audience.enter(json::object(), audience.world);
    audience.run(300);
    for (int i = 0; i < many; ++i) audience.follow(*leader);
    audience.run(4000);
    audience.run(1000, leader.get());
    audience.drawMs = 400;  // all at once, while none of them knows that pictures take so long
    audience.run(1000, leader.get());
    const std::size_t before = audience.orders(), frames = leader->frames.size();
    std::vector<std::size_t> had;
    for (const auto& member : audience.members) had.push_back(member->frames.size());
    audience.run(20'000, leader.get());
    const double pictures = double(leader->frames.size() - frames);
    EXPECT_GE(pictures, 40) << "as many as without them";
    EXPECT_LE(double(audience.orders() - before), 1.2 * pictures) << "drawn and encoded";
    for (std::size_t i = 1; i < audience.members.size(); ++i)
        ASSERT_GE(double(audience.members[i]->frames.size() - had[i]), 0.9 * (pictures - 1)) << i;
}

// As when hundreds come at once to a leader that moves: each has a first picture of its own, and the leader's next one is behind all of these.
TEST(Followers, WhoHaveAllOrderedForThemselvesFindBackToTheLeader) {
    Audience audience;
    audience.drawMs = 25;
    const auto leader = audience.enter(json::object(), audience.world);
    audience.run(300, leader.get());
    for (int i = 0; i < many; ++i) audience.follow(*leader);
    audience.run(12'000, leader.get());
    const std::size_t before = audience.orders(), frames = leader->frames.size();
    audience.run(5000, leader.get());
    const double pictures = double(leader->frames.size() - frames);
    EXPECT_GE(pictures, 140);
    EXPECT_LE(double(audience.orders() - before), 1.2 * pictures) << "drawn and encoded";
}

TEST(Followers, ThePictureOfALeaderThatComesBackTakesThePlaceOfOwnOnes) {
    SCANCAST_NEEDS_VIDEO();
    Audience audience;
    const auto leader = audience.enter(json::object(), audience.world);
    audience.run(300);
    const auto follower = audience.follow(*leader, {{"codecs", {"h264", "jpeg"}}});
    audience.run(1000);
    audience.drawMs = 45;
    audience.run(1000, leader.get());
    EXPECT_EQ(follower->videoOrders, 0U) << "the leader's are JPEG, and are enough";
    leader->ackAfter = -1;
    audience.run(1000, leader.get());
    ASSERT_GT(follower->videoOrders, 10U) << "its own, of what the leader looks at";
    const std::size_t abandoned = follower->abandoned;
    leader->ackAfter = 1;
    leader->session->text(json{{"type", "ack"}, {"frame", leader->frames.back().frameId}}.dump(),
                          audience.time());
    Frame picture;
    picture.width = picture.height = 16;
    picture.rgba.own().assign(16 * 16 * 4, 128);
    for (int i = 0; i < 3; ++i) follower->video->encode(picture, 80);
    for (int i = 0; i < 2000 && follower->abandoned == abandoned; ++i) audience.run(1, leader.get());
    ASSERT_GT(follower->abandoned, abandoned);
    EXPECT_TRUE(follower->video->encode(picture, 80)->key) << "what was being made did not arrive";
    const std::size_t own = follower->videoOrders;
    audience.run(2000, leader.get());
    EXPECT_LE(follower->videoOrders - own, 1U);
    EXPECT_EQ(follower->frames.back().frameId, follower->frames.size());
}

TEST(Followers, OneThatIsSlowCostsTheLeaderNothing) {
    const auto framesOfLeader = [](bool beside) {
        Audience audience;
        const auto leader = audience.enter(json::object(), audience.world);
        audience.run(300);
        if (beside) {
            audience.follow(*leader, json::object(), -1);
            audience.follow(*leader, json::object(), 700);
        }
        audience.run(3000, leader.get());
        if (beside) {
            EXPECT_LE(audience.members[1]->frames.size(), 2U);
        }
        return leader->frames.size();
    };
    EXPECT_GE(framesOfLeader(true) + 1, framesOfLeader(false));
}

TEST(Followers, ALeaderThatIsSlowCostsItsFollowersNothing) {
    Audience audience;
    const auto leader = audience.enter(json::object(), audience.world);
    audience.run(300);
    const auto follower = audience.follow(*leader);
    audience.run(1500);
    leader->ackAfter = -1;
    audience.run(3000, leader.get());
    EXPECT_GE(follower->count(true), 70U) << "its own pictures, of what the leader looks at";
    audience.run(1500);
    EXPECT_TRUE(follower->frames.back().final);
}

// A leader whose client wants few frames does not make few of them for those who want many.
TEST(Followers, WhoseLeaderIsShownSeldomHasPicturesOfItsOwn) {
    Audience audience;
    const auto leader = audience.enter({{"fps", 5}}, audience.world);
    audience.run(300);
    const auto follower = audience.follow(*leader);
    audience.run(3000, leader.get());
    EXPECT_LE(leader->count(true), 30U);
    EXPECT_GE(follower->count(true), 60U);
    audience.run(1500);
    EXPECT_TRUE(follower->frames.back().final);
}

TEST(Followers, AnotherSizeIsAnotherPicture) {
    Audience audience;
    const auto leader = audience.enter({{"width", 640}, {"height", 360}}, audience.world);
    audience.run(300);
    const auto follower = audience.follow(*leader, {{"width", 320}, {"height", 200}});
    audience.run(3000, leader.get());
    audience.run(500);
    EXPECT_EQ(follower->orders, follower->frames.size());
    for (const FrameHeader& frame : follower->frames) EXPECT_LE(frame.width, 320U);
    EXPECT_TRUE(follower->frames.back().final);
}

TEST(Followers, WhoSeesAnotherCloudByThatNameNeverGetsTheLeadersPicture) {
    Audience audience;
    TwoClouds theirs;
    theirs.first = tinyCloud(3);
    const auto leader = audience.enter(json::object(), audience.world);
    audience.run(300);
    const auto follower = audience.enter({{"follow", leader->registration->id()}}, theirs);
    audience.run(3000, leader.get());
    audience.run(2000);
    const std::set<std::shared_ptr<const Bytes>> shown(leader->pictures.begin(), leader->pictures.end());
    for (const auto& picture : follower->pictures) EXPECT_FALSE(shown.contains(picture));
    EXPECT_GE(follower->count(true), 70U);
    EXPECT_TRUE(follower->frames.back().final);
}

TEST(Followers, DepthGoesToWhoAskedForIt) {
    Audience audience;
    const auto leader = audience.enter({{"depth", true}}, audience.world);
    audience.run(300);
    const auto without = audience.follow(*leader), with = audience.follow(*leader, {{"depth", true}});
    audience.run(1000);
    const std::size_t orders = audience.orders();
    audience.run(1000, leader.get());
    EXPECT_EQ(without->withDepth, 0U);
    EXPECT_EQ(with->withDepth, with->frames.size());
    EXPECT_LE(audience.orders() - orders, leader->frames.size());
}

TEST(Followers, WhoComesLaterIsNotSentWhatWasSharedLongAgo) {
    Audience audience;
    const auto leader = audience.enter(json::object(), audience.world);
    audience.run(300);
    audience.follow(*leader);
    audience.run(1000, leader.get());
    audience.run(500);
    const auto shared = leader->pictures.back();
    audience.members.pop_back();  // and nobody follows
    audience.run(500, leader.get());
    audience.run(500);
    const auto late = audience.follow(*leader);
    audience.run(300);
    ASSERT_FALSE(late->frames.empty()) << "it does not wait for what nobody sends";
    audience.run(500, leader.get());
    EXPECT_EQ(std::ranges::count(late->pictures, shared), 0);
}

TEST(Followers, WhoHasVideoHasJpegWhileItIsFollowed) {
    SCANCAST_NEEDS_VIDEO();
    Audience audience;
    const auto leader = audience.enter({{"codecs", {"h264", "jpeg"}}}, audience.world);
    ASSERT_EQ(leader->texts.at(0)["movingCodec"], "h264");
    audience.run(1000, leader.get());
    const std::size_t alone = leader->videoOrders;
    EXPECT_GT(alone, 20U);
    auto follower = audience.follow(*leader);
    audience.run(200, leader.get());
    const std::size_t before = leader->videoOrders;
    const std::size_t ordered = audience.orders();
    audience.run(1000, leader.get());
    EXPECT_EQ(leader->videoOrders, before);
    EXPECT_EQ(follower->videoOrders, 0U);
    EXPECT_GT(follower->count(true), 20U);
    EXPECT_LE(audience.orders() - ordered, 40U) << "one drawing for both";
    audience.run(1500);
    audience.members.pop_back();
    follower.reset();
    audience.run(1000, leader.get());
    EXPECT_GT(leader->videoOrders, before + 20) << "and video again when it is not";
}

}  // namespace
}  // namespace scancast::test
