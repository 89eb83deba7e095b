// Blocks come back as they were, whatever was in them; and bytes that are no blocks are errors.
#include "renderer/cloud/file/blocks/block_codec.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "renderer/cloud/file/blocks/byte_planes.hpp"
#include "renderer/cloud/file/blocks/sample_planes.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast {
namespace {

using test::uniform;

enum class Kind { Noise, Surface, Constant };

std::vector<Sample> make(std::size_t count, Kind kind, std::uint64_t seed) {
    std::vector<Sample> samples(count);
    for (std::size_t i = 0; i < count; ++i) {
        std::array<std::uint8_t, sizeof(Sample)> bytes{};
        for (std::size_t b = 0; b < bytes.size(); ++b) {
            const auto noise = std::uint8_t(256 * uniform(i * 16 + b, seed));
            bytes[b] = kind == Kind::Noise      ? noise
                       : kind == Kind::Constant ? std::uint8_t(b)
                                                : std::uint8_t(i / 64 + noise % 4);
        }
        std::memcpy(&samples[i], bytes.data(), sizeof(Sample));
    }
    return samples;
}

bool same(std::span<const Sample> a, std::span<const Sample> b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

// Right because the bytes are compared with those that went in.
TEST(BlockCodec, SamplesComeBackExactly) {
    for (const Kind kind : {Kind::Noise, Kind::Surface, Kind::Constant})
        for (const std::size_t count : {0, 1, 2, 15, 16, 17, 255, 4097, 16383, 16384, 16385, 40000}) {
            const auto samples = make(count, kind, count);
            const auto block = encodeSamples(samples);
            EXPECT_EQ(block, encodeSamples(samples)) << "not deterministic";
            EXPECT_LE(block.size(), samples.size() * 16 + 32 * (count / chunkRecords + 1)) << count;
            std::vector<Sample> back(count);
            const auto done = decodeSamples(block, back);
            ASSERT_TRUE(done) << count << ": " << done.error().message;
            EXPECT_TRUE(same(samples, back)) << count;
        }
}

TEST(BlockCodec, WhatIsAlikeIsSmall) {
    EXPECT_EQ(encodeSamples(make(0, Kind::Noise, 1)).size(), 0u);
    EXPECT_LE(encodeSamples(make(16384, Kind::Constant, 1)).size(), 512u);
    EXPECT_LE(encodeSamples(make(16384, Kind::Surface, 1)).size(), 16384u * 12);
}

// Right because it does, sample by sample, what the page says, and shares no code with the vectors.
TEST(BlockCodec, PlanesAreWhatThePageSays) {
    const auto samples = make(37, Kind::Noise, 5);
    std::vector<std::byte> planes(samples.size() * sizeof(Sample));
    toPlanes(samples, planes);
    Sample before{};
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const Sample& s = samples[i];
        const auto fold16 = [](int d) {
            return std::uint16_t(std::int16_t(d) < 0 ? -2 * std::int16_t(d) - 1 : 2 * std::int16_t(d));
        };
        const auto fold8 = [](int d) {
            return std::uint8_t(std::int8_t(d) < 0 ? -2 * std::int8_t(d) - 1 : 2 * std::int8_t(d));
        };
        Sample expected = s;
        expected.x = fold16(s.x - before.x);
        expected.y = fold16(s.y - before.y);
        expected.z = fold16(s.z - before.z);
        expected.r = fold8((s.r - s.g) - (before.r - before.g));
        expected.g = fold8(s.g - before.g);
        expected.b = fold8((s.b - s.g) - (before.b - before.g));
        std::array<std::byte, sizeof(Sample)> bytes;
        std::memcpy(bytes.data(), &expected, sizeof expected);
        for (std::size_t p = 0; p < bytes.size(); ++p)
            ASSERT_EQ(planes[p * samples.size() + i], bytes[p]) << "sample " << i << ", byte " << p;
        before = s;
    }
}

TEST(BlockCodec, RowsComeBackExactly) {
    for (const std::size_t rowBytes : {1, 8, 9, 31})
        for (const std::size_t rows : {0, 1, 100, 16384, 20000}) {
            std::vector<std::byte> bytes(rows * rowBytes);
            for (std::size_t i = 0; i < bytes.size(); ++i)
                bytes[i] = std::byte(i % rowBytes < 3 ? i / rowBytes / 100
                                                      : std::size_t(256 * uniform(i, rowBytes)));
            const auto back = decodeRows(encodeRows(bytes, rowBytes), rowBytes, rows);
            ASSERT_TRUE(back) << back.error().message;
            EXPECT_EQ(*back, bytes);
        }
}

TEST(BlockCodec, ABlockCutOffOrTooLongIsMalformed) {
    for (const Kind kind : {Kind::Noise, Kind::Surface, Kind::Constant}) {
        auto block = encodeSamples(make(300, kind, 3));
        std::vector<Sample> back(300);
        for (std::size_t length = 0; length < block.size(); ++length) {
            const std::vector<std::byte> start(block.begin(), block.begin() + std::ptrdiff_t(length));
            const auto done = decodeSamples(start, back);
            ASSERT_FALSE(done) << length;
            EXPECT_EQ(done.error().code, ErrorCode::Malformed);
        }
        block.push_back(std::byte(0));
        EXPECT_FALSE(decodeSamples(block, back));
        EXPECT_FALSE(decodeRows(block, 16, 300));
    }
}

TEST(BlockCodec, AnotherNumberOfSamplesIsMalformed) {
    const auto block = encodeSamples(make(300, Kind::Surface, 3));
    for (const std::size_t count : {0, 1, 299, 301, 16384, 100000}) {
        std::vector<Sample> back(count);
        EXPECT_FALSE(decodeSamples(block, back)) << count;
    }
}

// Without the bound, this would ask for 16 EiB.
TEST(BlockCodec, AShortBlockAllocatesNothingLarge) {
    const std::vector<std::byte> block(32);
    EXPECT_FALSE(decodeRows(block, 16, std::size_t(1) << 60));
    EXPECT_FALSE(decodeRows(block, std::size_t(1) << 62, 16));
    EXPECT_FALSE(decodeRows(block, 0, 5));
    const auto constant = encodeSamples(make(chunkRecords, Kind::Constant, 1));
    EXPECT_GE(constant.size() * largestExpansion, chunkRecords * sizeof(Sample))
        << "the bound must hold for the least";
}

}  // namespace
}  // namespace scancast
