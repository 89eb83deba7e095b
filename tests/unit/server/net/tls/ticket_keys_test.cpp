// Keys of tickets over hours, in a time of the test's own.
#include "server/net/tls/ticket_keys.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

using std::chrono::hours;
using std::chrono::minutes;

class TicketKeysTest : public ::testing::Test {
  protected:
    static constexpr hours life = TicketKeys::life;
    const TicketKeys::Time start{hours(1000)};
    TicketKeys keys;
};

TEST_F(TicketKeysTest, AKeySealsForItsLifeAndThenAnotherDoes) {
    const auto first = keys.sealing(start), later = keys.sealing(start + life - minutes(1)),
               second = keys.sealing(start + life);
    ASSERT_TRUE(first && later && second);
    EXPECT_EQ(first->name, later->name);
    EXPECT_NE(first->name, second->name);
    EXPECT_NE(first->cipher, second->cipher);
    EXPECT_NE(first->mac, second->mac);
    EXPECT_NE(first->cipher, first->mac);
}

TEST_F(TicketKeysTest, AKeyOpensForAsLongAgainAndNoLonger) {
    const auto first = keys.sealing(start);
    const auto second = keys.sealing(start + life);
    ASSERT_TRUE(first && second);
    const auto opened = keys.opening(first->name, start + 2 * life - minutes(1));
    ASSERT_TRUE(opened);
    EXPECT_EQ(opened->cipher, first->cipher);
    EXPECT_TRUE(keys.opening(second->name, start + 2 * life - minutes(1)));
    EXPECT_FALSE(keys.opening(first->name, start + 2 * life));
    EXPECT_TRUE(keys.opening(second->name, start + 2 * life));
}

TEST_F(TicketKeysTest, ThatNobodyCameForADayMakesNoKeyLiveLonger) {
    const auto first = keys.sealing(start);
    ASSERT_TRUE(first);
    EXPECT_FALSE(keys.opening(first->name, start + hours(24)));
    EXPECT_FALSE(TicketKeys().opening(first->name, start)) << "another server's";
}

}  // namespace
}  // namespace scancast
