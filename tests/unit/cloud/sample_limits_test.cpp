#include "renderer/cloud/sample_limits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "renderer/cloud/surfel_codec.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast {
namespace {

TEST(SampleLimits, HoldEverySampleAndNoMore) {
    // Right because each sample is looked at again, and each limit is some sample's.
    for (const std::size_t count :
         {std::size_t{0}, std::size_t{1}, samplesPerLimits, samplesPerLimits + 1, 3 * samplesPerLimits - 1}) {
        std::vector<Sample> samples(count);
        for (std::size_t i = 0; i < count; ++i) {
            samples[i].x = std::uint16_t(65536 * test::uniform(i, 1));
            samples[i].y = std::uint16_t(65536 * test::uniform(i, 2));
            samples[i].z = std::uint16_t(1000 + 9 * test::uniform(i, 3));
            samples[i].logRadius = std::uint8_t(1 + 255 * test::uniform(i, 4));
        }
        if (count > 70) samples[70].logRadius = noRadius;
        const std::vector<SampleLimits> limits = limitsOf(samples);
        ASSERT_EQ(limits.size() * sizeof(SampleLimits), limitsBytes(count));
        for (std::size_t b = 0; b < limits.size(); ++b) {
            std::array<bool, 6> met{};
            int largest = 0;
            bool plain = false;
            for (std::size_t i = b * samplesPerLimits; i < std::min(count, (b + 1) * samplesPerLimits); ++i) {
                const std::uint16_t place[3] = {samples[i].x, samples[i].y, samples[i].z};
                for (std::size_t a = 0; a < 3; ++a) {
                    EXPECT_GE(place[a], limits[b].low[a]);
                    EXPECT_LE(place[a], limits[b].high[a]);
                    met[a] = met[a] || place[a] == limits[b].low[a];
                    met[3 + a] = met[3 + a] || place[a] == limits[b].high[a];
                }
                const int code = samples[i].logRadius;
                const bool known = code != noRadius && code != outlierRadius;
                largest = known ? std::max(largest, code) : largest;
                plain = plain || !known;
            }
            EXPECT_TRUE(std::ranges::all_of(met, [](bool m) { return m; }));
            EXPECT_EQ(limits[b].largestRadius, largest);
            EXPECT_EQ(limits[b].plain, plain);
        }
    }
}

}  // namespace
}  // namespace scancast
