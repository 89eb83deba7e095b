#include "remote/answers.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

TEST(RemoteAnswersTest, readsContentRanges) {
    EXPECT_EQ(parseContentRange("bytes 0-99/1234"), (ContentRange{0, 99, 1234}));
    EXPECT_EQ(parseContentRange(" Bytes 5-5/6 "), (ContentRange{5, 5, 6}));
    for (const char* wrong :
         {"", "bytes", "bytes ", "bytes 0-99/*", "bytes */100", "bytes 5-4/10", "bytes 0-10/10",
          "bytes -1-4/10", "bytes 0-9/10 ,", "items 0-9/10", "bytes 0-9", "bytes 0-9/",
          "bytes 0-99999999999999999999/99999999999999999999", "bytes=0-9/10"})
        EXPECT_FALSE(parseContentRange(wrong)) << wrong;
}

TEST(RemoteAnswersTest, readsCodesOfS3AndNothingElse) {
    EXPECT_EQ(s3ErrorCode("<Error><Code>NoSuchKey</Code><Message>x</Message>"), "NoSuchKey");
    for (const char* none :
         {"", "<Code>", "<Code>NoSuch", "<Code></Code>", "<Code>a b</Code>", "<Code>&#27;</Code>"})
        EXPECT_EQ(s3ErrorCode(none), "") << none;
    EXPECT_EQ(s3ErrorCode("<Code>" + std::string(65, 'a') + "</Code>"), "");
}

TEST(RemoteAnswersTest, headsBeginAnewBehindRedirections) {
    AnswerHead head;
    for (const char* line : {"HTTP/1.1 302 Found\r\n", "ETag: \"old\"\r\n", "\r\n", "HTTP/2 206 \r\n",
                             "CONTENT-RANGE: bytes 0-0/9\r\n", "etag:W/\"weak\"\r\n", "nonsense\r\n"})
        head.add(line);
    EXPECT_EQ(head.status, 206);
    EXPECT_EQ(head.contentRange, "bytes 0-0/9");
    EXPECT_EQ(head.etag, "W/\"weak\"");
    EXPECT_EQ((ObjectState{9, head.etag, ""}.strongTag()), "") << "If-Match never holds for a weak one";
    head.add("ETag: \"" + std::string(2000, 'x') + "\"");
    EXPECT_EQ(head.etag, "W/\"weak\"");
}

TEST(RemoteAnswersTest, believesOnlyThePartThatWasAskedForOfTheObjectThatWasOpened) {
    const AnswerHead sound{206, "bytes 10-19/100", "", "\"tag\"", "", ""};
    const ObjectState state{100, "\"tag\"", ""};
    EXPECT_EQ(judge(sound, 10, 10, nullptr), state);
    EXPECT_TRUE(judge(sound, 10, 10, &state));
    const auto kind = [](const tl::expected<ObjectState, RequestFault>& judged) {
        return judged.error().kind;
    };
    EXPECT_EQ(kind(judge(sound, 10, 11, nullptr)), RequestFault::Kind::Unsuitable);
    EXPECT_EQ(kind(judge(sound, 9, 10, nullptr)), RequestFault::Kind::Unsuitable);
    const AnswerHead end{206, "bytes 90-99/100", "", "\"tag\"", "", ""};
    EXPECT_TRUE(judge(end, 90, 64, &state)) << "where it ends there is less";
    for (const ObjectState& other :
         {ObjectState{101, "\"tag\"", ""}, {100, "\"new\"", ""}, {100, "\"tag\"", "Thu"}})
        EXPECT_EQ(kind(judge(sound, 10, 10, &other)), RequestFault::Kind::Changed);
    const auto answers = [](long status) {
        AnswerHead head;
        head.status = status;
        return head;
    };
    for (const long gone : {412L, 416L})
        EXPECT_EQ(kind(judge(answers(gone), 0, 1, &state)), RequestFault::Kind::Changed);
    EXPECT_EQ(kind(judge(answers(412), 0, 1, nullptr)), RequestFault::Kind::Refused);
    EXPECT_EQ(kind(judge(answers(416), 0, 1, nullptr)), RequestFault::Kind::Unsuitable) << "it is empty";
    EXPECT_EQ(kind(judge(answers(404), 0, 1, nullptr)), RequestFault::Kind::Refused);
    EXPECT_EQ(kind(judge(answers(500), 0, 1, nullptr)), RequestFault::Kind::Unreachable);
    EXPECT_EQ(kind(judge(answers(200), 0, 1, nullptr)), RequestFault::Kind::Unsuitable);
    AnswerHead slow = answers(429);
    slow.retryAfter = "7";
    EXPECT_EQ(judge(slow, 0, 1, nullptr).error().after, std::chrono::seconds(7));
}

}  // namespace
}  // namespace scancast
