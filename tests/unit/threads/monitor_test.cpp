// The monitor itself, in every order that its users' critical sections can have
// (tests/support/interleavings.hpp), and with real threads where stop tokens come in.
#include "threads/monitor.hpp"

#include <gtest/gtest.h>

#include <future>

#include "tests/support/interleavings.hpp"

namespace scancast {
namespace {

using test::Interleavings;
using Stepped = BasicMonitor<test::SteppedMutex, test::SteppedCondition>;
using Clock = Stepped::Clock;

/// A place for one thing, with waits at both ends.
struct Place {
    Stepped monitor;
    bool full = false;
    void put() {
        Stepped::Lock lock(monitor);
        monitor.wait(lock, [this] { return !full; });
        full = true;
    }
    void take() {
        Stepped::Lock lock(monitor);
        monitor.wait(lock, [this] { return full; });
        full = false;
    }
};

Interleavings::Program producersAndAConsumer(int producers, int each) {
    const auto place = std::make_shared<Place>();
    Interleavings::Program program;
    for (int i = 0; i < producers; ++i) {
        program.push_back([place, each] {
            for (int k = 0; k < each; ++k) place->put();
        });
    }
    program.push_back([place, all = producers * each] {
        for (int k = 0; k < all; ++k) place->take();
    });
    return program;
}

TEST(Monitor, NobodyIsForgottenInAnyOrder) {
    const auto one = Interleavings::explore([] { return producersAndAConsumer(1, 3); });
    EXPECT_EQ(one.stuck, "");
    EXPECT_GT(one.orders, 50U);
    const auto two = Interleavings::explore([] { return producersAndAConsumer(2, 1); });
    EXPECT_EQ(two.stuck, "");
    EXPECT_GT(two.orders, 50U);
}

// Three of the scheduler's loops in miniature: what lacks blocks goes to the thread that waits for them,
// which keeps one at a time, and from there back in line.
template <class Wait, class LetGo>
Interleavings::Program schedulerInMiniature(Wait wait, LetGo letGo) {
    struct State {
        test::SteppedMutex mutex;
        test::SteppedCondition render, prepare;
        Stepped monitor;
        int asked = 2, toPrepare = 0, prepared = 0, drawn = 0;
    };
    const auto state = std::make_shared<State>();
    const auto renders = [state, wait, letGo] {
        while (state->drawn < 2) {
            wait(
                *state, state->render, [&s = *state] { return s.asked + s.prepared > 0; },
                [&s = *state, letGo] {
                    if (s.prepared > 0) {
                        --s.prepared, ++s.drawn;
                        letGo(s, false);
                    } else {
                        --s.asked, ++s.toPrepare;
                        letGo(s, true);
                    }
                });
        }
    };
    const auto prepares = [state, wait] {
        for (int i = 0; i < 2; ++i) {
            wait(
                *state, state->prepare, [&s = *state] { return s.toPrepare > 0 && s.prepared == 0; },
                [&s = *state] {
                    --s.toPrepare, ++s.prepared;
                    s.render.notify_one();
                });
        }
    };
    return {renders, prepares};
}

TEST(Monitor, WhatTheSchedulerOnceForgotItCannotForget) {
    const auto byHand = [](auto& s, auto& condition, auto isDue, auto step) {
        std::unique_lock lock(s.mutex);
        while (!isDue()) condition.wait(lock);
        step();
    };
    const auto toldWhereThoughtOf = [](auto& s, bool thoughtOf) {
        if (thoughtOf) s.prepare.notify_one();
    };
    const auto before =
        Interleavings::explore([&] { return schedulerInMiniature(byHand, toldWhereThoughtOf); });
    EXPECT_NE(before.stuck, "") << "taking what is prepared must wake who prepares, and here it does not";

    const auto toldAlways = [](auto& s, bool) { s.prepare.notify_one(); };
    EXPECT_EQ(Interleavings::explore([&] { return schedulerInMiniature(byHand, toldAlways); }).stuck, "");

    const auto byMonitor = [](auto& s, auto&, auto isDue, auto step) {
        Stepped::Lock lock(s.monitor);
        s.monitor.wait(lock, isDue);
        step();
    };
    const auto toldNobody = [](auto&, bool) {};
    const auto after = Interleavings::explore([&] { return schedulerInMiniature(byMonitor, toldNobody); });
    EXPECT_EQ(after.stuck, "");
    EXPECT_GT(after.orders, 1U);
}

// The shape of a thread that keeps deadlines: it sleeps until the first, and an earlier one may come.
TEST(Monitor, AnEarlierDeadlineWakesWhoSleepsTowardsALaterOne) {
    struct State {
        Stepped monitor;
        Clock::time_point first = Clock::time_point::max();
        std::vector<int> kept;
    };
    const auto at = [](int seconds) { return Clock::time_point(std::chrono::seconds(seconds)); };
    const auto found = Interleavings::explore([&]() -> Interleavings::Program {
        const auto state = std::make_shared<State>();
        const auto adds = [state, at](int seconds) {
            return [state, when = at(seconds)] {
                const Stepped::Lock lock(state->monitor);
                state->first = std::min(state->first, when);
            };
        };
        return {[state, at] {
                    Stepped::Lock lock(state->monitor);
                    Clock::time_point first;
                    do {
                        first = state->first;
                    } while (state->monitor.waitUntil(lock, first, [&] { return state->first < first; }));
                    // Time passes only when nobody can do anything else: by then both have been added.
                    EXPECT_EQ(first, at(10));
                },
                adds(20), adds(10)};
    });
    EXPECT_EQ(found.stuck, "");
    EXPECT_GT(found.orders, 5U);
}

TEST(Monitor, WaitingLetsGoOfWhatWasChangedBefore) {
    // One thread changes what the other waits for, and waits itself without letting go in between.
    const auto found = Interleavings::explore([]() -> Interleavings::Program {
        struct State {
            Stepped monitor;
            bool ping = false, pong = false;
        };
        const auto s = std::make_shared<State>();
        return {[s] {
                    Stepped::Lock lock(s->monitor);
                    s->ping = true;
                    s->monitor.wait(lock, [&] { return s->pong; });
                },
                [s] {
                    Stepped::Lock lock(s->monitor);
                    s->monitor.wait(lock, [&] { return s->ping; });
                    s->pong = true;
                }};
    });
    EXPECT_EQ(found.stuck, "");
}

TEST(Monitor, ADeadlineThatHasPassedIsNoWait) {
    Monitor monitor;
    Monitor::Lock lock(monitor);
    EXPECT_FALSE(monitor.waitUntil(lock, Clock::now() - std::chrono::hours(1), [] { return false; }));
    EXPECT_TRUE(monitor.waitUntil(lock, Clock::now() - std::chrono::hours(1), [] { return true; }));
}

TEST(Monitor, AStopEndsAWaitThatNothingElseWould) {
    Monitor monitor;
    std::stop_source stop;
    std::promise<void> looked;
    bool told = false;
    std::thread waiter([&] {
        Monitor::Lock lock(monitor);
        EXPECT_FALSE(monitor.wait(lock, stop.get_token(), [&] {
            if (!std::exchange(told, true)) looked.set_value();
            return false;
        }));
    });
    looked.get_future().wait();
    stop.request_stop();
    waiter.join();
    Monitor::Lock lock(monitor);
    EXPECT_TRUE(monitor.wait(lock, stop.get_token(), [] { return true; }))
        << "what is there counts nevertheless";
}

}  // namespace
}  // namespace scancast
