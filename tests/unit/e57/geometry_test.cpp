// Where points end up: poses, spherical coordinates, scans beside each other, points that are none. Poses are proved by
// another way to turn a vector: the quaternion's own products.
#include <gmock/gmock.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>

#include "tests/unit/e57/imported.hpp"

namespace scancast::test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

namespace {

const glm::dvec3 corners[] = {{1, 0, 0}, {0, 2, 0}, {0, 0, 3}, {-4.5, 0.25, 7}};

E57Scan scanOf(std::vector<glm::dvec3> points, std::string xml = {}) {
    E57Scan scan;
    scan.fields = {E57Field::real("cartesianX"), E57Field::real("cartesianY"), E57Field::real("cartesianZ")};
    scan.records = points.size();
    scan.xml = std::move(xml);
    scan.real = [points](std::uint64_t record, std::size_t field) {
        return field < 3 ? points[record][static_cast<int>(field)] : 0.0;
    };
    return scan;
}

E57Scan cornerScan(std::string xml = {}) {
    return scanOf({std::begin(corners), std::end(corners)}, std::move(xml));
}

E57Scan sphericalScan(std::vector<glm::dvec3> points, std::string xml = {}) {
    auto scan = scanOf(std::move(points), std::move(xml));
    scan.fields[0].name = "sphericalRange";
    scan.fields[1].name = "sphericalAzimuth";
    scan.fields[2].name = "sphericalElevation";
    return scan;
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b) {
    EXPECT_LT(glm::distance(a, b), 1e-12 * (1 + glm::length(b))) << a.x << " " << a.y << " " << a.z;
}

/// q p q*, multiplied out by glm.
glm::dvec3 turned(const glm::dquat& q, const glm::dvec3& p) {
    const auto result = q * glm::dquat(0, p.x, p.y, p.z) * glm::conjugate(q);
    return {result.x, result.y, result.z};
}

}  // namespace

TEST(Poses, TurnAndMovePoints) {
    const glm::dquat q = glm::normalize(glm::dquat(0.3, -0.5, 0.7, 0.2));
    const glm::dvec3 t(500'000.25, 5'400'000.5, 312);
    const auto result = imported(e57File({cornerScan(e57Pose(q.w, q.x, q.y, q.z, t.x, t.y, t.z))})).value();
    ASSERT_EQ(result.points.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) expectNear(result.points.position[i], turned(q, corners[i]) + t);
    EXPECT_THAT(result.notes, IsEmpty());
    ASSERT_TRUE(result.header.scannerOrigin);
    expectNear(*result.header.scannerOrigin, t);
}

TEST(Poses, OfAQuarterTurnAreWhatOneExpects) {
    const double half = std::sqrt(0.5);  // about z: x becomes y
    const auto result = imported(e57File({cornerScan(e57Pose(half, 0, 0, half, 10, 0, 0))})).value();
    expectNear(result.points.position[0], {10, 1, 0});
    expectNear(result.points.position[1], {8, 0, 0});
    expectNear(result.points.position[2], {10, 0, 3});
}

TEST(Poses, ThatOnlyMoveAreExact) {
    const auto result = imported(e57File({cornerScan(e57Pose(1, 0, 0, 0, 1e6, -2, 0.5))})).value();
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(result.points.position[i], corners[i] + glm::dvec3(1e6, -2, 0.5));
    EXPECT_FALSE(result.header.scannerOrigin) << "a shift to large coordinates is no place of a scanner";
}

TEST(Poses, OfAnotherLengthAreBroughtToOne) {
    const glm::dquat q(3, 0, 0, 4);
    const auto result = imported(e57File({cornerScan(e57Pose(3, 0, 0, 4, 0, 0, 0))})).value();
    for (std::size_t i = 0; i < 4; ++i)
        expectNear(result.points.position[i], turned(glm::normalize(q), corners[i]));
    EXPECT_THAT(result.notes, ElementsAre(HasSubstr("1 scan with a rotation that is not of length 1")));
}

TEST(Poses, OfZeroTurnNothing) {
    const auto result = imported(e57File({cornerScan(e57Pose(0, 0, 0, 0, 1, 2, 3))})).value();
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(result.points.position[i], corners[i] + glm::dvec3(1, 2, 3));
    EXPECT_THAT(result.notes, ElementsAre(HasSubstr("1 scan with a rotation of zero")));
}

TEST(Poses, ThatAreNoNumbersAreRefused) {
    expectRefused(e57File({cornerScan("<pose><rotation><w>one</w></rotation></pose>")}), ErrorCode::Malformed,
                  "scan 1: its pose is no rotation and translation");
    expectRefused(e57File({cornerScan("<pose><translation><y>1e300</y></translation></pose>")}),
                  ErrorCode::Malformed, "pose");
    expectRefused(e57File({cornerScan("<pose><translation><y>nan</y></translation></pose>")}),
                  ErrorCode::Malformed, "pose");
}

TEST(Scans, FollowEachOtherEachInItsPlace) {
    const glm::dquat q = glm::normalize(glm::dquat(1, 0.1, 0.2, -0.3));
    const auto result = imported(e57File({cornerScan(), cornerScan(e57Pose(q.w, q.x, q.y, q.z, 7, 8, 9)),
                                          scanOf({}), cornerScan(e57Pose(q.w, q.x, q.y, q.z, 70, 80, 90))}))
                            .value();
    ASSERT_EQ(result.points.size(), 12U);
    EXPECT_EQ(result.header.points, 12U);
    EXPECT_EQ(result.header.format, "E57 1.0, 4 scans");
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(result.points.position[i], corners[i]);
        expectNear(result.points.position[4 + i], turned(q, corners[i]) + glm::dvec3(7, 8, 9));
        expectNear(result.points.position[8 + i], turned(q, corners[i]) + glm::dvec3(70, 80, 90));
    }
    EXPECT_FALSE(result.header.scannerOrigin);
    EXPECT_THAT(result.notes, ElementsAre(HasSubstr("of 2 of 4 scans it is not known from where"),
                                          HasSubstr("1 scan without points")));
}

