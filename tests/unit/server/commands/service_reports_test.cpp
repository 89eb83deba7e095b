#include "server/commands/service_reports.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

using namespace std::chrono_literals;
using Clock = ServiceReports::Clock;

class ServiceReportsTest : public ::testing::Test {
  protected:
    /// What is due, and arrives.
    std::string tell() {
        std::string lines = reports.due(state, now);
        reports.told(state, now);
        return lines;
    }
    ServiceReports reports{40s};
    ServiceState state;
    Clock::time_point now{1h};
};

TEST_F(ServiceReportsTest, EverythingIsSaidOnce) {
    state.status = "Opening the device";
    EXPECT_EQ(tell(), "STATUS=Opening the device\nWATCHDOG=1\n");
    EXPECT_EQ(tell(), "");
    state.ready = true;
    state.status = "drawing";
    EXPECT_EQ(tell(), "READY=1\nSTATUS=drawing\n");
    EXPECT_EQ(tell(), "");
    state.stopping = true;
    EXPECT_EQ(tell(), "STOPPING=1\n");
    EXPECT_EQ(tell(), "");
}

TEST_F(ServiceReportsTest, AReloadIsBetweenItsBeginningAndTheNextReady) {
    state.ready = true;
    EXPECT_EQ(tell(), "READY=1\nWATCHDOG=1\n");
    state.reloading = true;
    EXPECT_EQ(tell(), "RELOADING=1\nMONOTONIC_USEC=3600000000\n");
    EXPECT_EQ(tell(), "");
    state.reloading = false;
    EXPECT_EQ(tell(), "READY=1\n");
    EXPECT_EQ(tell(), "");
}

TEST_F(ServiceReportsTest, WhoIsNotReadyDoesNotReload) {
    state.reloading = true;
    EXPECT_EQ(tell(), "WATCHDOG=1\n");
    state.reloading = false;
    EXPECT_EQ(tell(), "");
    state.ready = true;
    EXPECT_EQ(tell(), "READY=1\n");
}

TEST_F(ServiceReportsTest, WhatDidNotArriveIsSaidAgain) {
    state.ready = true;
    state.status = "drawing";
    const std::string lines = reports.due(state, now);
    EXPECT_EQ(lines, "READY=1\nSTATUS=drawing\nWATCHDOG=1\n");
    EXPECT_EQ(reports.due(state, now + 1s), lines);
}

TEST_F(ServiceReportsTest, SignsOfLifeComeFourTimesInEachPeriod) {
    int signs = 0;
    for (int second = 0; second < 400; ++second, now += 1s) signs += tell() == "WATCHDOG=1\n";
    EXPECT_EQ(signs, 40);
}

TEST_F(ServiceReportsTest, AThreadThatDoesNotComeBackEndsThem) {
    EXPECT_EQ(tell(), "WATCHDOG=1\n");
    now += 15s;
    state.silence = 20s;  // half of the period: pictures may take that long
    EXPECT_FALSE(reports.holdsBack(state));
    EXPECT_EQ(tell(), "WATCHDOG=1\n");
    now += 15s;
    state.silence = 20001ms;
    EXPECT_TRUE(reports.holdsBack(state));
    EXPECT_EQ(tell(), "");
    state.silence = 0ms;  // it came back
    EXPECT_EQ(tell(), "WATCHDOG=1\n");
}

TEST_F(ServiceReportsTest, WithoutAWatchdogNobodyIsWaitedFor) {
    reports = ServiceReports(std::nullopt);
    state.silence = 1h;
    EXPECT_FALSE(reports.holdsBack(state));
    EXPECT_EQ(tell(), "");
}

}  // namespace
}  // namespace scancast
