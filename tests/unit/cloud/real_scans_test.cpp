// Octrees of real LAS files, and of one whose fields are random numbers; cloud files of every real scan.
#include <gtest/gtest.h>

#include <filesystem>
#include <glm/common.hpp>

#include "renderer/cloud/build/ingest.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/forwarding_source.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/import/real_scans.hpp"
#include "tests/unit/import/scan_summary.hpp"

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

/// Scans of more points are for tests/bench/ingest.py.
constexpr std::uint64_t mostPoints = 2'000'000;

std::vector<test::RealScan> readableScans() {
    std::vector<test::RealScan> scans;
    for (const auto& scan : test::realScans)
        if (scan.points <= mostPoints) scans.push_back(scan);
    return scans;
}

struct Found {
    std::uint64_t points = 0;
    glm::dvec3 low{1e300}, high{-1e300};
    std::array<std::uint64_t, 256> classes{};
    std::array<std::uint64_t, 3> color{};
    std::uint64_t intensity = 0;
};

/// A source, and the sums of what it delivers.
class AddedUp final : public ForwardingSource {
  public:
    /// `found` outlives this.
    AddedUp(std::unique_ptr<PointSource> source, Found& found)
        : ForwardingSource(std::move(source)), found_(found) {}
    Expected<bool> read(PointBatch& batch) override {
        auto more = source().read(batch);
        found_.points += batch.size();
        for (const glm::dvec3& p : batch.position) {
            found_.low = glm::min(found_.low, p);
            found_.high = glm::max(found_.high, p);
        }
        for (const auto c : batch.classification) ++found_.classes[c];
        for (const auto i : batch.intensity) found_.intensity += i;
        for (const auto& c : batch.color)
            for (int a = 0; a < 3; ++a) found_.color[std::size_t(a)] += c[a];
        return more;
    }

  private:
    Found& found_;
};

class IngestedScan : public testing::TestWithParam<test::RealScan> {};

// Right because what the reader delivered (itself compared with an independent program's findings, in
// tests/unit/import) is added up beside what the leaves of the file decode to.
TEST_P(IngestedScan, HoldsWhatTheScanHolds) {
    const auto& expected = GetParam();
    REQUIRE_TEST_DATA(expected.file);
    if (test::sanitized && expected.points > 200'000)
        GTEST_SKIP() << "more than 200,000 points are read in the other builds only";
    const ImportOptions options{.importerDirectory = SCANCAST_BIN_DIR, .keepAttributes = true};
    auto source = openScan(test::testData(expected.file), options);
    ASSERT_TRUE(source) << source.error().message;
    const std::size_t columns = (*source)->header().columns.size();
    Found read;
    std::vector<std::unique_ptr<PointSource>> sources;
    sources.push_back(std::make_unique<AddedUp>(std::move(*source), read));
    const auto output = std::filesystem::path(testing::TempDir()) /
                        ("scancast_real_" + test::fileAsTestName<test::RealScan>({expected, 0}) + ".scan");
    const auto report =
        ingest(std::move(sources), {.output = output, .shape = {.chunkPoints = 300'000, .surfels = true}});
    ASSERT_TRUE(report) << report.error().message;
    const auto file = CloudFile::open(output);
    std::filesystem::remove(output);
    ASSERT_TRUE(file) << file.error().message;
    const CloudFacts& facts = (*file)->facts();
    EXPECT_EQ(facts.points, expected.points - expected.dropped);
    EXPECT_EQ(facts.droppedPoints, expected.dropped);
    EXPECT_EQ(facts.bounds[0], read.low);
    EXPECT_EQ(facts.bounds[1], read.high);
    EXPECT_EQ(facts.columns.size(), columns);
    Found stored;
    for (std::uint32_t i = 0; i < (*file)->nodes().size(); ++i) {
        const auto samples = (*file)->samples(i);
        ASSERT_TRUE(samples) << samples.error().message;
        const auto rows = (*file)->rows(i);
        ASSERT_TRUE(rows) << rows.error().message;
        if (!(*file)->nodes()[i].node.isLeaf()) continue;
        stored.points += samples->size();
        for (const Sample& s : *samples) {
            ++stored.classes[s.classification];
            stored.intensity += s.intensity;
            stored.color[0] += s.r, stored.color[1] += s.g, stored.color[2] += s.b;
        }
    }
    EXPECT_EQ(stored.points, read.points);
    if (facts.attributes.classification) {
        EXPECT_EQ(stored.classes, read.classes);
    }
    if (facts.attributes.color || facts.constant.color) {
        EXPECT_EQ(stored.color, read.color);
    }
    EXPECT_EQ(stored.intensity, read.intensity);
}

INSTANTIATE_TEST_SUITE_P(All, IngestedScan, testing::ValuesIn(readableScans()),
                         test::fileAsTestName<test::RealScan>);

}  // namespace
}  // namespace scancast
