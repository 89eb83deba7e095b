// A front's keeper before a first rank that is a thread of the test: in which order a loss is told, and what is drawn no more.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "ranks/front/job_keeper.hpp"
#include "server/server.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

using namespace std::chrono_literals;

/// Takes its time over a loss, so that whoever is told of it too soon is seen.
struct KeeperListener : JobListener {
    void jobIsUp() override { ++ups; }
    void jobOpened(std::uint64_t, const JobOpened&) override {}
    void jobIsLost() override {
        std::this_thread::sleep_for(50ms);
        ++losses;
    }
    std::atomic<int> ups = 0, losses = 0;
};

class JobKeeperTest : public ::testing::Test {
  protected:
    std::unique_ptr<JobSocket> firstRank() {
        std::string door;
        while (!std::getline(std::ifstream(said), door) || door.empty()) std::this_thread::sleep_for(5ms);
        std::filesystem::remove(said);
        auto socket = JobSocket::connect(door);
        if (!socket) return nullptr;
        if (!(*socket)->send(JobWord::Hello, 0, pack(JobHello{std::string(scancastVersion()), 2})))
            return nullptr;
        return std::move(*socket);
    }

    test::TemporaryFolder folder;
    const std::filesystem::path said = folder.path() / "door";
    const std::shared_ptr<KeeperListener> listener = std::make_shared<KeeperListener>();
    // Its last word is the door; what the others are nobody asks.
    JobKeeper keeper{{"sh", "-c",
                      "for last; do :; done; echo \"$last\" > '" + said.string() + ".part'; mv '" +
                          said.string() + ".part' '" + said.string() + "'; exec sleep 1000"},
                     {"sh", "draw"}};
};

TEST_F(JobKeeperTest, ALossIsToldBeforePicturesAreRefusedAndTwiceOverOneIsRemembered) {
    keeper.begin(listener);
    const RankBytes bad(100, std::byte{1}), good(100, std::byte{2});
    const auto asked = std::make_unique<Drawing>();
    asked->window.width = asked->window.height = 8;
    for (int loss = 1; loss <= 2; ++loss) {
        auto rank = firstRank();
        ASSERT_TRUE(rank);
        while (listener->ups < loss) std::this_thread::sleep_for(5ms);
        EXPECT_FALSE(keeper.isFeared(bad));
        std::jthread dies([&] {
            const auto head = rank->receiveHead();
            EXPECT_TRUE(head && head->word == JobWord::Draw);
            rank->close();
        });
        const auto frame = keeper.draw(bad, *asked, {});
        ASSERT_FALSE(frame);
        EXPECT_EQ(frame.error().code, ErrorCode::Unavailable);
        EXPECT_EQ(listener->losses, loss) << "who prepares again has to know";
    }
    EXPECT_TRUE(keeper.isFeared(bad));
    EXPECT_FALSE(keeper.isFeared(good));
}

}  // namespace
}  // namespace scancast
