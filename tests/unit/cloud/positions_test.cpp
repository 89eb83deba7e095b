// Positions as steps of a grid are the same points as the coordinates that they stand for.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/forwarding_source.hpp"
#include "renderer/cloud/positions.hpp"

namespace scancast::test {

namespace {

constexpr StepGrid centimetres{{471000, 4602000.5, -3}, {0.01, 0.01, 0.01}};

GridSteps stepsOf(std::size_t i) {
    return {std::int32_t(i * 7919 % 20011), std::int32_t(i * 104729 % 15013), std::int32_t(i % 97) - 40};
}

/// The same points, in one of three ways.
class GridScan final : public PointSource {
  public:
    enum class As { Doubles, Steps, StepsOfShiftedGrids };
    explicit GridScan(As as, const StepGrid& grid = centimetres) : as_(as), grid_(grid) {
        header_.gridOrigin = grid.origin;
        header_.gridStep = grid.step;
        header_.attributes.intensity = true;
    }
    const ScanHeader& header() const override { return header_; }
    std::uint64_t droppedPoints() const override { return 0; }
    Expected<bool> read(PointBatch& batch) override {
        batch.clear();
        if (at_ == 5) return false;
        // An origin that is 100 centimetres further each time, and numbers that take it back.
        const int shift = as_ == As::StepsOfShiftedGrids ? 100 * at_ : 0;
        const StepGrid grid{grid_.origin + grid_.step * double(shift), grid_.step};
        for (std::size_t i = 0; i < 1000; ++i) {
            GridSteps steps = stepsOf(i + 1000 * std::size_t(at_));
            if (as_ == As::Doubles) {
                batch.position.push_back(grid_.at(steps));
            } else {
                for (auto& s : steps) s -= shift;
                batch.position.steps(grid).push_back(steps);
            }
            batch.intensity.push_back(std::uint16_t(i));
        }
        ++at_;
        return true;
    }

  private:
    const As as_;
    const StepGrid grid_;
    ScanHeader header_;
    int at_ = 0;
};

/// And at its end a point that does not lie on the grid. Or all as coordinates of a scan without one.
class ScanWithStray final : public ForwardingSource {
  public:
    explicit ScanWithStray(bool asDoubles)
        : ForwardingSource(std::make_unique<GridScan>(GridScan::As::StepsOfShiftedGrids)),
          header_(source().header()),
          asDoubles_(asDoubles) {
        if (asDoubles) header_.gridStep = glm::dvec3(0);
    }
    const ScanHeader& header() const override { return header_; }
    Expected<bool> read(PointBatch& batch) override {
        auto more = source().read(batch);
        if (more && !*more && !std::exchange(hasStrayed_, true)) {
            batch.position.push_back(centimetres.origin + 0.123456);
            batch.intensity.push_back(7);
            return true;
        }
        if (asDoubles_) (void)batch.position.doubles();
        return more;
    }

  private:
    ScanHeader header_;
    const bool asDoubles_;
    bool hasStrayed_ = false;
};

}  // namespace

TEST(Positions, StepsReadAsCoordinates) {
    Positions positions;
    positions.steps(centimetres) = {{1, 2, 3}, {-2147483647 - 1, 0, 2147483647}};
    const Positions::Iterator begin = positions.begin();
    EXPECT_EQ(positions.end() - begin, 2);
    EXPECT_EQ(positions[0], glm::dvec3(471000 + 0.01 * 1, 4602000.5 + 0.01 * 2, -3 + 0.01 * 3));
    EXPECT_EQ(begin[1], positions.back());
    std::size_t seen = 0;
    positions.forEach([&](const glm::dvec3& p) { EXPECT_EQ(p, positions[seen++]); });
    EXPECT_EQ(seen, 2U);
    const Positions steps = positions;
    const auto bounds = boundsOf(positions);
    EXPECT_EQ(positions.doubles().size(), 2U);
    EXPECT_FALSE(positions.areSteps());
    EXPECT_EQ(positions, steps);
    EXPECT_EQ(boundsOf(positions), bounds);
    EXPECT_EQ(bounds[0], glm::dvec3(steps[1].x, steps[1].y, steps[0].z));
    positions.steps(centimetres);
    EXPECT_TRUE(positions.empty()) << "coordinates are no steps";
    EXPECT_GT(boundsOf(positions)[0].x, boundsOf(positions)[1].x);
}

TEST(Positions, GridsThatDifferByWholeSteps) {
    const auto moved = [](double by) { return StepGrid{centimetres.origin + by, centimetres.step}; };
    using Between = std::array<std::int64_t, 3>;
    EXPECT_EQ(centimetres.stepsIn(centimetres), (Between{0, 0, 0}));
    EXPECT_EQ(moved(5).stepsIn(centimetres), (Between{500, 500, 500}));
    EXPECT_EQ(centimetres.stepsIn(moved(1e6)), (Between{-100000000, -100000000, -100000000}));
    EXPECT_EQ(moved(0.005).stepsIn(centimetres), std::nullopt);
    EXPECT_EQ((StepGrid{centimetres.origin, {0.01, 0.01, 0.02}}).stepsIn(centimetres), std::nullopt);
    EXPECT_EQ(moved(1e14).stepsIn(centimetres), std::nullopt) << "farther than whole numbers of 32 bits";
    // A float64 of 1e9 does not tell steps of a tenth of a micrometre apart.
    const StepGrid fine{glm::dvec3(1e9), glm::dvec3(1e-7)};
    EXPECT_EQ(fine.stepsIn({glm::dvec3(1e9 + 1), fine.step}), std::nullopt);
}

// Right because the cloud's revision is made of all its samples and facts. The step is a power of two: coordinates of
// shifted grids are the same to the last bit.
TEST(Positions, TheCloudIsTheSame) {
    std::vector<std::string> revisions;
    for (const auto as : {GridScan::As::Doubles, GridScan::As::Steps, GridScan::As::StepsOfShiftedGrids}) {
        GridScan scan(as, {centimetres.origin, glm::dvec3(0x1p-7)});
        const auto cloud = buildCloud(scan, {});
        ASSERT_TRUE(cloud) << cloud.error().message;
        EXPECT_EQ((*cloud)->points, 5000U);
        revisions.push_back((*cloud)->revision);
    }
    EXPECT_EQ(revisions[1], revisions[0]);
    EXPECT_EQ(revisions[2], revisions[0]);
}

// Right because coordinates are what steps mean: to the last bit, though 0.01 is no sum of powers of two, and whatever comes after them.
TEST(Positions, WhatComesBeforeAStrayPointStaysWhereItIs) {
    std::vector<std::string> revisions;
    for (const bool asDoubles : {true, false}) {
        ScanWithStray scan(asDoubles);
        const auto cloud = buildCloud(scan, {});
        ASSERT_TRUE(cloud) << cloud.error().message;
        EXPECT_EQ((*cloud)->points, 5001U);
        EXPECT_FALSE((*cloud)->grid);
        revisions.push_back((*cloud)->revision);
    }
    EXPECT_EQ(revisions[1], revisions[0]);
}

TEST(Positions, CoordinatesThatNoScanHasAreRefused) {
    GridScan scan(GridScan::As::Steps, {glm::dvec3(2e15, 0, 0), glm::dvec3(1)});
    const auto cloud = buildCloud(scan, {});
    ASSERT_FALSE(cloud);
    EXPECT_EQ(cloud.error().code, ErrorCode::Malformed);
}

}  // namespace scancast::test
