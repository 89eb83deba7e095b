#include "server/stream/resume_store.hpp"

#include <gtest/gtest.h>

#include <set>

namespace scancast {
namespace {

using std::chrono::seconds;

class ResumeStoreTest : public ::testing::Test {
  protected:
    ResumeStore::Ticket begin(const std::string& id) {
        auto ticket = store.open([this, id] { taken.insert(id); });
        SavedSession session;
        session.id = id;
        store.keep(ticket->key, session);
        return *ticket;
    }

    ResumeOptions options{seconds(60), 3};
    ResumeStore store{options};
    std::set<std::string> taken;
    ResumeStore::Time now{std::chrono::hours(1)};
};

TEST_F(ResumeStoreTest, ATokenIsGoodOnceAndForAMinute) {
    const auto a = begin("a"), b = begin("b");
    store.leave(a.key, now);
    store.leave(b.key, now);
    const auto back = store.resume(a.token, now + seconds(60));
    ASSERT_TRUE(back);
    EXPECT_EQ(back->id, "a");
    EXPECT_FALSE(store.resume(a.token, now + seconds(60)));
    EXPECT_FALSE(store.resume(b.token, now + std::chrono::milliseconds(60'001)));
    EXPECT_EQ(store.size(), 0U) << "what is late is dropped";
    EXPECT_TRUE(taken.empty());
}

TEST_F(ResumeStoreTest, NobodyElsesTokenFits) {
    const auto a = begin("a");
    store.leave(a.key, now);
    std::string wrong = a.token;
    wrong.back() = wrong.back() == '0' ? '1' : '0';
    for (const std::string& token : {std::string(), std::string("a"), wrong, a.token + "0"})
        EXPECT_FALSE(store.resume(token, now)) << token;
    EXPECT_TRUE(store.resume(a.token, now));
}

TEST_F(ResumeStoreTest, TokensAreLongAndDiffer) {
    std::set<std::string> tokens;
    for (int i = 0; i < 1000; ++i) tokens.insert(store.open({})->token);
    EXPECT_EQ(tokens.size(), 1000U);
    EXPECT_EQ(tokens.begin()->size(), 64U) << "256 bits in hexadecimal digits";
}

// The client knows that its line is dead; the server does not yet.
TEST_F(ResumeStoreTest, ASessionThatIsStillConnectedMovesAndIsTold) {
    const auto a = begin("a");
    const auto back = store.resume(a.token, now);
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
    EXPECT_FALSE(store.resume(a.token, now));
    const auto b = store.open({});
    store.leave(b->key, now);
    EXPECT_FALSE(store.resume(b->token, now));
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
    EXPECT_FALSE(store.resume(away[0].token, now + seconds(5)));
    EXPECT_FALSE(store.resume(away[1].token, now + seconds(5)));
    for (std::size_t i = 2; i < 5; ++i) EXPECT_TRUE(store.resume(away[i].token, now + seconds(5))) << i;
    EXPECT_TRUE(store.resume(here.token, now + seconds(5))) << "who is connected takes nobody's place";
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
    const auto back = store.resume(a.token, now);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->cloudId, "town");
    EXPECT_EQ(back->view.width, 333);
    EXPECT_EQ(back->seq, 17U);
    EXPECT_EQ(back->limits.fps, 12);
    EXPECT_EQ(back->lastFrame, 99U);
}

}  // namespace
}  // namespace scancast
