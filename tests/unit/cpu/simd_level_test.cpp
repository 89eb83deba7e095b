#include "renderer/device/cpu/simd_level.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "renderer/device/cpu/cpu_device.hpp"

namespace scancast::cpu {
namespace {

using testing::HasSubstr;

TEST(SimdLevel, TheBestOneIsChosenUnlessOneIsForced) {
    const auto best = chooseSimdLevel("");
    ASSERT_TRUE(best);
    EXPECT_TRUE((*best)->available());
    for (const SimdLevel& level : simdLevels()) {
        if (!level.available()) continue;
        EXPECT_EQ(*best, &level) << "levels are listed best first";
        break;
    }
    EXPECT_EQ((*chooseSimdLevel("v2"))->name, "v2") << "every processor that this runs on has v2";
}

TEST(SimdLevel, AnUnknownNameIsRefusedAndTheKnownOnesAreNamed) {
    const auto level = chooseSimdLevel("avx2");
    ASSERT_FALSE(level);
    EXPECT_EQ(level.error().code, ErrorCode::InvalidArgument);
    EXPECT_THAT(level.error().message, HasSubstr("v2, v3 and v4"));
}

TEST(SimdLevel, AMissingLevelIsRefusedAndItsNeedIsNamed) {
    for (const SimdLevel& level : simdLevels()) {
        const auto chosen = chooseSimdLevel(level.name);
        if (level.available()) {
            ASSERT_TRUE(chosen);
            EXPECT_EQ((*chosen)->name, level.name);
        } else {
            ASSERT_FALSE(chosen);
            EXPECT_EQ(chosen.error().code, ErrorCode::DeviceUnavailable);
            EXPECT_THAT(chosen.error().message, HasSubstr(std::string(level.needs)));
        }
    }
}

TEST(CpuDevice, SaysWhatItIsAndRefusesWrongThreadCounts) {
    const auto device = createCpuDevice(3);
    ASSERT_TRUE(device);
    EXPECT_EQ((*device)->info().name, "cpu");
    EXPECT_EQ((*device)->info().identity, "cpu") << "pictures depend on nothing else";
    EXPECT_FALSE((*device)->info().hardware);
    EXPECT_THAT((*device)->info().renderer, HasSubstr("threads: 3"));
    for (const int wrong : {-1, 1025, 1 << 30}) EXPECT_FALSE(createCpuDevice(wrong)) << wrong;
}

}  // namespace
}  // namespace scancast::cpu
