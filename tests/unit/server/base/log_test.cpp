#include "server/base/log.hpp"

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "protocol/json_text.hpp"

namespace scancast {
namespace {

/// What the log says to `message`, on standard error.
std::string logged(const std::string& format, const std::string& message) {
    const auto before = spdlog::default_logger();
    testing::internal::CaptureStderr();
    EXPECT_TRUE(setUpLog("info", format));
    spdlog::error("{}", message);
    spdlog::default_logger()->flush();
    spdlog::set_default_logger(before);
    return testing::internal::GetCapturedStderr();
}

// A scan may be called anything, and an importer may say anything of it.
const std::string hostile = "a\x1b[2J\xC2\x9B.las: broken\n12:00:00 error: forged";

TEST(Log, AMessageIsOneLineThatATerminalDoesNotObey) {
    const std::string text = logged("text", hostile);
    EXPECT_TRUE(text.ends_with(" error: a?[2J?.las: broken 12:00:00 error: forged\n")) << text;
    EXPECT_EQ(std::ranges::count(text, '\n'), 1);
}

TEST(Log, JsonKeepsWhatWasSaidAndATerminalDoesNotObeyItEither) {
    const std::string text = logged("json", hostile);
    EXPECT_EQ(std::ranges::count(text, '\n'), 1);
    EXPECT_EQ(text.find('\x1b'), std::string::npos);
    EXPECT_EQ(text.find("\xC2\x9B"), std::string::npos);
    const auto line = parseJson(text);
    ASSERT_TRUE(line) << text;
    EXPECT_EQ(line->at("message"), hostile);
}

TEST(Log, UnknownLevelsAndFormatsAreNamed) {
    EXPECT_EQ(setUpLog("loud", "text").error().field, "log-level");
    EXPECT_EQ(setUpLog("info", "xml").error().field, "log-format");
}

}  // namespace
}  // namespace scancast
