// Measures of a scan of the generated town against the town itself: bodies of its houses as the generator made them, roofs as rays meet
// them. Right because neither knows a point of the scan.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "protocol/measure/vertices.hpp"
#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/measure/volume.hpp"
#include "simulator/scenes/town.hpp"
#include "tests/oracle/measure/clicks.hpp"
#include "tests/oracle/measure/town_truth.hpp"

namespace scancast::test {
namespace {

constexpr std::size_t measuredHouses = 6;

class MeasuredTown : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        const SceneOptions scene{.scene = "town", .points = 1'500'000};
        town_ = new RayCaster(RayCaster::create(scene).value());
        const auto all = townHouses(*town_, pavementHeight);
        for (std::size_t i = 0; i < measuredHouses; ++i)
            houses().push_back(all[i * all.size() / measuredHouses]);
        auto source = simulate(scene).value();
        BuildOptions options;
        options.title = "town";
        cloud_ = new std::shared_ptr<const Cloud>(*buildCloud(*source, options));
    }
    static void TearDownTestSuite() {
        delete cloud_;
        delete town_;
    }
    static std::vector<TownHouse>& houses() {
        static std::vector<TownHouse> list;
        return list;
    }
    static const Cloud& cloud() { return **cloud_; }
    static const RayCaster& town() { return *town_; }

  private:
    static inline RayCaster* town_ = nullptr;
    static inline std::shared_ptr<const Cloud>* cloud_ = nullptr;
};

TEST_F(MeasuredTown, VolumesOfHousesAreTrueToAHundredth) {
    for (const TownHouse& house : houses()) {
        const auto corners = inset(house.corners, clearOfNeighbours);
        MeasureRequest request;
        request.kind = MeasureKind::Volume;
        request.points.assign(corners.begin(), corners.end());
        const auto measured = measureVolume(cloud(), {}, request);
        ASSERT_TRUE(measured) << measured.error().message;
        const TrueVolume truth = volumeByRays(town(), corners, corners[0].z, 0.1);
        const double area = (house.width - 2 * clearOfNeighbours) * (house.depth - 2 * clearOfNeighbours);
        EXPECT_NEAR(measured->above, truth.above, 0.01 * truth.above);
        EXPECT_NEAR(measured->area, area, 1e-4 * area);
        EXPECT_GT(measured->covered, 0.98 * measured->area);
        EXPECT_NEAR(measured->below, 0, 0.001 * truth.above);
        // What the generator put on the body - chimneys, dormers, tiles - is some hundredths more.
        const double body = house.volume() / house.area() * area;
        EXPECT_NEAR(measured->above, body, 0.04 * body);
        std::printf(
            "house %.1f x %.1f m: %.1f m3, true %.1f (%+.2f %%), body %.1f; cell %.2f, holes %llu of %llu\n",
            house.width, house.depth, measured->above, truth.above, 100 * (measured->above / truth.above - 1),
            body, measured->cell, static_cast<unsigned long long>(measured->holes),
            static_cast<unsigned long long>(measured->cells));
    }
}

// A pick is the nearest point of the scan; two of them make a length. How far off a single one is depends on where a scanner's beams happened to
// fall, so it is the median that is held against half the spacing, and nearly all that are against the whole.
TEST_F(MeasuredTown, LengthsBetweenPicksAreTrueToHalfTheSpacing) {
    std::vector<double> errors;
    for (const Length& length : lengthsBetweenPicks(cloud(), town(), 200))
        errors.push_back(std::abs(length.measured - length.truth));
    ASSERT_EQ(errors.size(), 200U);
    std::ranges::sort(errors);
    EXPECT_LE(errors[100], 0.001 + cloud().spacing / 2);
    EXPECT_LE(errors[190], 0.001 + 1.5 * cloud().spacing);
}

// What somebody who clicks points at lies between the scan's points: the surface that a pick tells of is nearer to it than any of them can be.
// Clicks whose pixel shows something else than a ray meets - beyond an outline, through a gap - are not told apart by measuring.
TEST_F(MeasuredTown, SurfacesUnderClicksAreTruerThanPoints) {
    DeviceOptions options;
    options.backend = "cpu";
    const auto device = createDevice(options);
    ASSERT_TRUE(device);
    std::vector<Click> clicks = clicksInPictures(**device, cloud(), town(), 4, 100);
    std::erase_if(clicks, [](const Click& click) { return glm::distance(click.surface, click.truth) > 0.5; });
    ASSERT_GT(clicks.size(), 300U);
    std::vector<double> points, surfaces;
    for (const Click& click : clicks) {
        points.push_back(glm::distance(click.point, click.truth));
        surfaces.push_back(glm::distance(click.surface, click.truth));
    }
    std::ranges::sort(points);
    std::ranges::sort(surfaces);
    const std::size_t middle = clicks.size() / 2;
    EXPECT_LT(surfaces[middle], 0.1 * cloud().spacing);
    EXPECT_LT(surfaces[middle], 0.25 * points[middle]);
    std::size_t within = 0, lengths = 0;
    for (std::size_t i = 0; i + 1 < clicks.size(); i += 2, ++lengths)
        within +=
            std::abs(glm::distance(clicks[i].surface, clicks[i + 1].surface) -
                     glm::distance(clicks[i].truth, clicks[i + 1].truth)) <= 0.001 + cloud().spacing / 2;
    EXPECT_GT(double(within), 0.85 * double(lengths));
}

// What areas are held against is itself of one piece: of every house, the front's width is that between the corners that are picked.
TEST_F(MeasuredTown, AFrontLiesBetweenTheFirstTwoCornersOfItsHouse) {
    const auto all = townHouses(town(), pavementHeight);
    EXPECT_GT(all.size(), 150U);
    for (const TownHouse& house : all) {
        EXPECT_NEAR(glm::distance(house.corners[0], house.corners[1]), house.width, 1e-9);
        EXPECT_NEAR(glm::distance(house.corners[1], house.corners[2]), house.depth, 1e-9);
        const glm::dvec3 u = house.corners[1] - house.corners[0], v = house.corners[3] - house.corners[0];
        EXPECT_GT(u.x * v.y - u.y * v.x, 0) << "counter-clockwise";
    }
}

// One by one: picks are up to the spacing off at either end of a side, and so are its sides.
TEST_F(MeasuredTown, AreasOfSingleFrontsAreTrueToTheSpacing) {
    for (const TownHouse& house : townHouses(town(), pavementHeight)) {
        const double height = house.eaves - 0.3, off = 2 * cloud().spacing;
        const double truth = house.width * height;
        EXPECT_NEAR(frontArea(cloud(), house), truth, off * (house.width + height) / 2)
            << house.width << " x " << height;
    }
}

TEST_F(MeasuredTown, AreasOfFrontsAreTrueToAHundredth) {
    double truth = 0, measured = 0;
    for (const TownHouse& house : houses()) {
        truth += house.width * (house.eaves - 0.3);
        measured += frontArea(cloud(), house);
    }
    EXPECT_NEAR(measured, truth, 0.01 * truth);
}

}  // namespace
}  // namespace scancast::test
