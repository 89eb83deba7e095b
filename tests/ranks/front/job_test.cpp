// What a front's keeper stands on: words of a command line, a process and how it ended, the socket between front and first rank.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <thread>

#include "ranks/front/job_process.hpp"
#include "ranks/front/job_socket.hpp"

namespace scancast {
namespace {

using namespace std::chrono_literals;
using Words = std::vector<std::string>;

TEST(JobWordsTest, AreThoseOfALine) {
    EXPECT_EQ(*wordsOfLine("mpirun -n 4"), (Words{"mpirun", "-n", "4"}));
    EXPECT_EQ(*wordsOfLine("  a\t'b c'  d\"e f\"g\n"), (Words{"a", "b c", "de fg"}));
    EXPECT_EQ(*wordsOfLine("a ''"), (Words{"a", ""}));
    EXPECT_EQ(*wordsOfLine("$(x) ; y"), (Words{"$(x)", ";", "y"})) << "no shell ever reads it";
    for (const char* line : {"", "  \t", "mpirun 'n", "\"a"}) {
        const auto words = wordsOfLine(line);
        ASSERT_FALSE(words) << line;
        EXPECT_EQ(words.error().code, ErrorCode::InvalidArgument);
    }
}

TEST(JobProcessTest, SaysHowItEnded) {
    auto three = JobProcess::start({"sh", "-c", "exit 3"});
    ASSERT_TRUE(three) << three.error().message;
    three->end(20s);
    EXPECT_EQ(three->howItEnded(), "it ended with exit code 3");
    auto long_ = JobProcess::start({"sleep", "1000"});
    ASSERT_TRUE(long_);
    EXPECT_FALSE(long_->hasEnded());
    long_->end();
    EXPECT_EQ(long_->howItEnded(), "it was ended by signal 15");
}

TEST(JobProcessTest, EndsWhatDoesNotListen) {
    auto deaf = JobProcess::start({"sh", "-c", "trap '' TERM; sleep 1000"});
    ASSERT_TRUE(deaf);
    std::this_thread::sleep_for(100ms);
    deaf->end();
    EXPECT_EQ(deaf->howItEnded(), "it was ended by signal 9");
}

TEST(JobProcessTest, CannotStartWhatIsNotThere) {
    const auto none = JobProcess::start({"no-such-mpirun"});
    ASSERT_FALSE(none);
    EXPECT_NE(none.error().message.find("no-such-mpirun cannot be started"), std::string::npos);
}

class JobSocketTest : public ::testing::Test {
  protected:
    void SetUp() override {
        auto door = JobDoor::open();
        ASSERT_TRUE(door) << door.error().message;
        std::jthread rank([&] {
            auto socket = JobSocket::connect(door->path());
            if (socket) first = std::move(*socket);
        });
        auto socket = door->accept([] { return false; });
        ASSERT_TRUE(socket);
        front = std::move(*socket);
    }

    std::unique_ptr<JobSocket> front, first;
};

TEST_F(JobSocketTest, WholeMessagesArrive) {
    const RankBytes long_(3'000'000, std::byte{7});
    const std::array<std::span<const std::byte>, 2> parts{std::span(long_).first(5), std::span(long_)};
    std::jthread sender([&] {
        EXPECT_TRUE(first->send(JobWord::Draw, 9, parts));
        EXPECT_TRUE(first->send(JobWord::Beat));
    });
    const auto head = front->receiveHead();
    ASSERT_TRUE(head);
    EXPECT_EQ(head->word, JobWord::Draw);
    EXPECT_EQ(head->id, 9u);
    const auto body = front->receiveBody(*head);
    ASSERT_TRUE(body);
    EXPECT_EQ(body->size(), 3'000'005u);
    EXPECT_EQ(front->receiveHead()->word, JobWord::Beat);
}

TEST_F(JobSocketTest, WhoEndsOrSaysNothingIsGone) {
    front->setPatience(50ms, 50ms);
    const auto silent = front->receiveHead();
    ASSERT_FALSE(silent);
    EXPECT_EQ(silent.error().code, ErrorCode::Unavailable);
    EXPECT_NE(silent.error().message.find("says nothing"), std::string::npos);
    const RankBytes much(64 << 20);
    EXPECT_FALSE(front->send(JobWord::Draw, 1, much)) << "it takes nothing";
    first.reset();
    const auto ended = front->receiveHead();
    ASSERT_FALSE(ended);
    EXPECT_EQ(ended.error().code, ErrorCode::Unavailable);
}

TEST(JobDoorTest, NobodyComes) {
    auto door = JobDoor::open();
    ASSERT_TRUE(door);
    int asked = 0;
    EXPECT_FALSE(door->accept([&] { return ++asked > 2; }));
    const auto path = door->path();
    door = fail(ErrorCode::Cancelled, "");
    const auto late = JobSocket::connect(path);
    ASSERT_FALSE(late);
    EXPECT_NE(late.error().message.find("same machine"), std::string::npos);
}

}  // namespace
}  // namespace scancast