TEST(Scans, OfOneStandpointSayIt) {
    const auto pose = e57Pose(0.6, 0, 0.8, 0, 4, 5, 6);
    const auto result = imported(e57File({cornerScan(pose), cornerScan(pose)})).value();
    ASSERT_TRUE(result.header.scannerOrigin);
    expectNear(*result.header.scannerOrigin, {4, 5, 6});
}

TEST(Spherical, CoordinatesBecomeCartesian) {
    constexpr double pi = 3.14159265358979323846;
    const auto result =
        imported(e57File({sphericalScan({{2, 0, 0}, {2, pi / 2, 0}, {2, 0, pi / 2}, {2, pi / 4, -pi / 6}},
                                        e57Pose(1, 0, 0, 0, 0, 0, 10))}))
            .value();
    expectNear(result.points.position[0], {2, 0, 10});
    expectNear(result.points.position[1], {0, 2, 10});
    expectNear(result.points.position[2], {0, 0, 12});
    const double flat = 2 * std::cos(pi / 6);
    expectNear(result.points.position[3], {flat * std::sqrt(0.5), flat * std::sqrt(0.5), 9});
    ASSERT_TRUE(result.header.scannerOrigin);
    expectNear(*result.header.scannerOrigin, {0, 0, 10});
}

// 0 = valid, 1 = a direction without a distance, 2 = nothing; and what no flag tells of.
TEST(States, LeaveOutWhatIsNoPoint) {
    for (const bool spherical : {false, true}) {
        auto scan = spherical ? sphericalScan({{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}})
                              : scanOf({{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}});
        scan.fields.push_back(
            E57Field::integer(spherical ? "sphericalInvalidState" : "cartesianInvalidState", 0, 2));
        scan.raw = [](std::uint64_t record, std::size_t) { return std::array{0, 1, 2, 0}[record]; };
        const auto result = imported(e57File({scan})).value();
        ASSERT_EQ(result.points.size(), 2U);
        EXPECT_EQ(result.points.position[1].x, 4);
        EXPECT_EQ(result.dropped, 2U);
        EXPECT_THAT(result.notes, ElementsAre("2 points left out, marked as no points in the file"));
    }
}

TEST(States, NumbersThatAreNoneAreCountedApart) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double infinite = std::numeric_limits<double>::infinity();
    const auto result =
        imported(e57File({scanOf({{1, 2, 3}, {nan, 0, 0}, {0, infinite, 0}, {4, 5, 6}})})).value();
    EXPECT_EQ(result.points.size(), 2U);
    EXPECT_EQ(result.dropped, 2U);
    EXPECT_THAT(result.notes, IsEmpty());
}

TEST(States, WithoutAnyPointLeftTheScanIsEmpty) {
    auto scan = cornerScan();
    scan.fields.push_back(E57Field::integer("cartesianInvalidState", 2, 2));
    scan.raw = [](auto, auto) { return 2; };
    const auto result = imported(e57File({scan}));
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::Empty) << result.error().message;
}

TEST(Grids, AreSentWhereAllPointsAreOnOne) {
    E57Scan scan;
    for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"})
        scan.fields.push_back(E57Field::scaled(name, -1000, 1000, 0.001, 5));
    scan.records = 10;
    scan.raw = [](std::uint64_t record, std::size_t) { return static_cast<std::int64_t>(record); };
    auto moved = scan;
    moved.xml = e57Pose(1, 0, 0, 0, 1, 2, 3);
    auto rotated = scan;
    rotated.xml = e57Pose(0.6, 0, 0, 0.8, 0, 0, 0);
    EXPECT_EQ(imported(e57File({scan, scan}))->header.gridStep, glm::dvec3(0.001));
    EXPECT_EQ(imported(e57File({scan, scan}))->header.gridOrigin, glm::dvec3(5));
    EXPECT_EQ(imported(e57File({moved}))->header.gridOrigin, glm::dvec3(6, 7, 8));
    EXPECT_EQ(imported(e57File({scan, moved}))->header.gridStep, glm::dvec3(0));
    EXPECT_EQ(imported(e57File({rotated}))->header.gridStep, glm::dvec3(0));
    EXPECT_EQ(imported(e57File({cornerScan()}))->header.gridStep, glm::dvec3(0));
}

