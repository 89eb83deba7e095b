#include "server/stream/session_register.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "tests/unit/server/stream/session_fixture.hpp"

namespace scancast::test {
namespace {

/// Counts how often it was asked to look; changes nothing.
class CountingSession final : public LiveSession {
  public:
    void changeView(messages::ViewChange, Changed) override {}
    void lookAround() override { ++looks; }
    int looks = 0;
};

class RegisterTest : public ::testing::Test {
  protected:
    std::unique_ptr<SessionRegistration> enter(const std::shared_ptr<CountingSession>& session) {
        return sessions.enter(ClientKind::WebSocket, session);
    }
    SessionRegister sessions;
    std::shared_ptr<CountingSession> first = std::make_shared<CountingSession>(),
                                     second = std::make_shared<CountingSession>(),
                                     third = std::make_shared<CountingSession>();
};

TEST_F(RegisterTest, ListsWhoIsThereInTheOrderOfArrival) {
    auto a = enter(first);
    auto b = sessions.enter(ClientKind::Mjpeg, second);
    EXPECT_NE(a->id(), b->id());
    a->show({"town", View(), 7});
    a->frameSent();
    a->frameSent();
    const auto list = sessions.list();
    ASSERT_EQ(list.size(), 2U);
    EXPECT_EQ(list[0].id, a->id());
    EXPECT_EQ(list[0].frames, 2U);
    EXPECT_EQ(list[0].shows->cloudId, "town");
    EXPECT_EQ(list[1].client, ClientKind::Mjpeg);
    EXPECT_FALSE(list[1].shows);
    EXPECT_EQ(sessions.seqOf(a->id()), 7U);
    EXPECT_EQ(sessions.find(b->id()), second);
    const auto json = sessionListJson(list);
    EXPECT_EQ(json["sessions"][0]["view"]["width"], View().width);
    EXPECT_TRUE(json["sessions"][1]["view"].is_null());
    b.reset();
    EXPECT_EQ(sessions.list().size(), 1U);
    EXPECT_EQ(sessions.find("nobody"), nullptr);
}

TEST_F(RegisterTest, IdsCannotBeGuessed) {
    std::set<std::string> ids;
    for (int i = 0; i < 100; ++i) ids.insert(enter(first)->id());
    EXPECT_EQ(ids.size(), 100U);
    EXPECT_GE(ids.begin()->size(), 25U);
}

TEST_F(RegisterTest, ASessionThatGoesOnTakesItsIdAgain) {
    auto before = enter(first);
    const std::string id = before->id();
    auto after = enter(second);
    after->resumeAs(id);
    EXPECT_EQ(after->id(), id);
    EXPECT_EQ(sessions.find(id), second);
    EXPECT_NE(before->id(), id) << "the old connection is still there, as somebody else";
    EXPECT_EQ(sessions.find(before->id()), first);
    before.reset();
    after->resumeAs(id);
    EXPECT_EQ(after->id(), id);
    EXPECT_EQ(sessions.list().size(), 1U);
    EXPECT_EQ(sessions.list()[0].id, id);
    after.reset();
    EXPECT_TRUE(sessions.list().empty());
}

TEST_F(RegisterTest, FollowersAreToldOfEveryChangeAndOfTheEnd) {
    auto leader = enter(first);
    auto follower = enter(second);
    auto stranger = enter(third);
    leader->show({"town", View(), 1});
    ASSERT_TRUE(follower->follow(leader->id()));
    leader->show({"town", View(), 2});
    EXPECT_EQ(second->looks, 1);
    EXPECT_EQ(follower->leader()->seq, 2U);
    leader.reset();
    EXPECT_EQ(second->looks, 2);
    EXPECT_FALSE(follower->leader());
    EXPECT_TRUE(follower->following()) << "until it says that it has seen it";
    follower->unfollow();
    EXPECT_FALSE(follower->following());
    EXPECT_EQ(third->looks, 0);
    sessions.wakeAll();
    EXPECT_EQ(third->looks, 1);
}

TEST_F(RegisterTest, NobodyFollowsAFollower) {
    auto a = enter(first);
    auto b = enter(second);
    auto c = enter(third);
    EXPECT_EQ(a->follow("nobody").error().status, 404);
    EXPECT_EQ(a->follow(b->id()).error().status, 503) << "it shows nothing yet";
    for (auto* registration : {&a, &b, &c}) (*registration)->show({"town", View(), 0});
    EXPECT_EQ(a->follow(a->id()).error().status, 409);
    ASSERT_TRUE(a->follow(b->id()));
    EXPECT_EQ(c->follow(a->id()).error().status, 409);
    EXPECT_EQ(b->follow(c->id()).error().status, 409);
    EXPECT_TRUE(c->mayFollow(b->id()));
    EXPECT_FALSE(c->following());
}

// Whoever leads is asked for every frame, and so counted: against the list, whoever comes, goes, and takes an id again.
TEST_F(RegisterTest, WhoLeadsIsKnownWhateverFollowersDo) {
    std::mt19937 random{17};
    const auto below = [&](std::size_t count) {
        return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
    };
    std::vector<std::unique_ptr<SessionRegistration>> all;
    std::vector<std::string> gone;
    std::size_t followed = 0, switched = 0, left = 0, resumed = 0;
    for (int step = 0; step < 3000; ++step) {
        const std::size_t what = below(12);
        if (all.size() < 3 || (what == 0 && all.size() < 12)) {
            all.push_back(enter(first));
            all.back()->show({"town", View(), 0});
        }
        SessionRegistration& one = *all[below(all.size())];
        const std::string other = all[below(all.size())]->id();
        if (what < 7) {
            const bool before = one.following();
            const bool done = one.follow(other).has_value();
            followed += done ? 1 : 0;
            switched += done && before ? 1 : 0;
        } else if (what < 9) {
            one.unfollow();
        } else if (what == 9) {
            const std::size_t at = below(all.size());
            left += all[at]->leads() || all[at]->following() ? 1 : 0;
            gone.push_back(all[at]->id());
            all.erase(all.begin() + std::ptrdiff_t(at));
        } else if (what == 10) {
            const std::string& id = gone.empty() || below(2) == 0 ? other : gone.back();
            one.resumeAs(id);
            resumed += one.leads() ? 1 : 0;
        }
        const auto list = sessions.list();
        for (const auto& registration : all) {
            const auto following = std::ranges::count(list, registration->id(), &SessionFacts::follows);
            ASSERT_EQ(registration->leads(), following > 0) << "in step " << step;
        }
    }
    EXPECT_GT(followed, 100U);
    EXPECT_GT(switched, 20U);
    EXPECT_GT(left, 20U);
    EXPECT_GT(resumed, 5U);
}

// ---- what a session makes of it

class FollowTest : public SessionTest {
  protected:
    FollowTest() {
        leader->show({"second", leaderView(5), 3});
        SessionOptions options;
        options.id = "s1";
        options.maxPixels = 4'000'000;
        options.registration = registration.get();
        session.emplace(options, world, port, metrics, now);
    }
    static View leaderView(double x) {
        View view;
        view.width = 1000;
        view.height = 500;
        view.camera.eye = {x, -50, 30};
        view.camera.target = {5, 5, 0};
        view.style.method = "cone";
        return view;
    }

