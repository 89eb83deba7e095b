// Octrees of real LAS files, and of one whose fields are random numbers.
#include <gtest/gtest.h>

#include "renderer/cloud/import/open_scan.hpp"
#include "tests/support/octree_checks.hpp"
#include "tests/support/test_data.hpp"

namespace scancast {
namespace {

struct Scan {
    const char* file;
    bool exact;  ///< leaves reach the file's own grid with 16 bits an axis
};

class RealScan : public testing::TestWithParam<Scan> {};

TEST_P(RealScan, BecomesAnOctreeThatHoldsEachPointOnce) {
    REQUIRE_TEST_DATA(GetParam().file);
    std::vector<glm::dvec3> input;
    auto source = openScan(test::testData(GetParam().file));
    ASSERT_TRUE(source) << source.error().message;
    PointBatch batch;
    while ((*source)->read(batch).value())
        input.insert(input.end(), batch.position.begin(), batch.position.end());

    source = openScan(test::testData(GetParam().file));
    ASSERT_TRUE(source);
    const auto cloud = test::build(**source, 4096);
    ASSERT_TRUE(cloud);
    EXPECT_EQ(cloud->points, input.size());
    test::checkStructure(*cloud, 4096);
    test::checkBounds(cloud->octree);
    test::checkEachPointOnce(*cloud, input, GetParam().exact ? 0 : -1);
}

INSTANTIATE_TEST_SUITE_P(Las, RealScan,
                         testing::Values(Scan{"las/autzen_trim.las", true}, Scan{"las/sample_c.las", true},
                                         Scan{"las/las13-pdrf1-vegetation.las", true},
                                         Scan{"las/lonlat-pdrf0.las", false},
                                         Scan{"las/pdrf10-1.4.las", false},
                                         Scan{"las/permutation-1.0_0.las", true}),
                         [](const auto& p) {
                             std::string name = p.param.file;
                             for (char& c : name)
                                 if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                             return name;
                         });

}  // namespace
}  // namespace scancast
