// What is packed is unpacked within the promised error; the expected values are the cells themselves, or bytes that were
// worked out by hand from PROTOCOL.md.
#include "protocol/depth/frame_depth.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

namespace scancast {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr float background = std::numeric_limits<float>::infinity();
constexpr double promised = 1.0 / 1024;

template <class DepthAt>
DepthCells cellsOf(int width, int height, const DepthAt& depthAt) {
    DepthCells cells{width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) cells.depth.push_back(float(depthAt(x, y)));
    return cells;
}

/// Unpacks, compares each cell, and says how many bytes it took.
std::size_t expectUnpacks(const DepthCells& cells, double error = promised) {
    const auto packed = packDepth(cells);
    if (!packed) {
        ADD_FAILURE() << packed.error().message;
        return 0;
    }
    EXPECT_LE(packed->size(), 65535 - frameHeaderLength) << "it fits into a header";
    EXPECT_EQ(*packed, *packDepth(cells));
    const auto depth = unpackDepth(*packed);
    if (!depth) {
        ADD_FAILURE() << depth.error().message;
        return 0;
    }
    EXPECT_EQ(depth->width, cells.width);
    EXPECT_EQ(depth->height, cells.height);
    float near = background, far = 0;
    for (std::size_t i = 0; i < cells.depth.size(); ++i) {
        const float expected = cells.depth[i], inverse = depth->inverse.at(i);
        if (std::isinf(expected)) {
            EXPECT_EQ(inverse, 0) << i;
            continue;
        }
        near = std::min(near, expected);
        far = std::max(far, expected);
        EXPECT_LE(std::abs(double(inverse) * double(expected) - 1), error * 1.0001) << i << ": " << expected;
    }
    EXPECT_EQ(depth->near, far > 0 ? near : 0);
    EXPECT_EQ(depth->far, far);
    return packed->size();
}

TEST(FrameDepth, PlanesAreExactEnoughAndSmall) {
    const auto ground = [](int, int y) { return y < 30 ? background : 1 / (0.002F * (float(y) - 29.5F)); };
    EXPECT_LT(expectUnpacks(cellsOf(160, 90, ground)), 600U);
    const auto wall = [](int x, int y) { return 1 / (0.01 + 0.0004 * x - 0.00005 * y); };
    EXPECT_LT(expectUnpacks(cellsOf(160, 90, wall)), 4000U);
    EXPECT_LT(expectUnpacks(cellsOf(160, 160, [](int, int) { return 7; })), 200U);
}

TEST(FrameDepth, NoiseOfAnyRangeIsExactEnoughAndFits) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> share(0, 1);
    for (const double range : {1.001, 2.0, 300.0, 32000.0})
        expectUnpacks(cellsOf(160, 160, [&](int, int) { return 0.01 * std::pow(range, share(random)); }));
    const auto holes = [&](int, int) {
        return share(random) < 0.5 ? background : float(1 + 300 * share(random));
    };
    expectUnpacks(cellsOf(160, 90, holes));
    // Where the nearest is 10^9 times as near, the far ones are far, and that is all.
    expectUnpacks(cellsOf(16, 9, [&](int x, int) { return x == 0 ? 1e-4 : 1e5; }), 1e3);
}

TEST(FrameDepth, SmallAndEmptyOnes) {
    EXPECT_LT(expectUnpacks(cellsOf(160, 90, [](int, int) { return background; })), 100U);
    expectUnpacks(cellsOf(1, 1, [](int, int) { return 3; }));
    expectUnpacks(cellsOf(2, 1, [](int x, int) { return x == 0 ? 3 : 1e30; }), 2e25);
    expectUnpacks(cellsOf(1, 2, [](int, int y) { return y == 0 ? background : 5; }));
}

TEST(FrameDepth, BytesAreWhereThePageSays) {
    // Cells 2, 4 / background, 8: near/depth is 1, 1/2 and 1/4 of 2^24 units, codes 8192, 7680 and 7168. Predicted are 0,
    // 8192, 8192 (which background takes), and of 8192, 7680 and 8192 their plane, 7680: differences 8192, -512, none, -512.
    const auto packed = packDepth({2, 2, {2, 4, background, 8}});
    ASSERT_TRUE(packed) << packed.error().message;
    const std::uint32_t length = std::uint32_t(packed->size()) - 16;
    Bytes expected{2, 0, 2, 0, std::uint8_t(length), 0, 0, 0, 0, 0, 0, 0x40, 0, 0, 0, 0x41};
    EXPECT_EQ(Bytes(packed->begin(), packed->begin() + 16), expected);
    Bytes symbols(8);
    uLongf size = symbols.size();
    ASSERT_EQ(uncompress(symbols.data(), &size, packed->data() + 16, length), Z_OK);
    ASSERT_EQ(size, 8U);
    EXPECT_EQ(symbols, (Bytes{16385 & 255, 1024 & 255, 0, 1024 & 255, 16385 >> 8, 1024 >> 8, 0, 1024 >> 8}));
}