    SessionRegister sessions;
    std::shared_ptr<CountingSession> other = std::make_shared<CountingSession>();
    std::unique_ptr<SessionRegistration> leader = sessions.enter(ClientKind::WebSocket, other);
    std::unique_ptr<SessionRegistration> registration = sessions.enter(ClientKind::WebSocket, other);
};

TEST_F(FollowTest, AHelloThatFollowsShowsTheLeadersViewInItsOwnSize) {
    say({{"type", "hello"}, {"width", 640}, {"height", 480}, {"follow", leader->id()}});
    ASSERT_EQ(port.texts.at(0)["type"], "welcome");
    EXPECT_EQ(port.texts[0]["cloud"], "second");
    EXPECT_EQ(port.texts[0]["view"]["method"], "cone");
    EXPECT_EQ(port.texts[0]["view"]["width"], 640);
    EXPECT_EQ(sessions.list()[1].follows, leader->id());
    leader->show({"second", leaderView(9), 4});
    session->lookAround(now);
    ASSERT_FALSE(port.orders.empty());
    EXPECT_EQ(port.orders.back().order.view.camera.eye.x, 9);
    const auto orders = port.orders.size();
    session->lookAround(now);
    EXPECT_EQ(port.orders.size(), orders) << "nothing has changed";
}

TEST_F(FollowTest, OnlyItsSizeIsAFollowersOwn) {
    hello();
    say({{"type", "view"}, {"seq", 1}, {"follow", leader->id()}});
    say({{"type", "view"}, {"seq", 2}, {"width", 320}});
    EXPECT_EQ(registration->following(), true);
    EXPECT_EQ(port.texts.size(), 1U) << "no problem";
    say({{"type", "view"}, {"seq", 3}, {"method", "point"}});
    EXPECT_EQ(port.texts.at(1)["problem"]["status"], 409);
    EXPECT_EQ(port.texts[1]["seq"], 3);
    say({{"type", "view"}, {"seq", 4}, {"follow", nullptr}, {"method", "point"}});
    EXPECT_EQ(port.texts.size(), 2U);
    EXPECT_FALSE(registration->following());
    EXPECT_EQ(sessions.list()[1].shows->view.style.method, "point");
    EXPECT_EQ(sessions.list()[1].shows->view.width, 320);
    EXPECT_EQ(sessions.list()[1].shows->cloudId, "second") << "it goes on from what it showed";
}

TEST_F(FollowTest, ARefusedLeaderLeavesTheSessionAsItWas) {
    hello();
    say({{"type", "view"}, {"seq", 1}, {"follow", "nobody"}});
    EXPECT_EQ(port.texts.at(1)["problem"]["status"], 404);
    EXPECT_EQ(port.texts[1]["problem"]["errors"][0]["parameter"], "follow");
    EXPECT_EQ(sessions.list()[1].shows->cloudId, "first");
    say({{"type", "hello"}, {"cloud", "first"}, {"follow", leader->id()}});
    EXPECT_EQ(port.texts.at(2)["type"], "problem");
}

TEST_F(FollowTest, WhyALeadersViewsCannotBeShownIsSaidOnce) {
    leader->show({"first", leaderView(1), 1});
    hello();
    say({{"type", "view"}, {"seq", 1}, {"follow", leader->id()}});
    world.second.reset();
    const auto problemsAfter = [&](const char* cloud) {
        for (int i = 0; i < 5; ++i) {
            leader->show({cloud, leaderView(i), std::uint64_t(i)});
            session->lookAround(now);
        }
        return std::ranges::count_if(port.texts, [](const json& text) { return text["type"] == "problem"; });
    };
    EXPECT_EQ(problemsAfter("second"), 1);
    EXPECT_EQ(problemsAfter("first"), 1);
    EXPECT_EQ(problemsAfter("second"), 2) << "which is news again";
    EXPECT_FALSE(port.closed);
}

TEST_F(FollowTest, WhenTheLeaderLeavesTheFollowerIsToldAndStays) {
    hello();
    say({{"type", "view"}, {"seq", 1}, {"follow", leader->id()}});
    leader.reset();
    session->lookAround(now);
    EXPECT_EQ(port.texts.at(1)["problem"]["status"], 404);
    EXPECT_FALSE(registration->following());
    EXPECT_FALSE(port.closed);
    say({{"type", "view"}, {"seq", 2}, {"method", "point"}});
    EXPECT_EQ(port.texts.size(), 2U);
}

TEST_F(FollowTest, ASessionOfARemovedCloudIsToldAndClosed) {
    hello();
    world.removed = true;
    session->lookAround(now);
    EXPECT_EQ(port.texts.at(1)["problem"]["status"], 404);
    EXPECT_EQ(port.texts.at(2)["type"], "bye");
    EXPECT_EQ(port.closed, CloseCode::GoingAway);
}

TEST_F(FollowTest, AChangeByAnotherWayAnswersWithWhatIsShown) {
    messages::ViewChange change{9, std::nullopt, {{"width", 100}}};
    EXPECT_EQ(session->change(change, now).error().status, 409) << "nobody has said hello";
    hello();
    const auto shown = session->change(change, now);
    ASSERT_TRUE(shown);
    EXPECT_EQ(shown->seq, 9U);
    EXPECT_EQ(shown->view.width, 100);
    change.changes = {{"wdith", 100}};
    EXPECT_EQ(session->change(change, now).error().errors.at(0).parameter, "wdith");
    EXPECT_EQ(port.texts.size(), 1U) << "who asked is told, not the session's client";
}

}  // namespace
}  // namespace scancast::test
