// Volumes over ground whose heights are a formula: its integral is the answer.
#include "renderer/measure/volume.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/style.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast::test {
namespace {

const glm::dvec3 corner(389400, 5819700, 34);

/// A plane of 40 x 40 with a cone of radius 10 and height 6 on it, and a hole without points east of x = 30. Class 6: the cone.
ScanPoint pile(std::uint64_t i, std::uint64_t) {
    const double x = 30 * uniform(i, 1), y = 40 * uniform(i, 2), r = std::hypot(x - 15, y - 20);
    ScanPoint p;
    p.position = corner + glm::dvec3(x, y, r < 10 ? 6 * (1 - r / 10) : 0);
    p.classification = r < 10 ? 6 : 2;
    return p;
}

class Volume : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        SyntheticSource source(120'000, pile, {false, false, true, false}, 0.001);
        BuildOptions options;
        options.shape.leafPoints = 4000;
        cloud_ = new std::shared_ptr<const Cloud>(*buildCloud(source, options));
    }
    static void TearDownTestSuite() { delete cloud_; }
    static const Cloud& cloud() { return **cloud_; }
    static MeasureRequest square(double x0, double y0, double x1, double y1, double z = 0) {
        MeasureRequest request;
        request.kind = MeasureKind::Volume;
        request.points = {corner + glm::dvec3(x0, y0, z), corner + glm::dvec3(x1, y0, z),
                          corner + glm::dvec3(x1, y1, z), corner + glm::dvec3(x0, y1, z)};
        return request;
    }
    static VolumeMeasure measured(const MeasureRequest& request, const SampleFilter& filter = {}) {
        const auto volume = measureVolume(cloud(), filter, request);
        EXPECT_TRUE(volume) << volume.error().message;
        return volume.value_or(VolumeMeasure{});
    }
    static constexpr double cone = 3.14159265358979 * 100 * 6 / 3;

  private:
    static inline std::shared_ptr<const Cloud>* cloud_ = nullptr;
};

TEST_F(Volume, OfAConeIsAThird) {
    for (const auto surface : {VolumeSurface::Top, VolumeSurface::Mean}) {
        MeasureRequest request = square(2, 7, 28, 33);
        request.surface = surface;
        const VolumeMeasure volume = measured(request);
        EXPECT_NEAR(volume.above, cone, 0.01 * cone);
        EXPECT_NEAR(volume.below, 0, 0.001 * cone);
        EXPECT_NEAR(volume.area, 26 * 26, 1e-6);
        EXPECT_GT(volume.covered, 0.99 * volume.area);
        EXPECT_NEAR(volume.highest, corner.z + 6, 0.3);
        EXPECT_NEAR(volume.lowest, corner.z, 0.01);
    }
    const double low = [&] {
        MeasureRequest request = square(2, 7, 28, 33);
        request.surface = VolumeSurface::Lowest;
        return measured(request).above;
    }();
    MeasureRequest request = square(2, 7, 28, 33);
    request.surface = VolumeSurface::Highest;
    EXPECT_GT(measured(request).above, cone);
    EXPECT_LT(low, cone);
}

TEST_F(Volume, BasesCutAndFill) {
    MeasureRequest request = square(5, 10, 25, 30);
    request.base = VolumeBase::Height;
    request.height = corner.z + 3;
    // Above half its height a cone is an eighth of it; all else is below: to the base, 3 over the whole square less what is filled.
    const VolumeMeasure volume = measured(request);
    EXPECT_NEAR(volume.above, cone / 8, 0.02 * cone / 8);
    EXPECT_NEAR(volume.above - volume.below, cone - 3 * 400, 0.01 * 1200);
    // A base that follows its tilted corners.
    MeasureRequest tilted = square(5, 10, 25, 30);
    for (glm::dvec3& p : tilted.points) p.z += 0.1 * (p.x - corner.x - 15);
    tilted.base = VolumeBase::Fit;
    EXPECT_NEAR(measured(tilted).base.slope.x, 0.1, 1e-9);
    EXPECT_NEAR(measured(tilted).above - measured(tilted).below, cone, 0.01 * cone);
    tilted.base = VolumeBase::Mean;
    EXPECT_NEAR(measured(tilted).base.height, corner.z, 1e-6);
    tilted.base = VolumeBase::Lowest;
    EXPECT_NEAR(measured(tilted).base.height, corner.z - 1, 1e-6);
}

TEST_F(Volume, HolesAreToldAndNotFilled) {
    const VolumeMeasure volume = measured(square(20, 5, 40, 35));
    EXPECT_NEAR(volume.covered, 300, 6);
    EXPECT_NEAR(double(volume.holes), double(volume.cells) / 2, 0.04 * double(volume.cells));
    MeasureRequest fine = square(2, 7, 28, 33);
    fine.cell = 0.05;
    EXPECT_GT(measured(fine).holes, measured(fine).cells / 2);
    const VolumeMeasure nothing = measured(square(32, 5, 38, 35));
    EXPECT_EQ(nothing.covered, 0);
    EXPECT_EQ(nothing.points, 0U);
    EXPECT_EQ(nothing.above, 0);
}

TEST_F(Volume, WhatTheViewDoesNotDrawIsNoPoint) {
    Style style;
    style.classes = std::vector<std::uint8_t>{6};
    const VolumeMeasure volume = measured(square(2, 7, 28, 33), sampleFilter(cloud(), style));
    EXPECT_NEAR(volume.covered, 314, 12);
    EXPECT_NEAR(volume.above, cone, 0.01 * cone);
    style.classes.reset();
    style.clip = ClipBox{corner + glm::dvec3(0, 0, -1), corner + glm::dvec3(15, 40, 10)};
    EXPECT_NEAR(measured(square(2, 7, 28, 33), sampleFilter(cloud(), style)).above, cone / 2, 0.02 * cone);
}

TEST_F(Volume, WhatCannotBeIsSaid) {
    MeasureRequest bow = square(2, 7, 28, 33);
    std::swap(bow.points[1], bow.points[2]);
    EXPECT_EQ(measureVolume(cloud(), {}, bow).error().field, "points");
    MeasureRequest fine = square(2, 7, 28, 33);
    fine.cell = 1e-4;
    const auto refused = measureVolume(cloud(), {}, fine);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().field, "cell");
    VolumeLimits few;
    few.mostCells = 100;
    const auto coarse = measureVolume(cloud(), {}, square(2, 7, 28, 33), few);
    ASSERT_TRUE(coarse) << "the default gives way";
    EXPECT_LE(coarse->cells, 100U);
    std::stop_source stopped;
    stopped.request_stop();
    EXPECT_EQ(measureVolume(cloud(), {}, square(2, 7, 28, 33), {}, stopped.get_token()).error().code,
              ErrorCode::Cancelled);
}

TEST_F(Volume, IsTheSameWhateverWayTheCornersGo) {
    MeasureRequest request = square(2, 7, 28, 33);
    const VolumeMeasure one = measured(request);
    std::ranges::reverse(request.points);
    EXPECT_EQ(one.above, measured(request).above);
    EXPECT_EQ(one.points, measured(request).points);
}

}  // namespace
}  // namespace scancast::test
