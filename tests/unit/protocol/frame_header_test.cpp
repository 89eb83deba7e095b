#include "protocol/frame_header.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace scancast {
namespace {

using Bytes = std::vector<std::uint8_t>;

FrameHeader sample() {
    FrameHeader header;
    header.still = header.final = true;
    header.pictureLength = 5;
    header.frameId = 0x1122334455667788;
    header.seq = 0x99AABBCCDDEEFF00;
    header.width = 1280;
    header.height = 720;
    header.renderMicroseconds = 4'000'000'000;
    header.encodeMicroseconds = 2500;
    return header;
}

Bytes message(const FrameHeader& header) {
    const auto head = printFrameHeader(header);
    Bytes bytes(head.begin(), head.end());
    for (std::uint32_t i = 0; i < header.pictureLength; ++i)
        bytes.push_back(static_cast<std::uint8_t>(i + 1));
    return bytes;
}

Error refused(const Bytes& bytes) {
    const auto frame = parseFrame(bytes);
    if (!frame) return frame.error();
    ADD_FAILURE() << "accepted";
    return {};
}

TEST(FrameHeader, RoundTrip) {
    for (const bool moving : {true, false}) {
        auto header = sample();
        header.moving = moving;
        header.still = header.final = !moving;
        const auto bytes = message(header);
        const auto frame = parseFrame(bytes);
        ASSERT_TRUE(frame) << frame.error().message;
        EXPECT_EQ(frame->header, header);
        EXPECT_EQ(Bytes(frame->picture.begin(), frame->picture.end()), (Bytes{1, 2, 3, 4, 5}));
    }
}

TEST(FrameHeader, DamageIsABitOfItsOwn) {
    auto header = sample();
    header.damaged = true;
    const auto bytes = message(header);
    EXPECT_EQ(bytes[9], 14) << "still, final, damaged";
    const auto frame = parseFrame(bytes);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(frame->header, header);
}

TEST(FrameHeader, SoIsWhatIsAway) {
    auto header = sample();
    header.moving = header.away = true;
    header.still = header.final = false;
    const auto bytes = message(header);
    EXPECT_EQ(bytes[9], 17) << "moving, away";
    const auto frame = parseFrame(bytes);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(frame->header, header);
}

TEST(FrameHeader, VideoSaysSoAndWhereDecodersMayBegin) {
    auto header = sample();
    header.codec = Codec::H264;
    header.moving = header.key = true;
    header.still = header.final = false;
    const auto bytes = message(header);
    EXPECT_EQ(bytes[8], 2);
    EXPECT_EQ(bytes[9], 33) << "moving, key";
    const auto frame = parseFrame(bytes);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(frame->header, header);
}

TEST(FrameHeader, BytesAreWhereTheTableSays) {
    // Written out by hand from PROTOCOL.md: little-endian, 48 bytes.
    const Bytes expected{'S',  'C',  'F',  'R',  1,    0,    48,   0,    1,    6,    0,    0,
                         5,    0,    0,    0,    0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11,
                         0x00, 0xFF, 0xEE, 0xDD, 0xCC, 0xBB, 0xAA, 0x99, 0x00, 0x05, 0,    0,
                         0xD0, 0x02, 0,    0,    0x00, 0x28, 0x6B, 0xEE, 0xC4, 0x09, 0,    0};
    const auto head = printFrameHeader(sample());
    EXPECT_EQ(Bytes(head.begin(), head.end()), expected);
}

TEST(FrameHeader, EveryTruncationIsTold) {
    const auto whole = message(sample());
    for (std::size_t length = 0; length < whole.size(); ++length)
        EXPECT_EQ(refused(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length))).code,
                  ErrorCode::Truncated)
            << length;
}

TEST(FrameHeader, LongerHeadersOfLaterServersAreSkipped) {
    auto bytes = message(sample());
    bytes[6] = 56;
    bytes.insert(bytes.begin() + 48, {9, 9, 9, 9, 9, 9, 9, 9});
    bytes[9] |= 0xC0;  // flags that nobody knows yet
    bytes[10] = bytes[11] = 0xFF;
    const auto frame = parseFrame(bytes);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(frame->header, sample());
    EXPECT_EQ(frame->picture.front(), 1);
}

