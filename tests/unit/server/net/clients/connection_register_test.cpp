// Who gets a place, and who gives his up for it.
#include "server/net/clients/connection_register.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <thread>

#include "tests/support/sized.hpp"

namespace scancast {
namespace {

struct FakeConnection final : Connection {
    void shutDown() override { ++asked; }
    std::atomic<int> asked{0};
};

/// A connection with its place.
struct Connected {
    std::shared_ptr<FakeConnection> connection = std::make_shared<FakeConnection>();
    ConnectionRegister::Place place;
    bool goes() const { return connection->asked > 0; }
};

class ConnectionRegisterTest : public ::testing::Test {
  protected:
    ConnectionRegister::Admitted<Connected> come(const std::string& name, bool limited = true) {
        auto place = connections.enter({name, limited});
        if (!place) return tl::unexpected(place.error());
        Connected client;
        client.place = std::move(*place);
        client.place.heldBy(client.connection);
        return client;
    }
    Connected idle(const std::string& name, bool limited = true) {
        Connected client = come(name, limited).value();
        client.place.idle();
        return client;
    }
    std::string metric(const std::string& name) const {
        const std::string text = metrics.text();
        const auto at = text.find("\n" + name + " ") + 1;
        return text.substr(at + name.size() + 1, text.find('\n', at) - at - name.size() - 1);
    }

