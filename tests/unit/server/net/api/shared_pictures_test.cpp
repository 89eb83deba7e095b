#include "server/net/api/shared_pictures.hpp"

#include <gtest/gtest.h>

#include <atomic>

#include "tests/support/serving/fake_painter.hpp"

namespace scancast {
namespace {

class SharedPicturesTest : public ::testing::Test {
  protected:
    PictureOrder order() const { return {cloud, View(), PictureFormat::Depth, false}; }
    PictureDone count() {
        return [this](const Expected<EncodedPicture>& picture) { ++(picture ? good : bad); };
    }
    bool reached(const std::atomic<int>& counter, int value) {
        const auto end = std::chrono::steady_clock::now() + test::FakePainter::patience;
        while (counter < value && std::chrono::steady_clock::now() < end)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return counter == value;
    }

    test::FakePainter painter;
    std::shared_ptr<const Cloud> cloud = test::tinyCloud();
    Metrics metrics{"test"};
    std::atomic<int> good{0}, bad{0};
    std::optional<Scheduler> scheduler;
};

TEST_F(SharedPicturesTest, EqualOnesAreDrawnOnceWhileTheyAreUnderWay) {
    painter.closeGate();
    scheduler.emplace(painter.open(), SchedulerOptions(), metrics);
    const SharedPictures pictures(*scheduler);
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(pictures.order("a", order(), count()));
    EXPECT_TRUE(pictures.order("b", order(), count()));
    EXPECT_EQ(pictures.waiting(), 21U);
    painter.openGate();
    EXPECT_TRUE(reached(good, 21));
    EXPECT_EQ(pictures.waiting(), 0U);
    EXPECT_EQ(painter.begun().size(), 2U);
    EXPECT_TRUE(pictures.order("a", order(), count()));
    EXPECT_TRUE(reached(good, 22));
    EXPECT_EQ(painter.begun().size(), 3U) << "what is done is not kept";
}

TEST_F(SharedPicturesTest, WhoLeavesIsForgottenAndTheLastOneEndsThePicture) {
    painter.closeGate();
    scheduler.emplace(painter.open(), SchedulerOptions(), metrics);
    const SharedPictures pictures(*scheduler);
    std::vector<std::stop_source> clients(3);
    EXPECT_FALSE(pictures.join("a", count(), {})) << "nothing is under way";
    ASSERT_TRUE(pictures.order("a", order(), count(), clients[0].get_token()));
    EXPECT_TRUE(pictures.join("a", count(), clients[1].get_token()));
    ASSERT_TRUE(pictures.order("a", order(), count(), clients[2].get_token()));
    ASSERT_TRUE(painter.waitBegun(1));
    clients[0].request_stop();
    clients[2].request_stop();
    EXPECT_EQ(pictures.waiting(), 1U);
    EXPECT_EQ(painter.cancelled(), 0) << "one still waits";
    clients[1].request_stop();
    EXPECT_EQ(pictures.waiting(), 0U);
    EXPECT_TRUE(test::soon([&] { return painter.cancelled() == 1 && scheduler->idle(); }));
    EXPECT_EQ(good + bad, 0) << "nobody is told who has gone";
    // Another of that tag is another picture.
    ASSERT_TRUE(pictures.order("a", order(), count()));
    painter.openGate();
    EXPECT_TRUE(reached(good, 1));
    EXPECT_EQ(bad, 0);
}

TEST_F(SharedPicturesTest, WhoHasGoneBeforeLeavesNothing) {
    scheduler.emplace(painter.open(), SchedulerOptions(), metrics);
    const SharedPictures pictures(*scheduler);
    std::stop_source gone;
    gone.request_stop();
    ASSERT_TRUE(pictures.order("a", order(), count(), gone.get_token()));
    EXPECT_TRUE(test::soon([&] { return scheduler->idle(); }));
    EXPECT_EQ(pictures.waiting(), 0U);
    EXPECT_EQ(good + bad, 0);
    ASSERT_TRUE(pictures.order("a", order(), count()));
    EXPECT_TRUE(reached(good, 1));
}

TEST_F(SharedPicturesTest, ComeAndGoByManyThreads) {
    scheduler.emplace(painter.open(), SchedulerOptions(), metrics);
    const SharedPictures pictures(*scheduler);
    std::vector<std::thread> crowd;
    std::atomic<int> asked{0};
    for (int t = 0; t < 4; ++t) {
        crowd.emplace_back([&, t] {
            for (int i = 0; i < 300; ++i) {
                std::stop_source client;
                const bool stays = (i + t) % 3 == 0;
                const auto token = stays ? std::stop_token() : client.get_token();
                if (!pictures.order(i % 2 ? "a" : "b", order(), stays ? count() : PictureDone([](auto) {}),
                                    token))
                    continue;
                asked += stays;
                client.request_stop();
            }
        });
    }
    for (std::thread& thread : crowd) thread.join();
    EXPECT_TRUE(test::soon([&] { return good + bad == asked; })) << good << " + " << bad << " of " << asked;
    EXPECT_TRUE(test::soon([&] { return scheduler->idle(); }));
    EXPECT_EQ(pictures.waiting(), 0U);
}

TEST_F(SharedPicturesTest, AFailureIsEverybodys) {
    painter.closeGate();
    scheduler.emplace(painter.open(), SchedulerOptions(), metrics);
    const SharedPictures pictures(*scheduler);
    painter.failWith(Error{ErrorCode::Internal, "broken", {}});
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(pictures.order("a", order(), count()));
    painter.openGate();
    EXPECT_TRUE(reached(bad, 3));
    EXPECT_EQ(good, 0);
}

TEST_F(SharedPicturesTest, WhoComesToAFullQueueIsRefusedUnlessThePictureIsComing) {
    painter.closeGate();
    SchedulerOptions options;
    options.maxSnapshots = 1;
    scheduler.emplace(painter.open(), options, metrics);
    const SharedPictures pictures(*scheduler);
    EXPECT_TRUE(pictures.order("a", order(), count()));
    ASSERT_TRUE(painter.waitBegun(1));
    EXPECT_TRUE(pictures.order("b", order(), count()));
    EXPECT_FALSE(pictures.order("c", order(), count()));
    EXPECT_FALSE(pictures.order("c", order(), count())) << "the refused one left nothing behind";
    EXPECT_TRUE(pictures.order("b", order(), count()));
    painter.openGate();
    EXPECT_TRUE(reached(good, 3));
    EXPECT_EQ(bad, 0);
}

}  // namespace
}  // namespace scancast