/// `appended` stands between header and picture.
Bytes longerMessage(const Bytes& appended) {
    const auto head = printFrameHeader(sample(), appended.size());
    Bytes bytes(head.begin(), head.end());
    bytes.insert(bytes.end(), appended.begin(), appended.end());
    bytes.insert(bytes.end(), {1, 2, 3, 4, 5});
    return bytes;
}

TEST(FrameHeader, DepthStandsBehindTheFieldsAndWhatFollowsItIsSkipped) {
    const Bytes depth{2, 0, 2, 0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 7, 8, 9};
    for (const std::size_t behind : {0U, 5U}) {
        Bytes appended = depth;
        appended.resize(depth.size() + behind);
        const auto bytes = longerMessage(appended);
        EXPECT_EQ(bytes[6], 48 + appended.size());
        const auto frame = parseFrame(bytes);
        ASSERT_TRUE(frame) << frame.error().message;
        EXPECT_EQ(frame->header, sample()) << "as without it";
        EXPECT_EQ(Bytes(frame->picture.begin(), frame->picture.end()), (Bytes{1, 2, 3, 4, 5}));
        EXPECT_EQ(Bytes(frame->packedDepth.begin(), frame->packedDepth.end()), depth);
    }
    EXPECT_TRUE(parseFrame(message(sample()))->packedDepth.empty());
    EXPECT_TRUE(parseFrame(longerMessage(Bytes(16)))->packedDepth.empty()) << "a length of 0 is none";
    EXPECT_TRUE(parseFrame(longerMessage(Bytes(15, 255)))->packedDepth.empty())
        << "the fields are not all there";
    Bytes beyond = depth;
    beyond[4] = 4;
    EXPECT_EQ(refused(longerMessage(beyond)).code, ErrorCode::Malformed);
    EXPECT_EQ(refused(longerMessage(beyond)).field, "depthLength");
    beyond[7] = 255;
    EXPECT_EQ(refused(longerMessage(beyond)).field, "depthLength");
}

TEST(FrameHeader, EachWrongFieldIsNamed) {
    struct Case {
        std::size_t at;
        std::uint8_t value;
        ErrorCode code;
        const char* field;
    };
    for (const auto& [at, value, code, field] :
         {Case{0, 'X', ErrorCode::Malformed, "magic"}, Case{3, 0, ErrorCode::Malformed, "magic"},
          Case{4, 2, ErrorCode::Unsupported, "version"}, Case{5, 1, ErrorCode::Unsupported, "version"},
          Case{6, 47, ErrorCode::Malformed, "headerLength"}, Case{6, 0, ErrorCode::Malformed, "headerLength"},
          Case{7, 0xFF, ErrorCode::Truncated, "headerLength"}, Case{8, 0, ErrorCode::Unsupported, "codec"},
          Case{8, 3, ErrorCode::Unsupported, "codec"}, Case{8, 2, ErrorCode::Malformed, "codec"},
          Case{12, 6, ErrorCode::Truncated, "pictureLength"},
          Case{15, 0xFF, ErrorCode::Truncated, "pictureLength"},
          Case{12, 4, ErrorCode::Malformed, "pictureLength"}, Case{35, 0x7F, ErrorCode::Malformed, "width"},
          Case{38, 1, ErrorCode::Malformed, "height"}}) {
        auto bytes = message(sample());
        bytes[at] = value;
        const auto error = refused(bytes);
        EXPECT_EQ(error.code, code) << at << ": " << error.message;
        EXPECT_EQ(error.field, field) << at << ": " << error.message;
    }
    auto flat = sample();
    flat.height = 0;
    EXPECT_EQ(refused(message(flat)).field, "height");
}

TEST(FrameHeader, AnEmptyPictureIsAFrame) {
    auto header = sample();
    header.pictureLength = 0;
    EXPECT_TRUE(parseFrame(message(header)));
}

}  // namespace
}  // namespace scancast
