// Out again: what ingest kept is what comes out, each point once; with --exact, the same records.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <glm/common.hpp>
#include <map>
#include <set>
#include <sstream>
#include <stop_token>
#include <tuple>

#include "renderer/cloud/build/ingest.hpp"
#include "renderer/cloud/exact_columns.hpp"
#include "renderer/cloud/export/cloud_points.hpp"
#include "renderer/cloud/export/column_values.hpp"
#include "renderer/cloud/export/export_points.hpp"
#include "renderer/cloud/export/survey_ahead.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "tests/support/clouds/read_all.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/cloud/exported_las.hpp"
#include "tests/unit/import/las_bytes.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;
using test::RawLas;
using test::rawLas;

constexpr OctreeShape plainShape{.leafPoints = 4096, .chunkPoints = 50'000};
constexpr OctreeShape exactShape{.leafPoints = 4096, .chunkPoints = 50'000, .exact = true};

class Export : public ::testing::Test {
  protected:
    fs::path file(const std::string& name) const { return folder_ / name; }

    /// Into one cloud file; exactly where the shape says so.
    std::shared_ptr<const CloudFile> cloudOf(const std::vector<fs::path>& scans, const OctreeShape& shape,
                                             bool keepAttributes = false) {
        const ImportOptions import{.importerDirectory = SCANCAST_BIN_DIR,
                                   .keepAttributes = keepAttributes || shape.exact,
                                   .exact = shape.exact};
        std::vector<std::unique_ptr<PointSource>> sources;
        for (const fs::path& scan : scans) {
            auto source = openScan(scan, import);
            EXPECT_TRUE(source) << source.error().message;
            if (!source) return nullptr;
            sources.push_back(std::move(*source));
        }
        return cloudOf(std::move(sources), shape);
    }
    std::shared_ptr<const CloudFile> cloudOf(std::vector<std::unique_ptr<PointSource>> sources,
                                             const OctreeShape& shape) {
        const auto report = ingest(std::move(sources), {.output = file("cloud.scan"), .shape = shape});
        EXPECT_TRUE(report) << report.error().message;
        if (!report) return nullptr;
        auto opened = CloudFile::open(file("cloud.scan"));
        EXPECT_TRUE(opened) << opened.error().message;
        return opened ? *opened : nullptr;
    }
    std::shared_ptr<const CloudFile> cloudOf(std::unique_ptr<PointSource> source, const OctreeShape& shape) {
        std::vector<std::unique_ptr<PointSource>> sources;
        sources.push_back(std::move(source));
        return cloudOf(std::move(sources), shape);
    }

    ExportReport exported(const std::shared_ptr<const CloudFile>& cloud, const std::string& name,
                          const PointsRegion& region = {}) {
        const auto report = exportCloud(
            cloud, {.output = file(name).string(), .format = *exportFormatOf(name), .region = region});
        EXPECT_TRUE(report) << report.error().message;
        return report.value_or(ExportReport{});
    }

    const test::TemporaryFolder folder_;
};

/// Records of any point format, every bit of them made up, and extra bytes of every type.
std::string anyLas(int format, std::size_t points, std::int64_t reach) {
    test::LasFile las;
    las.minor = 4;
    las.format = format;
    las.scale = 0.001;
    las.offset = 1234.5;
    const std::size_t widths[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    std::string descriptors;
    for (int type = 1; type <= 10; ++type) {
        std::string descriptor(192, '\0');
        descriptor[2] = char(type);
        const std::string name = "extra of type " + std::to_string(type);
        descriptor.replace(4, name.size(), name);
        if (type == 4) {
            descriptor[3] = 8 | 16;
            const double scale = 0.25, offset = -3;
            std::memcpy(descriptor.data() + 112, &scale, 8);
            std::memcpy(descriptor.data() + 136, &offset, 8);
        }
        descriptors += descriptor;
        las.extraBytes = std::uint16_t(las.extraBytes + widths[type - 1]);
    }
    las.records.push_back({.user = "LASF_Spec", .id = 4, .content = descriptors});
    las.points.resize(points);
    const auto made = las.bytes();
    std::string bytes(reinterpret_cast<const char*>(made.data()), made.size());
    const std::size_t length = test::lasRecordLength(format) + las.extraBytes;
    const std::size_t first = bytes.size() - points * length;
    for (std::size_t i = 0; i < points; ++i) {
        char* record = bytes.data() + first + i * length;
        // One in ten is the one before once more, so that only the rows tell them apart.
        for (std::size_t b = 12; b < length; ++b) record[b] = char(test::uniform(i * length + b) * 256);
        for (int a = 0; a < 3; ++a) {
            const auto from = i % 10 == 9 ? i - 1 : i;
            const auto q = std::int32_t(
                std::int64_t(test::uniform(from, 20 + std::uint64_t(a)) * double(2 * reach)) - reach);
            std::memcpy(record + 4 * a, &q, 4);
        }
    }
    return bytes;
}

void expectTheSameRecords(const RawLas& out, const RawLas& in, const std::string& what) {
    EXPECT_EQ(out.minor, 4) << what;
    EXPECT_EQ(out.format, in.format) << what;
    ASSERT_EQ(out.records.size(), in.records.size()) << what;
    EXPECT_TRUE(out.records == in.records) << what;
    EXPECT_EQ(out.grid(), in.grid()) << what;
}

// Right because every bit of every record is compared, with the file's own bytes.
TEST_F(Export, ExactlyIngestedLasComesOutWithTheSameRecords) {
    const std::size_t points = test::sized(12'000, 3'000);
    for (const int format : {0, 1, 2, 3, 6, 7, 8})
        // Leaves as wide as 32 bits, and leaves that 16 bits are enough for.
        for (const std::int64_t reach : {std::int64_t(2147483647), std::int64_t(20'000)}) {
            const std::string what = "format " + std::to_string(format) + ", " + std::to_string(reach);
            const auto scan = folder_.write("in.las", anyLas(format, points, reach));
            const auto cloud = cloudOf({scan}, exactShape);
            ASSERT_TRUE(cloud);
            EXPECT_TRUE(cloud->facts().exact);
            ASSERT_TRUE(cloud->facts().grid);
            EXPECT_EQ(cloud->facts().grid->step, glm::dvec3(0.001));
            const auto report = exported(cloud, "out.las");
            EXPECT_EQ(report.points, points);
            EXPECT_EQ(report.losses, std::vector<std::string>{}) << what;
            expectTheSameRecords(rawLas(file("out.las")), rawLas(scan), what);
        }
}

TEST_F(Export, RealLasComesOutWithTheSameRecords) {
    REQUIRE_TEST_DATA("las");
    int files = 0;
    for (const auto& entry : fs::directory_iterator(test::testData("las"))) {
        if (entry.path().extension() != ".las") continue;
        if (test::sanitized && entry.file_size() > 200'000) continue;
        const auto cloud = cloudOf({entry.path()}, exactShape);
        ASSERT_TRUE(cloud) << entry.path();
        if (cloud->facts().droppedPoints > 0) continue;
        exported(cloud, "out.las");
        expectTheSameRecords(rawLas(file("out.las")), rawLas(entry.path()), entry.path().filename());
        ++files;
    }
    EXPECT_GE(files, 10);
}

/// Positions as steps, and everything that a sample keeps.
using PlainPoint = std::tuple<std::int64_t, std::int64_t, std::int64_t, int, int, int, int, int>;

std::vector<PlainPoint> plainPoints(PointSource& source, const glm::dvec3& origin, const glm::dvec3& step) {
    const auto all = test::readAll(source);
    EXPECT_TRUE(all) << all.error().message;
    std::vector<PlainPoint> points;
    for (std::size_t i = 0; all && i < all->size(); ++i) {
        const glm::dvec3 q = glm::round((all->position[i] - origin) / step);
        const auto color = all->color.empty() ? std::array<std::uint8_t, 3>{} : all->color[i];
        points.emplace_back(std::int64_t(q.x), std::int64_t(q.y), std::int64_t(q.z),
                            all->intensity.empty() ? 0 : all->intensity[i],
                            all->classification.empty() ? 0 : all->classification[i], color[0], color[1],
                            color[2]);
    }
    std::sort(points.begin(), points.end());
    return points;
}

std::vector<PlainPoint> plainPoints(const fs::path& scan, const glm::dvec3& origin, const glm::dvec3& step) {
    auto source = openScan(scan, {.importerDirectory = SCANCAST_BIN_DIR});
    EXPECT_TRUE(source) << source.error().message;
    return source ? plainPoints(**source, origin, step) : std::vector<PlainPoint>{};
}

/// A survey of 200 x 200 metres with everything that a sample has.
std::unique_ptr<PointSource> survey(std::uint64_t points) {
    const auto make = [](std::uint64_t i, std::uint64_t n) {
        auto p = test::ground(i, n);
        p.position += glm::dvec3(500'000, 5'400'000, 300);
        p.intensity = std::uint16_t(i * 7);
        p.classification = std::uint8_t(1 + i % 9);
        return p;
    };
    return std::make_unique<test::SyntheticSource>(
        points, make, Attributes{.color = true, .intensity = true, .classification = true}, 0.001,
        glm::dvec3(500'000, 5'400'000, 0));
}

// Right because our own readers, which other tests hold against independent ones, read the same points.
TEST_F(Export, EachFormatReadsBackAsTheSamePoints) {
    // So many that no leaf is wider than 16 bits of the grid: nothing is rounded.
    const std::uint64_t points = 30'000;
    const auto cloud = cloudOf(survey(points), plainShape);
    ASSERT_TRUE(cloud);
    const glm::dvec3 origin = cloud->facts().grid->origin, step = cloud->facts().grid->step;
    const auto expected = plainPoints(*survey(points), origin, step);
    for (const char* name : {"out.las", "out.ply", "out.csv", "out.txt"}) {
        EXPECT_EQ(exported(cloud, name).points, points) << name;
        EXPECT_TRUE(plainPoints(file(name), origin, step) == expected) << name;
    }
    EXPECT_EQ(rawLas(file("out.las")).format, 2);
}

TEST_F(Export, ARegionIsWhatLiesInIt) {
    const std::uint64_t points = test::sized(30'000, 4'000);
    const auto cloud = cloudOf(survey(points), plainShape);
    ASSERT_TRUE(cloud);
    const glm::dvec3 origin = cloud->facts().grid->origin, step = cloud->facts().grid->step;
    PointsRegion region;
    region.clip = ClipBox{{500'040, 5'400'030, 290}, {500'150.5, 5'400'111.25, 302}};
    region.classes.emplace().set(2).set(5);
    // Brute force over the scan's own points.
    const auto all = test::readAll(*survey(points));
    ASSERT_TRUE(all);
    std::size_t inside = 0;
    for (std::size_t i = 0; i < all->size(); ++i) {
        const glm::dvec3& p = all->position[i];
        bool in = all->classification[i] == 2 || all->classification[i] == 5;
        for (int a = 0; a < 3; ++a) in = in && p[a] >= region.clip->min[a] && p[a] <= region.clip->max[a];
        inside += in;
    }
    ASSERT_GT(inside, 0u);
    for (const char* name : {"out.las", "out.ply", "out.csv"}) {
        EXPECT_EQ(exported(cloud, name, region).points, inside) << name;
        const auto found = plainPoints(file(name), origin, step);
        EXPECT_EQ(found.size(), inside) << name;
        for (const auto& p : found) EXPECT_TRUE(std::get<4>(p) == 2 || std::get<4>(p) == 5);
    }
    region.clip = ClipBox{{0, 0, 0}, {1, 1, 1}};
    const auto nothing = exportCloud(cloud, {.output = file("none.las").string(), .region = region});
    ASSERT_FALSE(nothing);
    EXPECT_EQ(nothing.error().code, ErrorCode::Empty);
    EXPECT_FALSE(fs::exists(file("none.las")));
    EXPECT_EQ(folder_.entries(), 4u) << "and nothing beside it";
}

/// Counts what is read of it.
class CountedFile final : public CloudFile {
  public:
    explicit CountedFile(std::shared_ptr<const CloudFile> file) : file_(std::move(file)) {}

    std::size_t blocks() const { return blocks_; }
    const fs::path& path() const override { return file_->path(); }
    std::uint64_t bytes() const override { return file_->bytes(); }
    const CloudFacts& facts() const override { return file_->facts(); }
    std::span<const StoredNode> nodes() const override { return file_->nodes(); }
    Expected<std::vector<Sample>> samples(std::uint32_t node) const override {
        ++blocks_;
        return file_->samples(node);
    }
    std::span<const ValuePlane> planes() const override { return file_->planes(); }
    Expected<std::vector<std::byte>> plane(std::uint32_t node, std::size_t index) const override {
        return file_->plane(node, index);
    }
    BlockPlace planePlace(std::uint32_t node, std::size_t index) const override {
        return file_->planePlace(node, index);
    }
    Expected<std::vector<std::byte>> rows(std::uint32_t node) const override { return file_->rows(node); }

  private:
    const std::shared_ptr<const CloudFile> file_;
    mutable std::atomic<std::size_t> blocks_{0};
};

PointSurvey surveyAhead(const std::shared_ptr<const CloudFile>& file, const CloudPointsOptions& what,
                        ExportFormat format) {
    SurveyAhead survey(file, what, format);
    for (;;) {
        const auto more = survey.step();
        EXPECT_TRUE(more) << more.error().message;
        if (!more || !*more) return survey.survey();
    }
}

PointSurvey surveyByReading(const std::shared_ptr<const CloudFile>& file, const CloudPointsOptions& what) {
    const auto source = cloudPoints(file, what);
    PointSurvey survey;
    PointBatch batch;
    while (*source->read(batch)) survey.add(batch, source->header());
    return survey;
}

std::vector<PointsRegion> someRegions(const CloudFacts& facts) {
    const glm::dvec3 low = facts.bounds[0], size = facts.bounds[1] - facts.bounds[0];
    const auto at = [&](double x, double y) { return glm::dvec2(low) + glm::dvec2(x, y) * glm::dvec2(size); };
    std::vector<PointsRegion> regions(6);
    regions[1].clip = ClipBox{low - 1.0, low + size * glm::dvec3(0.6, 0.5, 2)};
    regions[2].polygon = PlanPolygon{at(0.1, -0.1), at(0.9, 0.2), at(0.5, 0.9), at(0.5, 0.4)};
    regions[3].z = {low.z + 0.2 * size.z, low.z + 0.6 * size.z};
    regions[4].clips = {TurnedBox{.center = low + 0.5 * size, .size = size * 0.7, .turn = {25, 0, 0}}};
    regions[5].classes.emplace().set(2).set(5);
    return regions;
}

// Right because the other way reads every point. Exact clouds, too, whose leaves say less than their planes, with returns.
TEST_F(Export, ASurveyAheadKnowsWhatReadingFinds) {
    const std::size_t points = test::sized(40'000, 6'000);
    std::vector<std::shared_ptr<const CloudFile>> clouds{cloudOf(survey(points), plainShape)};
    for (const std::int64_t reach : {std::int64_t(2147483647), std::int64_t(20'000)})
        clouds.push_back(cloudOf({folder_.write("in.las", anyLas(6, points, reach))}, exactShape));
    for (const auto& cloud : clouds) {
        ASSERT_TRUE(cloud);
        for (const PointsRegion& region : someRegions(cloud->facts())) {
            const CloudPointsOptions what = cloudPointsOptions({.output = {}, .region = region});
            const PointSurvey expected = surveyByReading(cloud, what);
            const PointSurvey las = surveyAhead(cloud, what, ExportFormat::Las);
            EXPECT_EQ(las.points, expected.points);
            EXPECT_EQ(las.returns, expected.returns);
            EXPECT_EQ(las.low, expected.low);
            EXPECT_EQ(las.high, expected.high);
            EXPECT_EQ(surveyAhead(cloud, what, ExportFormat::Ply).points, expected.points);
        }
    }
}

TEST_F(Export, NodesOutsideAreNotReadAndThoseInsideAreNotCounted) {
    const auto cloud = cloudOf(survey(test::sized(200'000, 40'000)), plainShape);
    ASSERT_TRUE(cloud);
    const auto counted = std::make_shared<const CountedFile>(cloud);
    const glm::dvec3 low = cloud->facts().bounds[0];
    const CloudPointsOptions half = cloudPointsOptions(
        {.output = {}, .region = {.clip = ClipBox{low - 1.0, low + glm::dvec3(100, 300, 300)}}});
    const auto leaves = wantedLeaves(*cloud, half);
    const auto whole =
        std::size_t(std::ranges::count_if(leaves, [](const WantedLeaf& leaf) { return leaf.whole; }));
    EXPECT_GT(whole, leaves.size() / 3);
    EXPECT_LT(leaves.size(), wantedLeaves(*cloud, {}).size() * 3 / 4);
    surveyAhead(counted, half, ExportFormat::Ply);
    EXPECT_EQ(counted->blocks(), leaves.size() - whole);
    surveyAhead(counted, {}, ExportFormat::Las);
    EXPECT_LE(counted->blocks(), leaves.size() - whole + 40) << "its bounds are those of a few leaves";
    const auto corridor = Corridor::create({glm::dvec2(low), glm::dvec2(low) + 20.0}, 1);
    ASSERT_TRUE(corridor);
    const std::size_t before = counted->blocks();
    surveyByReading(counted, {.corridor = std::make_shared<const Corridor>(*corridor)});
    EXPECT_LT(counted->blocks() - before, wantedLeaves(*cloud, {}).size() / 3);
}

TEST_F(Export, WhoeverIsGoneIsReadNothingMore) {
    const auto cloud = cloudOf(survey(test::sized(200'000, 40'000)), plainShape);
    ASSERT_TRUE(cloud);
    const auto counted = std::make_shared<const CountedFile>(cloud);
    std::stop_source gone;
    const glm::dvec3 low = cloud->facts().bounds[0];
    const CloudPointsOptions half = cloudPointsOptions(
        {.output = {}, .region = {.clip = ClipBox{low - 1.0, low + glm::dvec3(100, 300, 300)}}},
        gone.get_token());
    const auto source = cloudPoints(counted, half);
    SurveyAhead survey(counted, half, ExportFormat::Las);
    PointBatch batch;
    ASSERT_TRUE(source->read(batch) && survey.step());
    const std::size_t before = counted->blocks();
    gone.request_stop();
    for (Expected<bool> more = true; more; more = source->read(batch)) ASSERT_TRUE(*more) << "it is not over";
    EXPECT_EQ(survey.step().error().code, ErrorCode::Cancelled);
    EXPECT_EQ(cloudPoints(counted, half)->read(batch).error().code, ErrorCode::Cancelled);
    EXPECT_EQ(counted->blocks(), before);
}

// What cannot be gone back in - a pipe, a connection - gets the same bytes as a file.
TEST_F(Export, AStreamGetsTheBytesOfAFile) {
    const std::size_t points = test::sized(20'000, 5'000);
    const auto cloud = cloudOf({folder_.write("in.las", anyLas(6, points, 2147483647))}, exactShape);
    ASSERT_TRUE(cloud);
    for (const PointsRegion& region : someRegions(cloud->facts())) {
        const CloudPointsOptions what = cloudPointsOptions({.output = {}, .region = region});
        if (surveyByReading(cloud, what).points == 0) continue;
        for (const char* name : {"out.las", "out.ply", "out.csv"}) {
            const ExportFormat format = *exportFormatOf(name);
            exported(cloud, name, region);
            std::string bytes;
            auto to = OutputFile::to([&](std::span<const std::byte> more) -> Expected<void> {
                bytes.append(reinterpret_cast<const char*>(more.data()), more.size());
                return {};
            });
            const auto source = cloudPoints(cloud, what);
            auto writer =
                createExport(format, std::move(to), source->header(), surveyAhead(cloud, what, format));
            ASSERT_TRUE(writer);
            PointBatch batch;
            PointSurvey written;
            while (*source->read(batch)) {
                written.add(batch, source->header());
                ASSERT_TRUE((*writer)->write(batch));
            }
            ASSERT_TRUE((*writer)->finish(written));
            EXPECT_TRUE(bytes == test::contentOf(file(name))) << name;
        }
    }
}

// Every column as it is without a corridor, and two more before them.
TEST_F(Export, AProfileHasEveryPointOfItsCorridorWithAllThatWasKept) {
    const std::size_t points = test::sized(30'000, 6'000);
    const auto cloud = cloudOf({folder_.write("in.las", anyLas(3, points, 20'000))}, exactShape);
    ASSERT_TRUE(cloud);
    const glm::dvec2 low(cloud->facts().bounds[0]), high(cloud->facts().bounds[1]);
    const auto corridor = Corridor::create({low, {high.x, low.y + 3}, high}, 6);
    ASSERT_TRUE(corridor);
    const auto all = cloudPoints(cloud),
               along = cloudPoints(cloud, {.corridor = std::make_shared<const Corridor>(*corridor)});
    const std::size_t stride = rowBytes(all->header().columns), wide = rowBytes(along->header().columns);
    ASSERT_EQ(wide, stride + 16);
    ASSERT_EQ(along->header().columns[0].name, "station");
    ASSERT_EQ(along->header().columns[1].name, "offset");
    const auto everything = test::readAll(*all), found = test::readAll(*along);
    ASSERT_TRUE(everything && found);
    std::size_t at = 0;
    for (std::size_t i = 0; i < everything->size(); ++i) {
        const auto place = corridor->place(glm::dvec2(everything->position[i]));
        if (!place) continue;
        ASSERT_LT(at, found->size());
        ASSERT_EQ(found->position[at], everything->position[i]);
        ASSERT_EQ(found->color[at], everything->color[i]);
        ASSERT_EQ(found->intensity[at], everything->intensity[i]);
        ASSERT_EQ(found->classification[at], everything->classification[i]);
        double station = 0, offset = 0;
        std::memcpy(&station, found->rows.data() + at * wide, 8);
        std::memcpy(&offset, found->rows.data() + at * wide + 8, 8);
        ASSERT_EQ(station, place->station);
        ASSERT_EQ(offset, place->offset);
        ASSERT_EQ(
            std::memcmp(found->rows.data() + at * wide + 16, everything->rows.data() + i * stride, stride),
            0);
        ++at;
    }
    EXPECT_EQ(at, found->size());
    EXPECT_GT(at, points / 20);
}

TEST_F(Export, RoundingIsToldAndHolds) {
    // Ten kilometres in steps of 0.1 mm: 16 bits a leaf are 6.5 m.
    const auto make = [](std::uint64_t i, std::uint64_t) {
        test::ScanPoint p;
        p.position = {test::uniform(i, 1) * 10'000, test::uniform(i, 2) * 10'000, test::uniform(i, 3) * 10};
        p.intensity = std::uint16_t(i);
        return p;
    };
    const std::uint64_t points = 20'000;
    const auto source = [&] {
        return std::make_unique<test::SyntheticSource>(points, make, Attributes{.intensity = true}, 0.0001);
    };
    const auto cloud = cloudOf(source(), plainShape);
    ASSERT_TRUE(cloud);
    const RoundedPoints rounded = roundedPoints(*cloud, {});
    EXPECT_EQ(rounded.points, points);
    EXPECT_GT(rounded.most.x, 0.0001);
    const auto report = exported(cloud, "out.ply");
    ASSERT_FALSE(report.losses.empty());
    EXPECT_NE(report.losses[0].find("positions of 20000 points were rounded"), std::string::npos)
        << report.losses[0];
    // By intensity, which tells them apart.
    std::map<int, glm::dvec3> was;
    const auto before = test::readAll(*source());
    for (std::size_t i = 0; i < before->size(); ++i) was[before->intensity[i]] = before->position[i];
    const auto after = test::readAll(*cloudPoints(cloud));
    ASSERT_TRUE(after);
    ASSERT_EQ(after->size(), points);
    for (std::size_t i = 0; i < after->size(); ++i) {
        const glm::dvec3 off = glm::abs(after->position[i] - was.at(after->intensity[i]));
        for (int a = 0; a < 3; ++a) ASSERT_LE(off[a], rounded.most[a] * (1 + 1e-6) + 1e-9) << i;
    }
    // And kept exactly where that is asked for.
    const auto exact = cloudOf(source(), exactShape);
    ASSERT_TRUE(exact);
    EXPECT_EQ(roundedPoints(*exact, {}).points, 0u);
    const auto exactly = test::readAll(*cloudPoints(exact));
    ASSERT_TRUE(exactly);
    for (std::size_t i = 0; i < exactly->size(); ++i)
        ASSERT_EQ(exactly->position[i], was.at(exactly->intensity[i])) << i;
}

// Scans without a grid: doubles and normals as they were, bit for bit, in PLY and in CSV.
TEST_F(Export, DoublesSurvive) {
    const auto make = [](std::uint64_t i, std::uint64_t n) {
        auto p = test::ball(i, n);
        p.position += glm::dvec3(1e6, 1.0 / 3, -1e-3);
        return p;
    };
    const std::uint64_t points = 5'000;
    const auto source = [&] {
        return std::make_unique<test::SyntheticSource>(points, make,
                                                       Attributes{.color = true, .normal = true});
    };
    const auto cloud = cloudOf(source(), exactShape);
    ASSERT_TRUE(cloud);
    EXPECT_FALSE(cloud->facts().grid);
    using Exact = std::array<double, 6>;
    const auto exactPoints = [](const PointBatch& batch) {
        std::vector<Exact> all;
        for (std::size_t i = 0; i < batch.size(); ++i) {
            const auto& p = batch.position[i];
            const auto& n = batch.normal[i];
            all.push_back({p.x, p.y, p.z, n.x, n.y, n.z});
        }
        std::sort(all.begin(), all.end());
        return all;
    };
    const auto before = exactPoints(*test::readAll(*source()));
    EXPECT_TRUE(exactPoints(*test::readAll(*cloudPoints(cloud))) == before);
    EXPECT_EQ(exported(cloud, "out.csv").losses, std::vector<std::string>{});
    // The text itself, so that no reader makes unit vectors of the normals.
    std::ifstream text(file("out.csv"));
    std::string line;
    ASSERT_TRUE(std::getline(text, line));
    EXPECT_EQ(line, "x,y,z,red,green,blue,nx,ny,nz");
    std::vector<Exact> written;
    while (std::getline(text, line)) {
        std::array<double, 9> numbers{};
        const char* at = line.data();
        for (double& number : numbers) at = std::from_chars(at, line.data() + line.size(), number).ptr + 1;
        written.push_back({numbers[0], numbers[1], numbers[2], double(float(numbers[6])),
                           double(float(numbers[7])), double(float(numbers[8]))});
    }
    std::sort(written.begin(), written.end());
    EXPECT_TRUE(written == before);
    // LAS has 32 bits: as fine as those allow, and said.
    const auto las = exported(cloud, "out.las");
    ASSERT_FALSE(las.losses.empty());
    EXPECT_NE(las.losses.back().find("rounded to the steps of the file"), std::string::npos)
        << las.losses.back();
}

TEST_F(Export, ScansOfDifferentColumnsKeepAllOfThem) {
    const auto a = folder_.write("a.las", anyLas(3, 500, 20'000)),
               b = folder_.write("b.las", anyLas(7, 400, 20'000));
    const auto cloud = cloudOf({a, b}, exactShape);
    ASSERT_TRUE(cloud);
    std::set<std::string> names;
    for (const KeptColumn& kept : cloud->facts().columns) EXPECT_TRUE(names.insert(kept.column.name).second);
    for (const char* name : {"scan_angle", "scan_angle_2", "scanner_channel", "gps_time", "red_16"})
        EXPECT_TRUE(names.contains(name)) << name;
    exported(cloud, "out.las");
    const auto out = rawLas(file("out.las"));
    EXPECT_EQ(out.records.size(), 900u);
    EXPECT_EQ(out.format, 7);
    // Positions and intensity: the first 14 bytes of every format.
    std::vector<std::string> expected, found;
    for (const auto& scan : {a, b})
        for (const std::string& record : rawLas(scan).records) expected.push_back(record.substr(0, 14));
    for (const std::string& record : out.records) found.push_back(record.substr(0, 14));
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    EXPECT_TRUE(found == expected);
}

TEST_F(Export, ThreadsDoNotShow) {
    const auto cloud = cloudOf({folder_.write("in.las", anyLas(3, 5'000, 100'000))}, exactShape);
    ASSERT_TRUE(cloud);
    for (const char* end : {".las", ".ply", ".csv"}) {
        {
            const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
            exported(cloud, std::string("one") + end);
        }
        exported(cloud, std::string("many") + end);
        EXPECT_TRUE(test::contentOf(file(std::string("one") + end)) ==
                    test::contentOf(file(std::string("many") + end)))
            << end;
    }
}

// What bounds memory: batches are small, also where so many points lie at one place that their leaf is not.
TEST_F(Export, BatchesAreSmallWhateverALeafHolds) {
    const auto make = [](std::uint64_t i, std::uint64_t) {
        test::ScanPoint p;
        p.position = glm::dvec3(i < 1'000 ? double(i) : 5'000.0);
        p.intensity = std::uint16_t(i);
        return p;
    };
    const std::uint64_t points = 150'000;
    const auto cloud =
        cloudOf(std::make_unique<test::SyntheticSource>(points, make, Attributes{.intensity = true}, 0.01),
                exactShape);
    ASSERT_TRUE(cloud);
    const auto source = cloudPoints(cloud);
    std::vector<int> seen(65536);
    PointBatch batch;
    std::uint64_t read = 0;
    while (*source->read(batch)) {
        ASSERT_LE(batch.size(), PointSource::batchPoints);
        ASSERT_EQ(batch.intensity.size(), batch.size());
        read += batch.size();
        for (const std::uint16_t i : batch.intensity) ++seen[i];
    }
    EXPECT_EQ(read, points);
    for (std::size_t i = 0; i < seen.size(); ++i) ASSERT_EQ(seen[i], i < points % 65536 ? 3 : 2) << i;
}

TEST_F(Export, AFullDiskIsAClearError) {
    const auto cloud = cloudOf(survey(2'000), plainShape);
    ASSERT_TRUE(cloud);
    for (const ExportFormat format : {ExportFormat::Las, ExportFormat::Ply, ExportFormat::Csv}) {
        const auto report = exportCloud(cloud, {.output = "/dev/full", .format = format});
        ASSERT_FALSE(report);
        EXPECT_EQ(report.error().code, ErrorCode::ResourceLimit);
        EXPECT_NE(report.error().message.find("/dev/full"), std::string::npos) << report.error().message;
    }
}

TEST_F(Export, ADamagedBlockIsAnErrorAndLeavesNothing) {
    ASSERT_TRUE(cloudOf(survey(2'000), plainShape));
    std::string bytes = test::contentOf(file("cloud.scan"));
    bytes[200] = char(bytes[200] ^ 1);
    const auto damaged = CloudFile::open(folder_.write("damaged.scan", bytes));
    ASSERT_TRUE(damaged) << damaged.error().message;
    const auto report = exportCloud(*damaged, {.output = file("out.las").string()});
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, ErrorCode::Malformed);
    EXPECT_EQ(folder_.entries(), 2u);
}

TEST_F(Export, StoppedItLeavesNothing) {
    const auto cloud = cloudOf(survey(2'000), plainShape);
    ASSERT_TRUE(cloud);
    std::stop_source stop;
    stop.request_stop();
    const auto report = exportCloud(cloud, {.output = file("out.las").string()}, {}, stop.get_token());
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, ErrorCode::Cancelled);
    EXPECT_EQ(folder_.entries(), 1u);
}

TEST(ExportFormats, ThoseThatNobodyWritesAreRefusedWithAWayOut) {
    EXPECT_EQ(exportFormatOf("a.LAS"), ExportFormat::Las);
    EXPECT_EQ(exportFormatOf("a.xyz"), ExportFormat::Text);
    const auto laz = exportFormatOf("a.copc.laz");
    ASSERT_FALSE(laz);
    EXPECT_EQ(laz.error().code, ErrorCode::Unsupported);
    EXPECT_NE(laz.error().message.find("pdal translate"), std::string::npos);
    EXPECT_EQ(exportFormatOf("a.e57").error().code, ErrorCode::Unsupported);
    EXPECT_EQ(exportFormatOf("a").error().code, ErrorCode::InvalidArgument);
}

TEST(DecimalGrid, IsThereWhereDigitsSayItExactly) {
    const auto centimetres = decimalGrid(635'577.79, 0.01);
    ASSERT_TRUE(centimetres);
    EXPECT_EQ(centimetres->digits, 2);
    EXPECT_EQ(centimetres->origin, 63'557'779);
    EXPECT_EQ(centimetres->step, 1);
    EXPECT_EQ(decimalGrid(0, 0.00025)->step, 25);
    EXPECT_EQ(decimalGrid(-180, 1e-7)->digits, 7);
    EXPECT_FALSE(decimalGrid(0, 1.0 / 3));
    EXPECT_FALSE(decimalGrid(1e9, 0x1p-40));
    EXPECT_FALSE(decimalGrid(0, 1e-30));
}

}  // namespace
}  // namespace scancast