TEST(Grids, OfThirtyTwoBitsAreSentAsSteps) {
    E57Scan scan;
    for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"})
        scan.fields.push_back(E57Field::scaled(name, -2'147'483'648LL, 2'147'483'647, 0.001, 5));
    scan.fields.push_back(E57Field::integer("cartesianInvalidState", 0, 2));
    scan.records = 4;
    scan.raw = [](std::uint64_t record, std::size_t field) -> std::int64_t {
        if (field == 3) return record == 1 ? 2 : 0;
        return std::array{-2'147'483'648LL, 0LL, 77LL, 2'147'483'647LL}[record];
    };
    scan.xml = e57Pose(1, 0, 0, 0, 1, 2, 3);
    const auto result = imported(e57File({scan})).value();
    EXPECT_TRUE(result.asSteps);
    ASSERT_EQ(result.points.size(), 3U);
    EXPECT_EQ(result.dropped, 1U);
    const glm::dvec3 origin(6, 7, 8);
    EXPECT_EQ(result.points.position[0], origin + 0.001 * glm::dvec3(-2'147'483'648.0));
    EXPECT_EQ(result.points.position[1], origin + 0.001 * glm::dvec3(77));
    EXPECT_EQ(result.points.position[2], origin + 0.001 * glm::dvec3(2'147'483'647.0));
    auto wider = scan;
    wider.fields[2].maximum += 1;
    EXPECT_FALSE(imported(e57File({wider}))->asSteps);
    expectNear(imported(e57File({wider}))->points.position[2], origin + 0.001 * glm::dvec3(2'147'483'647.0));
    auto backwards = scan;
    backwards.fields[0].scale = -0.001;
    EXPECT_FALSE(imported(e57File({backwards}))->asSteps);
    // A range that is no power of two has bits for more than its greatest number.
    auto odd = scan;
    odd.fields[1].minimum = 2'147'483'640;
    odd.raw = [](std::uint64_t, std::size_t field) -> std::int64_t { return field == 3 ? 0 : 2'147'483'647; };
    EXPECT_TRUE(imported(e57File({odd}))->asSteps);
    odd.fields[1].minimum = 2'147'483'639;
    EXPECT_FALSE(imported(e57File({odd}))->asSteps);
}

TEST(Stations, AreThoseOfScansThatKnowThem) {
    const double half = std::sqrt(0.5);
    const auto named =
        "<name type=\"String\"><![CDATA[Tower, east]]></name>" + e57Pose(half, 0, 0, half, 7, 8, 9);
    const auto result =
        imported(e57File({cornerScan(), cornerScan(named), sphericalScan({{1, 0, 0}, {2, 0, 0}})})).value();
    ASSERT_EQ(result.stations.size(), 2U);
    EXPECT_EQ(result.stations[0].name, "Tower, east");
    expectNear(result.stations[0].position, {7, 8, 9});
    EXPECT_EQ(result.stations[0].points, 4U);
    ASSERT_TRUE(result.stations[0].forwards);
    expectNear(*result.stations[0].forwards, {0, 1, 0});
    EXPECT_EQ(result.stations[1].name, "");
    EXPECT_EQ(result.stations[1].position, glm::dvec3(0));
    EXPECT_EQ(result.stations[1].points, 2U);
    EXPECT_FALSE(result.stations[1].forwards);
    EXPECT_EQ(result.points.size(), 10U);
    EXPECT_THAT(imported(e57File({cornerScan()}))->stations, IsEmpty());
    // The first scan is often what the others are registered to: its pose turns nothing.
    const auto first = e57Pose(1, 0, 0, 0, 0, 0, 0);
    EXPECT_THAT(imported(e57File({cornerScan(first)}))->stations, IsEmpty());
    EXPECT_EQ(imported(e57File({cornerScan(first), cornerScan(named)}))->stations.size(), 2U);
}

TEST(Bounds, AreTurnedToo) {
    const std::string bounds =
        "<cartesianBounds><xMinimum>-5</xMinimum><xMaximum>1</xMaximum><yMinimum/><yMaximum>2</yMaximum>"
        "<zMinimum/><zMaximum>7</zMaximum></cartesianBounds>";
    const double half = std::sqrt(0.5);
    const auto header = imported(e57File({cornerScan(bounds + e57Pose(half, 0, 0, half, 10, 0, 0))}))->header;
    ASSERT_TRUE(header.bounds);
    expectNear((*header.bounds)[0], {8, -5, 0});
    expectNear((*header.bounds)[1], {10, 1, 7});
    const std::string endless =
        "<cartesianBounds><xMinimum>-1.79769313486231571e+308</xMinimum></cartesianBounds>";
    EXPECT_FALSE(imported(e57File({cornerScan(endless)}))->header.bounds);
}

}  // namespace scancast::test