TEST(FrameDepth, CellsThatAreNoneAreRefused) {
    for (const DepthCells& cells :
         {DepthCells{0, 2, {}}, DepthCells{161, 1, std::vector<float>(161, 1)}, DepthCells{2, 2, {1, 1, 1}},
          DepthCells{1, 1, {0}}, DepthCells{1, 1, {-1}}, DepthCells{1, 1, {std::nanf("")}}}) {
        const auto packed = packDepth(cells);
        ASSERT_FALSE(packed);
        EXPECT_EQ(packed.error().code, ErrorCode::InvalidArgument);
    }
}

Bytes deflated(const Bytes& bytes) {
    Bytes packed(compressBound(uLong(bytes.size())));
    uLongf size = packed.size();
    EXPECT_EQ(compress(packed.data(), &size, bytes.data(), uLong(bytes.size())), Z_OK);
    packed.resize(size);
    return packed;
}

/// The fields of `head`, with that stream behind them.
Bytes with(const Bytes& head, const Bytes& stream) {
    Bytes packed(head.begin(), head.begin() + 16);
    packed[4] = std::uint8_t(stream.size());
    packed[5] = std::uint8_t(stream.size() >> 8);
    packed[6] = std::uint8_t(stream.size() >> 16);
    packed.insert(packed.end(), stream.begin(), stream.end());
    return packed;
}

TEST(FrameDepth, WhatMeansNothingIsRefused) {
    const Bytes good = *packDepth(cellsOf(16, 9, [](int x, int y) { return 1 + x + y; }));
    for (std::size_t length = 0; length < good.size(); ++length) {
        const auto depth = unpackDepth(std::span(good).first(length));
        ASSERT_FALSE(depth) << length;
        EXPECT_EQ(depth.error().code, ErrorCode::Truncated);
    }
    Bytes longer(good.begin() + 16, good.end());
    longer.push_back(0);
    const std::pair<const char*, Bytes> wrong[]{
        {"no zlib stream", with(good, {1, 2, 3})},
        {"an end too early", with(good, Bytes(good.begin() + 16, good.end() - 8))},
        {"something behind the stream", with(good, longer)},
        {"too few cells", with(good, deflated(Bytes(2 * 16 * 9 - 1)))},
        {"a bomb", with(good, deflated(Bytes(std::size_t(1) << 24)))},
        {"nearer than near", with(good, deflated(Bytes(2 * 16 * 9, 0xFF)))},
    };
    for (const auto& [what, bytes] : wrong) {
        const auto depth = unpackDepth(bytes);
        ASSERT_FALSE(depth) << what;
        EXPECT_EQ(depth.error().code, ErrorCode::Malformed) << what;
    }
    struct Field {
        std::size_t at;
        Bytes value;
        const char* name;
    };
    for (const auto& [at, value, name] :
         {Field{0, {0, 0}, "depthWidth"}, Field{0, {161, 0}, "depthWidth"}, Field{2, {0, 1}, "depthHeight"},
          Field{8, {0, 0, 0, 0}, "depthNear"}, Field{8, {0, 0, 0x80, 0x7f}, "depthNear"},
          Field{8, {0, 0, 0xc0, 0x7f}, "depthNear"}, Field{11, {0xbf}, "depthNear"},
          Field{12, {0, 0, 0x80, 0x7f}, "depthNear"}, Field{8, {0, 0, 0, 0, 0, 0, 0, 0}, "depthNear"}}) {
        Bytes bytes = good;
        std::copy(value.begin(), value.end(), bytes.begin() + std::ptrdiff_t(at));
        const auto depth = unpackDepth(bytes);
        ASSERT_FALSE(depth) << at;
        EXPECT_EQ(depth.error().code, ErrorCode::Malformed);
        EXPECT_EQ(depth.error().field, name);
    }
}

}  // namespace
}  // namespace scancast
