// Frames of a live source: streams behind one another are read one by one, and what is wrong is told.
#include "renderer/cloud/import/stream/frame_reader.hpp"

#include <gmock/gmock.h>

#include "renderer/cloud/import/stream/point_stream_writer.hpp"

namespace scancast::test {

using ::testing::HasSubstr;

namespace {

using Bytes = std::vector<std::byte>;

void operator+=(Bytes& to, const Bytes& more) {
    to.insert(to.end(), more.begin(), more.end());
}

/// A stream that `write` writes.
template <class Write>
Bytes streamOf(Write write) {
    Bytes bytes;
    PointStreamWriter writer([&](std::span<const std::byte> more) {
        bytes.insert(bytes.end(), more.begin(), more.end());
        return true;
    });
    write(writer);
    return bytes;
}

/// Points at (mark, 0, 0), (mark, 1, 0) …
Bytes liveFrame(double mark, std::size_t points, bool declares = true) {
    return streamOf([&](PointStreamWriter& writer) {
        ScanHeader header;
        header.attributes.color = true;
        if (declares) header.points = points;
        PointBatch batch;
        EXPECT_TRUE(writer.writeHeader(header));
        for (std::size_t i = 0; i < points; ++i) {
            batch.position.emplace_back(mark, double(i), 0);
            batch.color.push_back({1, 2, 3});
            if (batch.size() < PointSource::batchPoints && i + 1 < points) continue;
            EXPECT_TRUE(writer.writeChunk(batch));
            batch.clear();
        }
        EXPECT_TRUE(writer.finish(0));
    });
}

Bytes failedFrame(ErrorCode code) {
    return streamOf([&](PointStreamWriter& writer) {
        EXPECT_TRUE(writer.writeFailure({code, "the lens is covered", {}}));
    });
}

FrameReader readerOf(const Bytes& bytes, std::uint64_t most = 1'000'000) {
    return {std::make_unique<MemoryByteSource>(bytes, false), most};
}

void expectFrame(FrameReader& reader, double mark, std::size_t points) {
    const auto frame = reader.next();
    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_TRUE(*frame);
    EXPECT_EQ((*frame)->points.size(), points);
    EXPECT_EQ((*frame)->points.color.size(), points);
    EXPECT_EQ((*frame)->points.position[points - 1], glm::dvec3(mark, double(points - 1), 0));
}

void expectEnd(FrameReader& reader) {
    const auto end = reader.next();
    ASSERT_TRUE(end) << end.error().message;
    EXPECT_FALSE(*end);
}

}  // namespace

TEST(FrameReader, StreamsBehindOneAnotherAreFrames) {
    Bytes bytes = liveFrame(1, 3);
    bytes += liveFrame(2, 70'000);
    bytes += liveFrame(3, 1, false);
    FrameReader reader = readerOf(bytes);
    expectFrame(reader, 1, 3);
    expectFrame(reader, 2, 70'000);
    expectFrame(reader, 3, 1);
    expectEnd(reader);
    expectEnd(reader);
}

TEST(FrameReader, NothingIsTheEnd) {
    const Bytes nothing;
    FrameReader reader = readerOf(nothing);
    expectEnd(reader);
}

TEST(FrameReader, AFrameThatItsSenderGaveUpIsNotTheEnd) {
    for (const ErrorCode code : {ErrorCode::Io, ErrorCode::Malformed, ErrorCode::Empty}) {
        Bytes bytes = failedFrame(code);
        bytes += liveFrame(7, 5);
        FrameReader reader = readerOf(bytes);
        const auto failed = reader.next();
        ASSERT_FALSE(failed);
        EXPECT_THAT(failed.error().message, HasSubstr("the lens is covered"));
        EXPECT_TRUE(reader.mayGoOn());
        expectFrame(reader, 7, 5);
    }
}

TEST(FrameReader, AFrameWithoutPointsIsNotTheEnd) {
    Bytes bytes = liveFrame(1, 0);
    bytes += liveFrame(2, 2);
    FrameReader reader = readerOf(bytes);
    const auto empty = reader.next();
    ASSERT_FALSE(empty);
    EXPECT_EQ(empty.error().code, ErrorCode::Empty);
    EXPECT_TRUE(reader.mayGoOn());
    expectFrame(reader, 2, 2);
}

// Wherever a sender dies, the frames before are whole and the last one is an error, not the end.
TEST(FrameReader, BytesThatBreakOffAreAnError) {
    const Bytes first = liveFrame(1, 2), second = liveFrame(2, 2);
    for (std::size_t cut = 1; cut < second.size(); ++cut) {
        Bytes bytes = first;
        bytes.insert(bytes.end(), second.begin(), second.begin() + std::ptrdiff_t(cut));
        FrameReader reader = readerOf(bytes);
        expectFrame(reader, 1, 2);
        const auto broken = reader.next();
        ASSERT_FALSE(broken) << cut;
        EXPECT_THAT(broken.error().message, HasSubstr("broke off")) << cut;
        EXPECT_FALSE(reader.mayGoOn()) << cut;
    }
}

TEST(FrameReader, WhatIsNoFrameEndsEverything) {
    Bytes bytes = liveFrame(1, 2);
    bytes.resize(bytes.size() + 500, std::byte{'x'});
    FrameReader reader = readerOf(bytes);
    expectFrame(reader, 1, 2);
    EXPECT_FALSE(reader.next());
    EXPECT_FALSE(reader.mayGoOn());
}

TEST(FrameReader, AFrameHasAsManyPointsAsThereIsRoomForAtMost) {
    for (const bool declares : {true, false}) {
        const Bytes fits = liveFrame(1, 1000, declares), tooMany = liveFrame(1, 1001, declares);
        FrameReader roomy = readerOf(fits, 1000);
        expectFrame(roomy, 1, 1000);
        FrameReader reader = readerOf(tooMany, 1000);
        const auto refused = reader.next();
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, ErrorCode::ResourceLimit);
        EXPECT_FALSE(reader.mayGoOn());
    }
}

TEST(FrameReader, FurtherColumnsAreRefused) {
    const Bytes bytes = streamOf([](PointStreamWriter& writer) {
        ScanHeader header;
        header.columns.push_back({"gps_time", ColumnType::Float64, 1, 0, ""});
        EXPECT_TRUE(writer.writeHeader(header));
        EXPECT_TRUE(writer.finish(0));
    });
    FrameReader reader = readerOf(bytes);
    const auto refused = reader.next();
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::Unsupported);
    EXPECT_FALSE(reader.mayGoOn());
}

TEST(FrameReader, TheRestCanBeThrownAway) {
    Bytes bytes = liveFrame(1, 2);
    bytes += liveFrame(2, 70'000);
    FrameReader reader = readerOf(bytes);
    expectFrame(reader, 1, 2);
    reader.discardRest();
    expectEnd(reader);
}

}  // namespace scancast::test
