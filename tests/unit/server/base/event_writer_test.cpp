#include "server/base/event_writer.hpp"

#include <fcntl.h>

#include <algorithm>

#include "tests/support/serving/log_file.hpp"

namespace scancast {
namespace {

const std::string forging = "GET /\x1b[2J\xC2\x9B\n12:00:00 info: forged";

TEST(EventWriter, TextIsOneLineThatATerminalDoesNotObey) {
    test::LogFile log;
    EXPECT_TRUE(log.writer("info", "text")->write(LogLevel::Info, forging, {}));
    EXPECT_TRUE(log.text().ends_with(" info: GET /?[2J? 12:00:00 info: forged\n")) << log.text();
    EXPECT_EQ(std::ranges::count(log.text(), '\n'), 1);
}

TEST(EventWriter, JsonHasTheFieldsAndTheSentence) {
    test::LogFile log;
    EXPECT_TRUE(log.writer()->write(LogLevel::Info, forging, {{"status", 200}}));
    EXPECT_EQ(log.text().find('\x1b'), std::string::npos);
    ASSERT_EQ(log.events().size(), 1u);
    const auto line = log.events().front();
    EXPECT_EQ(line.at("status"), 200);
    EXPECT_EQ(line.at("message"), forging);
    EXPECT_EQ(line.at("level"), "info");
    const std::string time = line.at("time");
    EXPECT_EQ(time.size(), std::string("2026-11-25T01:02:03.456Z").size()) << time;
}

TEST(EventWriter, LinesAreShortAndStillJson) {
    for (const std::string format : {"text", "json"}) {
        test::LogFile log;
        const std::string longText(100'000, 'x');
        EXPECT_TRUE(log.writer("info", format)->write(LogLevel::Info, longText, {{"path", longText}}));
        EXPECT_LE(log.text().size(), 4096u);
        EXPECT_EQ(std::ranges::count(log.text(), '\n'), 1);
        if (format == "json") {
            EXPECT_EQ(log.events().size(), 1u);
        }
    }
}

TEST(EventWriter, LevelsAreThoseOfTheLog) {
    test::LogFile log;
    EXPECT_TRUE(log.writer("warn")->write(LogLevel::Info, "no", {}));
    EXPECT_TRUE(log.writer("info")->write(LogLevel::Debug, "no", {}));
    EXPECT_EQ(log.text(), "");
    EXPECT_TRUE(log.writer("debug")->write(LogLevel::Debug, "yes", {}));
    EXPECT_EQ(log.events().size(), 1u);
    EXPECT_EQ(EventWriter::create("loud", "text").error().field, "log-level");
    EXPECT_EQ(EventWriter::create("info", "xml").error().field, "log-format");
}

// A pipe that nobody reads, as when the log's collector hangs: it would wait here for ever.
TEST(EventWriter, NeverWaitsForWhoReadsTheLog) {
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe2(ends.data(), O_CLOEXEC), 0);
    auto writer = *EventWriter::create("info", "text", ends[1]);
    int written = 0;
    constexpr int lines = 10'000;
    for (int i = 0; i < lines; ++i) written += writer->write(LogLevel::Info, "a line", {}) ? 1 : 0;
    EXPECT_GT(written, 100);
    EXPECT_LT(written, lines);
    std::array<char, 65536> read{};
    EXPECT_GT(::read(ends[0], read.data(), read.size()), 0);
    EXPECT_TRUE(writer->write(LogLevel::Info, "there is room again", {}));
    ::close(ends[0]);
    ::close(ends[1]);
}

}  // namespace
}  // namespace scancast
