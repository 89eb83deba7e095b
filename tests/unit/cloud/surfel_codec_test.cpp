// A surfel's four bytes: what is lost on the way there and back.
#include "renderer/cloud/surfel_codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/clouds/point_sets.hpp"

namespace scancast {
namespace {

using std::numbers::pi;

glm::vec3 direction(std::uint64_t i) {
    for (;; i += 1000003) {
        const glm::vec3 p = test::randomPoint(i, 4) * 2.0f - 1.0f;
        if (const float length = glm::length(p); length > 0.1f && length < 1) return p / length;
    }
}

Surfel surfelOf(glm::vec3 normal, float angle, float radius, float ratio) {
    const TangentFrame frame = tangentFrame(normal);
    Surfel s;
    s.normal = normal;
    s.majorAxis = frame.first * std::cos(angle) + frame.second * std::sin(angle);
    s.radius = radius;
    s.major = radius * majorPerRadius;
    s.minor = s.major * ratio;
    return s;
}

Surfel roundTrip(const Surfel& s, float spacing, Sample* sample = nullptr) {
    Sample own{};
    encodeSurfel(s, spacing, sample ? *sample : own);
    return decodeSurfel(sample ? *sample : own, spacing);
}

TEST(SurfelCodec, KeepsRadiusToOnePartInEighty) {
    for (const float spacing : {1e-4f, 0.37f, 1200.0f})
        for (double inSpacings = 1.0 / 16; inSpacings < 16; inSpacings *= 1.001) {
            const float radius = float(inSpacings) * spacing;
            const Surfel back = roundTrip(surfelOf({0, 0, 1}, 0, radius, 1), spacing);
            ASSERT_LE(std::abs(back.radius / radius - 1), 0.012f) << inSpacings;
            ASSERT_FALSE(back.outlier);
        }
}

TEST(SurfelCodec, ClampsRadiiOutOfRangeAndKeepsTheReservedCodes) {
    Sample s{};
    EXPECT_NEAR(roundTrip(surfelOf({0, 0, 1}, 0, 1e-6f, 1), 1, &s).radius, 1.0 / 16, 1e-6);
    EXPECT_EQ(s.logRadius, 1);
    EXPECT_NEAR(roundTrip(surfelOf({0, 0, 1}, 0, 1e6f, 1), 1, &s).radius, 16, 1e-4);
    EXPECT_EQ(s.logRadius, 254);
    Surfel outlier = surfelOf({0, 0, 1}, 0, 1, 1);
    outlier.outlier = true;
    EXPECT_TRUE(roundTrip(outlier, 1, &s).outlier);
    EXPECT_EQ(s.logRadius, outlierRadius);
    EXPECT_EQ(roundTrip(Surfel{}, 3, &s).radius, 3);
    EXPECT_EQ(s.logRadius, noRadius);
    EXPECT_EQ(s.ellipse, 0);
}

TEST(SurfelCodec, KeepsRatioAndAngleToHalfAStep) {
    const double halfRatio = 0.75 / 7 / 2, halfAngle = pi / 32 / 2;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        // Decoded normals: the frame that the angle counts in is then the same on both sides.
        const glm::vec3 normal = decodeNormal(encodeNormal(direction(i)));
        const float angle = float(pi * test::uniform(i, 1));
        const float ratio = float(0.25 + 0.75 * test::uniform(i, 2));
        const Surfel there = surfelOf(normal, angle, 1, ratio), back = roundTrip(there, 1);
        ASSERT_LE(std::abs(back.minor / back.major - ratio), halfRatio + 1e-5);
        ASSERT_NEAR(back.major / back.radius, majorPerRadius, 1e-5);
        ASSERT_NEAR(glm::dot(back.majorAxis, back.normal), 0, 1e-5);
        if (back.minor < back.major) {
            const double cosine = std::abs(double(glm::dot(back.majorAxis, there.majorAxis)));
            ASSERT_LE(std::acos(std::min(cosine, 1.0)), halfAngle + 1e-3);
        }
    }
}

TEST(SurfelCodec, ClampsRatiosBelowAQuarterAndRoundsRatiosNearOneToCircles) {
    Sample s{};
    const Surfel narrow = roundTrip(surfelOf({0, 0, 1}, 1, 1, 0.01f), 1, &s);
    EXPECT_FLOAT_EQ(narrow.minor, narrow.major / 4);
    EXPECT_EQ(s.ellipse >> 5, 7);
    roundTrip(surfelOf({0, 0, 1}, 1, 1, 0.99f), 1, &s);
    EXPECT_EQ(s.ellipse, 0);
}

TEST(SurfelCodec, TakesTheFirstOfTheAnglesThatAreNearest) {
    for (std::uint64_t i = 0; i < 5000; ++i) {
        const glm::vec3 normal = direction(i), axis = direction(i + 7'000'000);
        int nearest = 0;
        float most = -1;
        for (int angle = 0; angle < 32; ++angle) {
            const float along = std::abs(glm::dot(axis, axisAtAngle(std::uint8_t(angle), normal)));
            if (along > most + 1e-6f) {
                most = along;
                nearest = angle;
            }
        }
        const int found = axisAngleOf(axis, normal);
        if (found == nearest) continue;
        ASSERT_NEAR(std::abs(glm::dot(axis, axisAtAngle(std::uint8_t(found), normal))), most, 1e-6) << i;
    }
    // All are equally far from the normal itself, and from what is no direction.
    const glm::vec3 up(0, 0, 1);
    EXPECT_EQ(axisAngleOf(up, up), 0);
    EXPECT_EQ(axisAngleOf(glm::vec3(NAN), up), 0);
}

TEST(SurfelCodec, LeavesTheNormalOfASampleWhoseSurfelHasNoneAndEverythingElseAlways) {
    Sample s{1, 2, 3, 4, 5, 6, 7, 8, encodeNormal({0, 1, 0}), 0, 0};
    Surfel line = surfelOf({0, 0, 1}, 0, 1, 0.25f);
    line.normal = glm::vec3(0);
    encodeSurfel(line, 1, s);
    EXPECT_EQ(s.normal, encodeNormal({0, 1, 0}));
    encodeSurfel(surfelOf({0, 0, 1}, 0, 1, 0.25f), 1, s);
    EXPECT_EQ(s.normal, encodeNormal({0, 0, 1}));
    EXPECT_TRUE(s.x == 1 && s.y == 2 && s.z == 3 && s.intensity == 4 && s.r == 5 && s.g == 6 && s.b == 7 &&
                s.classification == 8);
    s.normal = noNormal;
    encodeSurfel(line, 1, s);
    EXPECT_EQ(s.ellipse, 0);  // an angle in no plane
    EXPECT_EQ(decodeSurfel(s, 1).normal, glm::vec3(0));
}

TEST(TangentFrame, IsRightHandedAndOrthonormalForEveryNormal) {
    for (int code = 1; code < 65536; ++code) {
        if (code >> 8 == 0 || (code & 255) == 0) continue;  // never encoded
        const glm::vec3 n = decodeNormal(std::uint16_t(code));
        const TangentFrame f = tangentFrame(n);
        ASSERT_NEAR(glm::length(f.first), 1, 2e-6);
        ASSERT_NEAR(glm::length(f.second), 1, 2e-6);
        ASSERT_NEAR(glm::dot(f.first, f.second), 0, 2e-6);
        ASSERT_LT(glm::length(glm::cross(f.first, f.second) - n), 3e-6);
    }
}

TEST(TangentFrame, TurnsGentlyButForOneDirection) {
    for (std::uint64_t i = 0; i < 20000; ++i) {
        const glm::vec3 n = direction(i);
        if (n.z < -0.9f) continue;
        const glm::vec3 nearby = glm::normalize(n + (test::randomPoint(i, 8) - 0.5f) * 1e-3f);
        ASSERT_LT(glm::length(tangentFrame(n).first - tangentFrame(nearby).first), 0.02) << i;
    }
}

}  // namespace
}  // namespace scancast
