// The window of a session on lines as they are, in simulated time: how many frames a second arrive, and how long they wait for the
// line. A line that holds n frames cannot carry more than its rate, and a frame that waits longer than the window explains shows a
// queue: both are known from the line, not from the session. Each trace prints what it was, beside two frames as the window.
#include "server/stream/send_window.hpp"

#include <gtest/gtest.h>

#include "tests/support/serving/shaped_session.hpp"

namespace scancast::test {
namespace {

constexpr double mbits = 1e6 / 8;

std::function<double(double)> steady(double value) {
    return [value](double) { return value; };
}

LineSummary seen(const char* what, const ShapedLine& line, double from, double to,
                 const std::function<void(ShapedSession&)>& with = {}) {
    const auto run = [&](std::optional<std::size_t> window) {
        ShapedSession session(line, window);
        if (with) with(session);
        const LineSummary sum = ShapedSession::between(session.run(to), from, to);
        std::cout << fmt::format(
            "{:<36} {:>8} {:5.1f} frames/s, wait for the line {:4.0f} ms, most {:4.0f}, view to frame "
            "{:4.0f} ms, at most {:2} on the way\n",
            what, window ? "two" : "window", sum.framesPerSecond, 1000 * sum.wait, 1000 * sum.mostWait,
            1000 * sum.answer, sum.mostUnacknowledged);
        return sum;
    };
    run(2);
    return run({});
}

TEST(SendWindowTraces, TwoMegabitsAndATenthOfASecondEachWay) {
    const ShapedLine line{steady(2 * mbits), 0.1};
    const LineSummary sum = seen("2 Mbit/s, 100 ms each way", line, 3, 60);
    EXPECT_GE(sum.framesPerSecond, 20);
    EXPECT_LE(sum.mostWait, 0.12);
    EXPECT_LE(sum.wait, 0.06);
}

TEST(SendWindowTraces, FramesThatAreTooLargeForTheLineDoNotQueue) {
    const ShapedLine line{steady(2 * mbits), 0.1};
    const LineSummary sum = seen("the same, larger frames", line, 3, 60,
                                 [](ShapedSession& session) { session.bytesPerPixel = 0.6; });
    EXPECT_GE(sum.framesPerSecond, 10);
    EXPECT_LE(sum.mostWait, 0.25);
    EXPECT_LE(sum.wait, 0.1);
}

TEST(SendWindowTraces, AHome) {
    const ShapedLine line{steady(20 * mbits), 0.01};
    const LineSummary sum = seen("20 Mbit/s, 10 ms", line, 3, 20);
    EXPECT_GE(sum.framesPerSecond, 28);
    EXPECT_LE(sum.mostWait, 0.03);
}

TEST(SendWindowTraces, ALocalNetworkNeedsNoMoreThanTwo) {
    const ShapedLine line{steady(100 * mbits), 0.001};
    const LineSummary sum = seen("100 Mbit/s, 1 ms", line, 3, 20);
    EXPECT_GE(sum.framesPerSecond, 28);
    EXPECT_LE(sum.mostWait, 0.02);
    EXPECT_LE(sum.mostUnacknowledged, 2U);
}

TEST(SendWindowTraces, ASatelliteIsFarNotSlow) {
    const ShapedLine line{steady(20 * mbits), 0.3};
    const LineSummary sum = seen("20 Mbit/s, 300 ms each way", line, 6, 40);
    EXPECT_GE(sum.framesPerSecond, 18);
    EXPECT_LE(sum.mostWait, 0.06);
}

TEST(SendWindowTraces, AStepDownAndUpAgain) {
    const auto bandwidth = [](double t) { return (t > 10 && t < 20 ? 0.5 : 2) * mbits; };
    const ShapedLine line{bandwidth, 0.1};
    const LineSummary down = seen("2, now 0.5 Mbit/s: the first 3 s", line, 10, 13);
    const LineSummary later = seen("0.5 Mbit/s after that", line, 13, 20);
    const LineSummary again = seen("2 Mbit/s again, after 3 s", line, 23, 30);
    // What was on its way cannot be called back: all that 2 Mbit/s held takes four times as long.
    EXPECT_LE(down.mostWait, 4 * 0.25);
    EXPECT_LE(later.mostWait, 0.3);
    EXPECT_GE(later.framesPerSecond, 4);
    EXPECT_GE(again.framesPerSecond, 18);
    EXPECT_LE(again.mostWait, 0.15);
}

// LTE: a random walk between 0.7 and 12 Mbit/s in steps of 100 ms, with jitter of the scheduler's, and a stall now and then.
TEST(SendWindowTraces, ALineThatVaries) {
    std::mt19937 random{11};
    std::vector<double> rates;
    double rate = 4;
    for (int i = 0; i < 700; ++i) {
        rate = std::clamp(rate * std::exp(std::normal_distribution(0.0, 0.2)(random)), 0.7, 12.0);
        rates.push_back(i % 97 == 50 || i % 97 == 51 ? 0 : rate * mbits);
    }
    std::vector<double> later;
    for (int i = 0; i < 7000; ++i) later.push_back(std::uniform_real_distribution(0.0, 0.02)(random));
    const ShapedLine line{[&](double t) { return rates[std::size_t(t * 10)]; }, 0.03,
                          [&](double t) { return later[std::size_t(t * 100)]; }};
    const LineSummary sum = seen("0.7-12 Mbit/s, 30 ms, jitter, stalls", line, 3, 60);
    EXPECT_GE(sum.framesPerSecond, 18);
    EXPECT_LE(sum.wait, 0.05);
    EXPECT_LE(sum.mostWait, 0.6) << "200 ms of nothing included";
}

TEST(SendWindowTraces, JitterOnALongLine) {
    std::mt19937 random{5};
    std::vector<double> later;
    for (int i = 0; i < 6000; ++i) later.push_back(std::uniform_real_distribution(0.0, 0.08)(random));
    const ShapedLine line{steady(8 * mbits), 0.1, [&](double t) { return later[std::size_t(t * 100)]; }};
    const LineSummary sum = seen("8 Mbit/s, 100 ms, up to 80 ms more", line, 3, 60);
    EXPECT_GE(sum.framesPerSecond, 20);
    EXPECT_LE(sum.mostWait, 0.15);
}

TEST(SendWindowTraces, AStallIsWaitedForNotFilled) {
    const auto bandwidth = [](double t) { return t > 10 && t < 14 ? 0 : 4 * mbits; };
    const ShapedLine line{bandwidth, 0.05};
    ShapedSession session(line);
    const auto frames = session.run(30);
    const LineSummary before = ShapedSession::between(frames, 5, 10),
                      after = ShapedSession::between(frames, 15, 20);
    const auto stalled = std::ranges::count_if(
        frames, [](const ArrivedFrame& frame) { return frame.sent > 10.2 && frame.sent < 14; });
    EXPECT_EQ(stalled, 0) << "nothing more is sent into a line that brings nothing back";
    EXPECT_GE(after.framesPerSecond, 0.8 * before.framesPerSecond);
}

TEST(SendWindowTraces, ASlowDecoderIsASlowLine) {
    ShapedLine line{steady(50 * mbits), 0.05};
    line.decodeMs = 80;
    const auto frames = ShapedSession(line).run(40);
    double most = 0, count = 0;
    for (const ArrivedFrame& frame : frames) {
        if (frame.arrived < 5) continue;
        ++count;
        most = std::max(most, frame.acknowledged - frame.arrived - line.way - line.decodeMs / 1000);
    }
    std::cout << fmt::format(
        "a decoder that takes 80 ms, 50 ms each way: {:.1f} frames/s, at most {:.0f} ms before it\n",
        count / 35, 1000 * most);
    EXPECT_GE(count / 35, 10);
    EXPECT_LE(most, 0.2) << "frames that wait at the client's";
}

TEST(SendWindowTraces, AStillInTheWayIsNotSentAfter) {
    const ShapedLine line{steady(2 * mbits), 0.1};
    ShapedSession session(line);
    session.moves = [](double t) { return std::fmod(t, 3) < 2; };
    const auto frames = session.run(60);
    const LineSummary sum = ShapedSession::between(frames, 3, 60);
    EXPECT_GE(sum.framesPerSecond, 0.6 * 20 * 2 / 3);
    EXPECT_LE(sum.mostWait, 0.7) << "what the still takes, and one frame";
}

TEST(SendWindow, BeginsWithTwoAndStaysThereWhereNothingIsAcknowledged) {
    SendWindow window;
    LinkEstimate::Time now{std::chrono::hours(1)};
    EXPECT_EQ(window.frames(now), 2U);
    for (std::uint64_t i = 1; i <= 2; ++i) window.sentMoving(i, 10'000, 0.01, 0, now);
    EXPECT_EQ(window.frames(now + std::chrono::hours(1)), 2U);
}

}  // namespace
}  // namespace scancast::test
