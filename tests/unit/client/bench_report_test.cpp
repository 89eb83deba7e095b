#include "client/cpp/program/bench_report.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numeric>

namespace scancast::client {
namespace {

TEST(BenchReport, PercentilesAreNearestRanks) {
    std::vector<double> hundred(100);
    std::iota(hundred.rbegin(), hundred.rend(), 1);
    EXPECT_EQ(percentile(hundred, 50), 50);
    EXPECT_EQ(percentile(hundred, 99), 99);
    EXPECT_EQ(percentile(hundred, 100), 100);
    EXPECT_EQ(percentile(hundred, 0), 1);
    EXPECT_EQ(percentile({7}, 99), 7);
    EXPECT_EQ(percentile({1, 2}, 50), 1);
    EXPECT_EQ(percentile({}, 50), 0);
}

TEST(BenchReport, EachBehaviourIsAGroup) {
    BenchOptions options;
    options.seconds = 2;
    BenchResult fast, slower, idle;
    fast.frames = 40;
    fast.latencies = {10, 20, 30};
    fast.finalMs = 300;
    slower.frames = 20;
    slower.latencies = {40};
    slower.error = "gone";
    idle.behaviour = Behaviour::Idle;
    idle.answerMs = 12;
    const auto report = benchReport(options, {fast, slower, idle});
    ASSERT_EQ(report["groups"].size(), 2U);
    const auto& moving = report["groups"][0];
    EXPECT_EQ(moving["behaviour"], "moving");
    EXPECT_EQ(moving["sessions"], 2);
    EXPECT_EQ(moving["failed"], 1);
    EXPECT_EQ(moving["errors"], nlohmann::json({"gone"}));
    EXPECT_EQ(moving["framesPerSecond"]["min"], 10);
    EXPECT_EQ(moving["framesPerSecond"]["max"], 20);
    EXPECT_EQ(moving["latencyMs"]["count"], 4);
    EXPECT_EQ(moving["latencyMs"]["p50"], 20);
    EXPECT_EQ(moving["finalMs"]["count"], 1);
    EXPECT_TRUE(moving["detail"].is_null()) << "nothing was told";
    EXPECT_EQ(report["groups"][1]["answerMs"]["max"], 12);
    const auto text = benchText(report);
    for (const auto* words : {"2 moving", "1 FAILED", "gone", "1 idle", "p50 20.0"})
        EXPECT_NE(text.find(words), std::string::npos) << words << " in\n" << text;
}

}  // namespace
}  // namespace scancast::client
