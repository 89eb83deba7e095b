#include "server/net/worker.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <future>

namespace scancast {
namespace {

TEST(Worker, DoesEverythingInTurn) {
    std::vector<int> done;  // touched by the worker alone until the last task has run
    std::promise<void> last;
    Worker worker(1000);
    for (int i = 0; i < 100; ++i)
        EXPECT_TRUE(worker.post([&done, i](const std::stop_token&) { done.push_back(i); }));
    EXPECT_TRUE(worker.post([&](const std::stop_token&) { last.set_value(); }));
    last.get_future().wait();
    ASSERT_EQ(done.size(), 100U);
    for (int i = 0; i < 100; ++i) EXPECT_EQ(done[std::size_t(i)], i);
}

TEST(Worker, KeepsOnlySoManyWaiting) {
    std::promise<void> begun, go;
    Worker worker(2);  // ends before what its tasks refer to
    EXPECT_TRUE(worker.post([&](const std::stop_token&) {
        begun.set_value();
        go.get_future().wait();
    }));
    begun.get_future().wait();
    EXPECT_TRUE(worker.post([](const std::stop_token&) {}));
    EXPECT_TRUE(worker.post([](const std::stop_token&) {}));
    EXPECT_FALSE(worker.post([](const std::stop_token&) {}));
    go.set_value();
}

TEST(Worker, ATaskThatThrowsEndsAlone) {
    std::promise<void> next;
    Worker worker(10);
    EXPECT_TRUE(worker.post([](const std::stop_token&) { throw std::bad_alloc(); }));
    EXPECT_TRUE(worker.post([&](const std::stop_token&) { next.set_value(); }));
    next.get_future().wait();
}

// It waits, or works on something, when the next thing comes: posted twice, then posted and stopped.
TEST(Worker, TakesWhatComesWhateverItIsDoing) {
    for (const bool busy : {false, true}) {
        for (const bool last : {false, true}) {
            std::promise<void> begun, go, done;
            std::atomic<bool> ranLast{false};
            Worker worker(10);
            if (busy) {
                EXPECT_TRUE(worker.post([&](const std::stop_token&) {
                    begun.set_value();
                    go.get_future().wait();
                }));
                begun.get_future().wait();
            }
            EXPECT_TRUE(worker.post([&](const std::stop_token&) { done.set_value(); }));
            if (last) {
                EXPECT_TRUE(worker.post([&](const std::stop_token&) { ranLast = true; }));
            }
            go.set_value();
            done.get_future().wait();
            worker.stop();
            EXPECT_TRUE(last || !ranLast);
        }
    }
}

TEST(Worker, StoppingEndsWhatRunsAndForgetsTheRest) {
    std::promise<void> begun;
    std::atomic<bool> second{false};
    Worker worker(10);
    EXPECT_TRUE(worker.post([&](const std::stop_token& stop) {
        begun.set_value();
        while (!stop.stop_requested()) std::this_thread::yield();
    }));
    EXPECT_TRUE(worker.post([&](const std::stop_token&) { second = true; }));
    begun.get_future().wait();
    worker.stop();
    EXPECT_FALSE(second);
    EXPECT_FALSE(worker.post([](const std::stop_token&) {}));
}

}  // namespace
}  // namespace scancast
