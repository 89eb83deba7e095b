// Surfels agree with the Point Cloud Library's. Right because its kd-tree, covariance and eigenvectors share
// no code with ours: what both say of a real scan is what the scan says.
#include <gtest/gtest.h>

#include "renderer/cloud/import/open_scan.hpp"
#include "simulator/scene.hpp"
#include "tests/support/clouds/compare_surfels.hpp"
#include "tests/support/clouds/point_sets.hpp"
#include "tests/support/clouds/scan_points.hpp"
#include "tests/support/test_data.hpp"

namespace scancast {
namespace {

void expectAgreement(const test::Points& points) {
    const test::Points distinct = test::distinct(points);
    std::vector<Surfel> ours(distinct.size());
    estimateSurfels(distinct, {.neighbours = 10}, ours);
    const auto pcl = test::surfelsByPcl(distinct, 10, 2);
    const test::Agreement a = test::compare(ours, pcl.surfels);
    std::printf("%zu compared, %.3f %% of normals, %.3f %% of radii; left out: %zu lines, %zu ties\n",
                a.compared, 100 * a.share(a.normals), 100 * a.share(a.radii), a.doubled, a.tied);
    EXPECT_GT(a.compared, distinct.size() / 3);
    EXPECT_GE(a.share(a.normals), 0.99);
    EXPECT_GE(a.share(a.radii), 0.99);
}

class RealScan : public testing::TestWithParam<const char*> {};

TEST_P(RealScan, HasTheNormalsAndRadiiThatPclFinds) {
    REQUIRE_TEST_DATA(GetParam());
    const auto source = openScan(test::testData(GetParam()), {.importerDirectory = SCANCAST_BIN_DIR});
    ASSERT_TRUE(source) << source.error().message;
    const auto points = test::readPositions(**source);
    ASSERT_TRUE(points) << points.error().message;
    expectAgreement(*points);
}

INSTANTIATE_TEST_SUITE_P(SurfelsLikePcl, RealScan,
                         testing::Values("ply/guanyin-statue.ply", "ply/bun_zipper.ply",
                                         "ply/3dmatch-cloud_bin_0.ply", "pcd/office1.pcd", "pcd/zaghetto.pcd",
                                         "las/autzen_trim.las", "las/sample_c.las",
                                         "las/las14-pdrf7-color.las"),
                         [](const auto& p) {
                             std::string name = p.param;
                             for (char& c : name)
                                 if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                             return name;
                         });

TEST(SurfelsLikePcl, OfTheGeneratedTown) {
    SceneOptions options;
    options.scene = "town";
    options.points = 200000;
    const auto source = simulate(options);
    ASSERT_TRUE(source);
    const auto points = test::readPositions(**source);
    ASSERT_TRUE(points);
    expectAgreement(*points);
}

}  // namespace
}  // namespace scancast
