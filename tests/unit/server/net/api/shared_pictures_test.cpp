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
