#include "server/terminal/progress_bar.hpp"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace scancast {
namespace {

std::string reported(ProgressBar::Style style, const std::vector<Progress>& steps) {
    char* text = nullptr;
    std::size_t size = 0;
    std::FILE* out = open_memstream(&text, &size);
    {
        ProgressBar bar(out, style);
        for (const Progress& step : steps) bar.report(step);
    }
    std::fclose(out);
    std::string result(text, size);
    std::free(text);
    return result;
}

TEST(ProgressText, TellsPartRateAndTimeLeft) {
    const std::string text = progressText({"reading", 10'400'000, 20'000'000, "points"}, 4, 0, 10);
    EXPECT_EQ(text, "[=====>    ]  52 %  reading 10.4 M of 20.0 M points  2.60 M/s  4 s left");
    EXPECT_EQ(progressText({"reading", 1500, 0, "points"}, 2, 0, 10), "reading 1.50 k points  750/s");
    EXPECT_EQ(progressText({"sorting", 0, 0, ""}, 0, 0, 10), "sorting 0");
}

TEST(ShortCount, HasThreeDigits) {
    EXPECT_EQ(shortCount(0), "0");
    EXPECT_EQ(shortCount(999), "999");
    EXPECT_EQ(shortCount(999.6), "1.00 k");
    EXPECT_EQ(shortCount(12'345), "12.3 k");
    EXPECT_EQ(shortCount(999'999), "1.00 M");
    EXPECT_EQ(shortCount(1.25e9), "1.25 G");
}

TEST(ShortDuration, ReadsWell) {
    EXPECT_EQ(shortDuration(0.2), "1 s");
    EXPECT_EQ(shortDuration(187), "3:07 min");
    EXPECT_EQ(shortDuration(7500), "2:05 h");
    EXPECT_EQ(shortDuration(-3), "0 s");
}

TEST(ProgressBar, RedrawsOneLineOnATerminalAndCleansUp) {
    const std::string text =
        reported(ProgressBar::Style::Terminal, {{"reading", 1, 4, "points"}, {"reading", 4, 4, "points"}});
    EXPECT_NE(text.find("100 %"), std::string::npos);
    EXPECT_EQ(text.find('\n'), std::string::npos);
    EXPECT_EQ(text.substr(text.size() - 4), "\r\033[K");
}

TEST(ProgressBar, PrintsPlainLinesElsewhereAndEachEndOnce) {
    const std::string text = reported(ProgressBar::Style::Lines, {{"reading", 1, 4, "points"},
                                                                  {"reading", 4, 4, "points"},
                                                                  {"reading", 4, 4, "points"},
                                                                  {"sorting", 2, 2, "nodes"}});
    EXPECT_EQ(text, "100 %  reading 4 of 4 points\n100 %  sorting 2 of 2 nodes\n");
    EXPECT_EQ(reported(ProgressBar::Style::Quiet, {{"reading", 4, 4, "points"}}), "");
}

TEST(ProgressBar, TakesReportsFromSeveralThreads) {
    char* text = nullptr;
    std::size_t size = 0;
    std::FILE* out = open_memstream(&text, &size);
    {
        ProgressBar bar(out, ProgressBar::Style::Terminal);
        const ProgressSink sink = bar.sink();
        std::vector<std::thread> threads;
        for (int t = 0; t < 4; ++t)
            threads.emplace_back([&] {
                for (std::uint64_t i = 0; i < 1000; ++i) sink({"working", i, 1000, "points"});
            });
        for (std::thread& thread : threads) thread.join();
    }
    std::fclose(out);
    EXPECT_GT(size, 0u);
    std::free(text);
}

}  // namespace
}  // namespace scancast
