#include "server/stream/resume_store.hpp"

#include <gtest/gtest.h>

#include <set>

namespace scancast {
namespace {

using std::chrono::seconds;

class ResumeStoreTest : public ::testing::Test {
  protected:
    ResumeStore::Ticket begin(const std::string& id, std::uint32_t turn = 1, ResumeStore::Key place = 0) {
        auto ticket = store.open({id, "anna", turn, [this, id] { taken.insert(id); }, place});
        SavedSession session;
        session.id = id;
        store.keep(ticket->key, session);
        return *ticket;
    }

    /// What is remembered of it; nobody goes on with it then.
    std::optional<SavedSession> saved(const std::string& token, ResumeStore::Time at) {
        auto resumed = store.resume(token, "anna", at);
        if (!resumed) return std::nullopt;
        store.forget(resumed->place);
        return std::move(resumed->saved);
    }
    ResumeOptions optionsOfTests() {
        return {.lifetime = seconds(60), .mostAway = 3, .unixTime = [this] { return unixTime; }};
    }

    std::int64_t unixTime = 1'800'000'000;
    ResumeStore store{optionsOfTests()};
    std::set<std::string> taken;
    ResumeStore::Time now{std::chrono::hours(1)};
};

TEST_F(ResumeStoreTest, WhatIsRememberedIsGivenAwayOnceAndForAMinute) {
    const auto a = begin("a"), b = begin("b");
    store.leave(a.key, now);
    store.leave(b.key, now);
    const auto back = saved(a.token, now + seconds(60));
    ASSERT_TRUE(back);
    EXPECT_EQ(back->id, "a");
    EXPECT_FALSE(saved(a.token, now + seconds(60)));
    EXPECT_FALSE(saved(b.token, now + std::chrono::milliseconds(60'001)));
    EXPECT_EQ(store.size(), 0U) << "what is late is dropped";
    EXPECT_TRUE(taken.empty());
}

TEST_F(ResumeStoreTest, NobodyElsesTokenFits) {
    const auto a = begin("a");
    store.leave(a.key, now);
    for (std::size_t at = 0; at < a.token.size(); ++at) {
        std::string wrong = a.token;
        wrong[at] = wrong[at] == 'A' ? 'B' : 'A';
        EXPECT_FALSE(store.resume(wrong, "anna", now)) << wrong;
    }
    for (const std::string& token : {std::string(), std::string("a"), a.token + "0", "." + a.token})
        EXPECT_FALSE(store.resume(token, "anna", now)) << token;
    EXPECT_FALSE(store.resume(a.token, "berta", now)) << "it is another's";
    EXPECT_FALSE(store.resume(a.token, "", now));
    EXPECT_TRUE(saved(a.token, now)) << "none of which took it away";
}

TEST_F(ResumeStoreTest, TokensDifferAndAreShortEnoughForAHello) {
    std::set<std::string> tokens;
    for (int i = 0; i < 1000; ++i) {
        const auto ticket = store.open({"s0123456789abcdef01234567", "anna"});
        store.forget(ticket->key);
        tokens.insert(ticket->token);
    }
    EXPECT_EQ(tokens.size(), 1000U);
    EXPECT_LT(tokens.begin()->size(), 160U);
}

TEST_F(ResumeStoreTest, AServerOfTheSameKeyBelievesIt) {
    ResumeStore other(optionsOfTests()), stranger(optionsOfTests());
    store.setKeys({"new", "old"});
    other.setKeys({"old", "new"});
    const auto a = begin("a", 4);
    const auto there = other.resume(a.token, "anna", now);
    ASSERT_TRUE(there);
    EXPECT_EQ(there->id, "a");
    EXPECT_EQ(there->turn, 4U);
    EXPECT_FALSE(there->saved) << "it has never shown it";
    EXPECT_FALSE(stranger.resume(a.token, "anna", now)) << "it has a key of its own";
    other.setKeys({"old"});
    EXPECT_FALSE(other.resume(a.token, "anna", now)) << "that key was taken away";
}

// Files are read anew without any of them naming a key: who is connected still holds a token of before.
TEST_F(ResumeStoreTest, ItsOwnKeyStaysTheSame) {
    const auto a = begin("a"), b = begin("b");
    store.setKeys({});
    EXPECT_TRUE(saved(a.token, now));
    store.setKeys({"k"});
    EXPECT_FALSE(saved(b.token, now));
    store.setKeys({});
    EXPECT_TRUE(saved(b.token, now));
}

TEST_F(ResumeStoreTest, ATokenExpires) {
    ResumeStore other(optionsOfTests());
    other.setKeys({"k"});
    store.setKeys({"k"});
    const auto a = begin("a");
    unixTime += 12 * 60 * 60 - 1;
    EXPECT_TRUE(other.resume(a.token, "anna", now));
    unixTime += 1;
    EXPECT_FALSE(other.resume(a.token, "anna", now));
    EXPECT_FALSE(saved(a.token, now));
}

// A replay shows nothing that its owner may not see, and takes nothing from the session that went on.
TEST_F(ResumeStoreTest, AReplayIsGoodForNothingWhereTheSessionIs) {
    const auto first = begin("a");
    store.leave(first.key, now);
    const auto resumed = store.resume(first.token, "anna", now);
    ASSERT_TRUE(resumed);
    EXPECT_FALSE(store.resume(first.token, "anna", now)) << "another one goes on with it, in this moment";
    const auto second = begin("a", 2, resumed->place);
    EXPECT_FALSE(store.resume(first.token, "anna", now));
    EXPECT_TRUE(taken.empty()) << "who goes on with the session does not notice";
    EXPECT_TRUE(store.resume(second.token, "anna", now));
    EXPECT_EQ(taken.size(), 1U);
}

TEST_F(ResumeStoreTest, ASessionThatComesBackFromElsewhereIsNotWhatItWas) {
    const auto first = begin("a");  // whose line is dead, and nobody knows it
    ResumeStore other(optionsOfTests());
    store.setKeys({"k"});
    other.setKeys({"k"});
    const auto there = other.open({"a", "anna", 2});
    const auto back = store.resume(there->token, "anna", now);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->turn, 2U);
    EXPECT_FALSE(back->saved) << "what this server remembers is older than what the other showed";
    EXPECT_EQ(taken, std::set<std::string>{"a"});
    EXPECT_EQ(store.size(), 1U) << "the place of who has come back";
    EXPECT_FALSE(store.resume(first.token, "anna", now)) << "its key is gone, too";
}

// The client knows that its line is dead; the server does not yet.
TEST_F(ResumeStoreTest, ASessionThatIsStillConnectedMovesAndIsTold) {
    const auto a = begin("a");
    const auto back = saved(a.token, now);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->id, "a");
    EXPECT_EQ(taken, std::set<std::string>{"a"});
    store.keep(a.key, {});  // the old connection's last words
    store.leave(a.key, now);
    EXPECT_EQ(store.size(), 0U);
}

TEST_F(ResumeStoreTest, WhatHasEndedOrNeverBegunIsForgotten) {
    const auto a = begin("a");
    store.forget(a.key);
    EXPECT_FALSE(saved(a.token, now));
    const auto b = store.open({"b", "anna"});
    store.leave(b->key, now);
    EXPECT_FALSE(saved(b->token, now));
    EXPECT_EQ(store.size(), 0U);
}

TEST_F(ResumeStoreTest, SoManyAreKeptAndTheFirstThatLeftMakesRoom) {
    const auto here = begin("here");
    std::vector<ResumeStore::Ticket> away;
    for (int i = 0; i < 5; ++i) {
        away.push_back(begin(std::to_string(i)));
        store.leave(away.back().key, now + seconds(i));
    }
    EXPECT_EQ(store.size(), 4U);
    EXPECT_FALSE(saved(away[0].token, now + seconds(5)));
    EXPECT_FALSE(saved(away[1].token, now + seconds(5)));
    for (std::size_t i = 2; i < 5; ++i) EXPECT_TRUE(saved(away[i].token, now + seconds(5))) << i;
    EXPECT_TRUE(saved(here.token, now + seconds(5))) << "who is connected takes nobody's place";
}

TEST_F(ResumeStoreTest, TheNewestStateIsKept) {
    const auto a = begin("a");
    SavedSession session;
    session.id = "a";
    session.cloudId = "town";
    session.view.width = 333;
    session.seq = 17;
    session.limits.fps = 12;
    session.lastFrame = 99;
    store.keep(a.key, session);
    store.leave(a.key, now);
    const auto back = saved(a.token, now);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->cloudId, "town");
    EXPECT_EQ(back->view.width, 333);
    EXPECT_EQ(back->seq, 17U);
    EXPECT_EQ(back->limits.fps, 12);
    EXPECT_EQ(back->lastFrame, 99U);
}

}  // namespace
}  // namespace scancast