    Metrics metrics{"1"};
    ConnectionRegister connections{{.all = 4, .perClient = 3, .leaving = 2}, &metrics};
};

TEST_F(ConnectionRegisterTest, WhenAllAreTakenTheLongestIdleGoes) {
    Connected busy = come("a").value();
    Connected first = idle("a"), second = idle("b"), third = idle("b");
    EXPECT_TRUE(first.place.busy());
    first.place.idle();   // has asked for something since
    second.place.idle();  // still: nothing new
    const auto more = come("c");
    ASSERT_TRUE(more);
    EXPECT_TRUE(second.goes());
    EXPECT_FALSE(busy.goes() || first.goes() || third.goes());
    EXPECT_EQ(metric("scancast_connections_displaced_total"), "1");
    EXPECT_EQ(metric("scancast_connections"), "5") << "until it has left";
    second = {};
    EXPECT_EQ(metric("scancast_connections"), "4");
    EXPECT_EQ(connections.size(), 4U);
}

TEST_F(ConnectionRegisterTest, WhenNoneIsIdleWhoComesIsRefused) {
    std::vector<Connected> all;
    for (const char* name : {"a", "b", "c", "d"}) all.push_back(come(name).value());
    const auto refused = come("e");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error(), ConnectionRefusal::Full);
    EXPECT_EQ(metric("scancast_connections_refused_total{reason=\"full\"}"), "1");
    all.pop_back();
    EXPECT_TRUE(come("e"));
}

TEST_F(ConnectionRegisterTest, OfOneClientsHisOwnGo) {
    Connected other = idle("b");
    Connected first = idle("a"), second = idle("a"), busy = come("a").value();
    const auto fourth = come("a");
    ASSERT_TRUE(fourth);
    EXPECT_TRUE(first.goes()) << "not the other one's, which is idle longer";
    EXPECT_FALSE(other.goes() || second.goes() || busy.goes());
    EXPECT_TRUE(second.place.busy());
    const auto fifth = come("a");
    ASSERT_FALSE(fifth);
    EXPECT_EQ(fifth.error(), ConnectionRefusal::Address);
    EXPECT_EQ(metric("scancast_connections_refused_total{reason=\"address\"}"), "1");
    EXPECT_TRUE(come("c")) << "others have their places";
}

TEST_F(ConnectionRegisterTest, WhoIsNotLimitedMayHaveAll) {
    std::vector<Connected> all;
    for (int i = 0; i < 4; ++i) all.push_back(come("proxy", false).value());
    EXPECT_EQ(come("proxy", false).error(), ConnectionRefusal::Full);
}

TEST_F(ConnectionRegisterTest, WhoWasAskedToLeaveHearsItWithHisNextRequest) {
    Connected first = idle("a");
    std::vector<Connected> others;
    for (const char* name : {"b", "c", "d", "e"}) others.push_back(come(name).value());
    EXPECT_TRUE(first.goes());
    EXPECT_FALSE(first.place.busy());
    first.place.idle();
    EXPECT_FALSE(come("f")) << "it is nobody's victim twice";
}

TEST_F(ConnectionRegisterTest, NotAnyNumberIsLeavingAtATime) {
    std::vector<Connected> all;
    for (const char* name : {"a", "b", "c", "d"}) all.push_back(idle(name));
    for (const char* name : {"e", "f"}) all.push_back(idle(name));
    EXPECT_EQ(come("g").error(), ConnectionRefusal::Full) << "two have not gone yet";
    all.erase(all.begin());
    EXPECT_TRUE(come("g"));
}

TEST_F(ConnectionRegisterTest, ARequestThroughAProxyIsCountedForItsClient) {
    Connected viaProxy = idle("proxy", false), again = idle("proxy", false);
    std::vector<Connected> own;
    for (int i = 0; i < 2; ++i) own.push_back(come("a").value());
    EXPECT_TRUE(viaProxy.place.busy());
    EXPECT_TRUE(viaProxy.place.countFor({"a", true}));
    EXPECT_TRUE(again.place.busy());
    EXPECT_EQ(again.place.countFor({"a", true}).error(), ConnectionRefusal::Address);
    EXPECT_TRUE(again.place.countFor({"b", true})) << "a refusal changes nothing";
    viaProxy.place.idle();
    EXPECT_TRUE(viaProxy.place.countFor({"proxy", false}));
    EXPECT_TRUE(again.place.countFor({"a", true})) << "the other one's request is over";
}

TEST_F(ConnectionRegisterTest, APlaceIsHandedOn) {
    Connected http = idle("a");
    EXPECT_TRUE(http.place.busy());
    Connected session{std::make_shared<FakeConnection>(), std::move(http.place)};
    session.place.heldBy(session.connection);
    http.place.idle();  // has none any more
    std::vector<Connected> others;
    for (const char* name : {"b", "c", "d"}) others.push_back(come(name).value());
    EXPECT_EQ(come("e").error(), ConnectionRefusal::Full) << "a session is not idle";
    connections.shutDownAll();
    EXPECT_EQ(session.connection->asked, 1);
    EXPECT_EQ(http.connection->asked, 0);
}

TEST_F(ConnectionRegisterTest, WhoComesAtTheEndIsSentAway) {
    auto place = connections.enter({"a", true});
    ASSERT_TRUE(place);
    connections.shutDownAll();
    const auto late = std::make_shared<FakeConnection>();
    place->heldBy(late);
    EXPECT_EQ(late->asked, 1) << "nobody had known of it";
    EXPECT_EQ(come("b").error(), ConnectionRefusal::ShuttingDown);
}

TEST_F(ConnectionRegisterTest, RoomIsMadeOfWhoIsIdle) {
    Connected busy = come("a").value(), first = idle("a"), second = idle("b");
    connections.makeRoom();
    EXPECT_TRUE(first.goes());
    EXPECT_FALSE(second.goes() || busy.goes());
}

TEST_F(ConnectionRegisterTest, ManyAtATime) {
    const int rounds = test::sized(2000, 200);
    std::vector<std::thread> crowd;
    for (int t = 0; t < 4; ++t) {
        crowd.emplace_back([&, t] {
            for (int i = 0; i < rounds; ++i) {
                auto client = come(std::string(1, char('a' + (i + t) % 3)));
                if (!client) continue;
                client->place.idle();
                if (client->place.busy()) std::ignore = client->place.countFor({"z", i % 2 == 0});
                client->place.idle();
            }
        });
    }
    for (std::thread& thread : crowd) thread.join();
    EXPECT_EQ(connections.size(), 0U);
    EXPECT_EQ(metric("scancast_connections"), "0");
    for (const char* name : {"a", "b", "c"}) EXPECT_TRUE(come(name)) << "every place has been given back";
}

}  // namespace
}  // namespace scancast
