// Where a scan's values usually lie. Oracle: all of them, sorted.
#include "renderer/cloud/build/value_ranges.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "renderer/cloud/build/build_cloud.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast {
namespace {

/// Some hundredths of the points are strays: far away, blindingly bright.
test::ScanPoint someStrays(std::uint64_t i, std::uint64_t) {
    const bool stray = i % 250 == 3;
    test::ScanPoint p;
    p.position = {1e6 + 100 * test::uniform(i, 1), -50 * test::uniform(i, 2),
                  stray ? 1e9 : 5 * test::uniform(i, 3)};
    p.intensity = stray ? 65535 : std::uint16_t(200 + 1000 * test::uniform(i, 4));
    for (std::size_t c = 0; c < 3; ++c)
        p.color[c] = stray ? 255 : std::uint8_t(40 + 100 * test::uniform(i, 5 + c));
    return p;
}

double exact(std::vector<double> values, double q) {
    std::ranges::sort(values);
    return values[std::size_t(q * double(values.size() - 1))];
}

TEST(ValueRanges, UsualIsWhereNearlyAllLie) {
    constexpr std::uint64_t count = 20000;
    test::SyntheticSource source(count, someStrays, {.color = true, .intensity = true});
    const auto cloud = buildCloud(source, {});
    ASSERT_TRUE(cloud) << cloud.error().message;
    ASSERT_TRUE((*cloud)->usual);
    const UsualRanges& usual = *(*cloud)->usual;
    std::vector<double> intensities, brightness;
    std::array<std::vector<double>, 3> positions;
    for (std::uint64_t i = 0; i < count; ++i) {
        const test::ScanPoint p = someStrays(i, count);
        intensities.push_back(p.intensity);
        brightness.push_back((0.2126 * p.color[0] + 0.7152 * p.color[1] + 0.0722 * p.color[2]) / 255);
        for (int a = 0; a < 3; ++a) positions[std::size_t(a)].push_back(p.position[a]);
    }
    const std::array sizes{100.0, 50.0, 5.0};
    for (int a = 0; a < 3; ++a) {
        const auto& values = positions[std::size_t(a)];
        EXPECT_NEAR(usual.position[0][a], exact(values, 0.01), sizes[std::size_t(a)] / 500) << a;
        EXPECT_NEAR(usual.position[1][a], exact(values, 0.99), sizes[std::size_t(a)] / 500) << a;
    }
    EXPECT_NEAR(usual.intensity[0], exact(intensities, 0.01), 1);
    EXPECT_NEAR(usual.intensity[1], exact(intensities, 0.99), 1);
    EXPECT_EQ((*cloud)->intensityRange[1], 65535) << "the range is that of all";
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(usual.brightness[k], exact(brightness, std::array{0.05, 0.5, 0.95}[k]), 0.006);
}

TEST(ValueRanges, OrderAndBatchesChangeNothing) {
    const auto settled = [](std::uint64_t step, std::size_t batchSize) {
        ValueRanges ranges;
        PointBatch batch;
        constexpr std::uint64_t count = 10007;  // a prime: any step visits every point
        for (std::uint64_t k = 0; k < count; ++k) {
            const test::ScanPoint p = someStrays(k * step % count, count);
            batch.position.push_back(p.position);
            batch.intensity.push_back(p.intensity);
            batch.color.push_back(p.color);
            if (batch.position.size() < batchSize && k + 1 < count) continue;
            ranges.add(batch);
            batch.clear();
        }
        CloudFacts facts;
        facts.points = count;
        facts.attributes = {true, true, false, false};
        ranges.settle(facts);
        return *facts.usual;
    };
    const UsualRanges first = settled(1, 10007);
    EXPECT_EQ(settled(1, 13), first);
    EXPECT_EQ(settled(5003, 1000), first);
    EXPECT_EQ(settled(10006, 10007), first);
}

// Right because nobody who has seen all of it says anything else.
TEST(ValueRanges, PartsJoinedAreTheWhole) {
    constexpr std::uint64_t count = 4000;
    std::array<ValueRanges, 3> parts;
    ValueRanges whole;
    for (std::uint64_t k = 0; k < count; ++k) {
        const test::ScanPoint p = someStrays(k, count);
        PointBatch batch;
        batch.position.push_back(p.position);
        batch.intensity.push_back(p.intensity);
        batch.color.push_back(p.color);
        batch.nearInfrared.push_back(std::uint16_t(k % 300));
        whole.add(batch);
        parts[k * 3 / count].add(batch);
    }
    ValueRanges joined;  // of somebody without a point
    for (const ValueRanges& part : parts) joined.join(part);
    CloudFacts expected, facts;
    for (CloudFacts* const of : {&expected, &facts}) {
        of->points = count;
        of->attributes = {true, true, false, false, true};
        (of == &facts ? joined : whole).settle(*of);
    }
    EXPECT_EQ(*facts.usual, *expected.usual);
    EXPECT_EQ(facts.intensityRange, expected.intensityRange);
    EXPECT_EQ(facts.attributes, expected.attributes);
    EXPECT_EQ(joined.nearInfraredShift(), 8);
}

TEST(ValueRanges, WithoutColoursAndIntensitiesThereIsNothingUsual) {
    test::SyntheticSource source(500, test::ground, {});
    const auto cloud = buildCloud(source, {});
    ASSERT_TRUE(cloud);
    ASSERT_TRUE((*cloud)->usual);
    EXPECT_EQ((*cloud)->usual->intensity, (std::array<double, 2>{0, 0}));
    EXPECT_EQ((*cloud)->usual->brightness, (std::array<double, 3>{0, 0, 0}));
}

}  // namespace
}  // namespace scancast
