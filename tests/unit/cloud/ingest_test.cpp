// Building a cloud file: the same cloud as in memory, whatever the room; rows that follow their points;
// nothing left of what failed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/build/cloud_builder.hpp"
#include "renderer/cloud/build/ingest.hpp"
#include "renderer/cloud/build/revision.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/forwarding_source.hpp"
#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;
using test::ScanPoint;
using test::SyntheticSource;

class Ingest : public ::testing::Test {
  protected:
    fs::path file(const char* name) const { return folder_ / name; }

    const test::TemporaryFolder folder_;
};

constexpr OctreeShape smallShape{.leafPoints = 256, .chunkPoints = 4000, .surfels = true};

std::unique_ptr<PointSource> ground(std::uint64_t points, Attributes attributes = {.color = true}) {
    return std::make_unique<SyntheticSource>(points, test::ground, attributes, 0.001);
}

std::vector<std::unique_ptr<PointSource>> one(std::unique_ptr<PointSource> source) {
    std::vector<std::unique_ptr<PointSource>> list;
    list.push_back(std::move(source));
    return list;
}

TEST_F(Ingest, TheFileHoldsWhatMemoryWould) {
    const auto report =
        ingest(one(ground(30'000)), {.output = file("a.scan"), .title = "ground", .shape = smallShape});
    ASSERT_TRUE(report) << report.error().message;
    const auto source = ground(30'000);
    const auto inMemory = buildCloud(*source, {.title = "ground", .shape = smallShape});
    ASSERT_TRUE(inMemory);
    const auto opened = CloudFile::open(file("a.scan"));
    ASSERT_TRUE(opened) << opened.error().message;
    const CloudFacts& facts = (*opened)->facts();
    EXPECT_EQ(facts.revision, (*inMemory)->revision);
    EXPECT_EQ(facts.points, 30'000u);
    EXPECT_EQ(facts.bounds, (*inMemory)->bounds);
    EXPECT_EQ(facts.spacing, (*inMemory)->spacing);
    EXPECT_TRUE(facts.surfels);
    EXPECT_FALSE(facts.oriented);
    EXPECT_EQ(report->fileBytes, fs::file_size(file("a.scan")));
    const auto nodes = (*inMemory)->octree.nodes();
    ASSERT_EQ((*opened)->nodes().size(), nodes.size());
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        const auto stored = (*opened)->samples(i);
        ASSERT_TRUE(stored) << stored.error().message;
        const auto run = (*inMemory)->octree.run(i);
        ASSERT_EQ(stored->size(), run->samples.size());
        ASSERT_EQ(std::memcmp(stored->data(), run->samples.data(), stored->size() * sizeof(Sample)), 0) << i;
    }
}

/// A source with a row for each point, made of its position.
class RowSource final : public ForwardingSource {
  public:
    explicit RowSource(std::unique_ptr<PointSource> source)
        : ForwardingSource(std::move(source)), header_(this->source().header()) {
        header_.columns = {{"x", ColumnType::Float64, 2, 1, ""}, {"n", ColumnType::Uint32, 1, 0, ""}};
    }
    const ScanHeader& header() const override { return header_; }
    Expected<bool> read(PointBatch& batch) override {
        auto more = source().read(batch);
        for (const glm::dvec3& p : batch.position) {
            const double x = p.x;
            const std::uint32_t n = count_++;
            const auto put = [&](const void* from, std::size_t size) {
                const auto* bytes = static_cast<const std::byte*>(from);
                batch.rows.insert(batch.rows.end(), bytes, bytes + size);
            };
            put(&x, 8);
            put(&n, 4);
        }
        return more;
    }

  private:
    ScanHeader header_;
    std::uint32_t count_ = 0;
};

/// As ingest() does, with a workspace of this many bytes in memory.
void buildWithin(std::uint64_t memory, int threads, int lanes, const fs::path& output) {
    auto writer = CloudFileWriter::create(output);
    ASSERT_TRUE(writer) << writer.error().message;
    Workspace workspace(memory, output.parent_path());
    RowSource source(ground(30'000));
    auto built = buildFrom(source, smallShape, {workspace, writer->get(), threads, lanes}, {}, {});
    ASSERT_TRUE(built) << built.error().message;
    if (memory == 0) {
        EXPECT_GT(workspace.mostOnDisk(), 30'000u * 20);
    }
    built->facts.revision = revisionOf(built->facts, built->octree);
    ASSERT_TRUE((*writer)->finish(built->facts, built->octree.nodes, built->octree.planes));
}

// The promise is bytes, so bytes are compared.
TEST_F(Ingest, NeitherMemoryNorThreadsShow) {
    buildWithin(Workspace::unlimited, 1, 1, file("a.scan"));
    buildWithin(0, 2, 2, file("b.scan"));
    buildWithin(700'000, 3, 3, file("c.scan"));
    const std::string expected = test::contentOf(file("a.scan"));
    EXPECT_TRUE(test::contentOf(file("b.scan")) == expected);
    EXPECT_TRUE(test::contentOf(file("c.scan")) == expected);
    EXPECT_EQ(folder_.entries(), 3u) << "temporary files have no names";
}

// Right because each row says where its point lies, whatever way it took.
TEST_F(Ingest, RowsFollowTheirPoints) {
    auto source = std::make_unique<RowSource>(ground(20'000));
    const auto report = ingest(one(std::move(source)), {.output = file("a.scan"), .shape = smallShape});
    ASSERT_TRUE(report) << report.error().message;
    const auto opened = CloudFile::open(file("a.scan"));
    ASSERT_TRUE(opened) << opened.error().message;
    const CloudFacts& facts = (*opened)->facts();
    ASSERT_EQ(facts.columns.size(), 2u);
    EXPECT_EQ(facts.columns[1].range, (std::array<double, 2>{0, 19'999}));
    EXPECT_NEAR(facts.columns[0].range[1], 2 * facts.bounds[1].x + 1, 1e-6);
    std::vector<bool> seen(20'000);
    for (std::uint32_t i = 0; i < (*opened)->nodes().size(); ++i) {
        const Node& n = (*opened)->nodes()[i].node;
        const auto rows = (*opened)->rows(i);
        ASSERT_TRUE(rows) << rows.error().message;
        if (!n.isLeaf()) {
            EXPECT_TRUE(rows->empty());
            continue;
        }
        const auto samples = (*opened)->samples(i);
        ASSERT_EQ(rows->size(), samples->size() * 12);
        for (std::size_t s = 0; s < samples->size(); ++s) {
            double x = 0;
            std::uint32_t number = 0;
            std::memcpy(&x, rows->data() + s * 12, 8);
            std::memcpy(&number, rows->data() + s * 12 + 8, 4);
            ASSERT_NEAR(position(n, (*samples)[s]).x + facts.origin.x, x, 1e-9);
            ASSERT_FALSE(seen[number]);
            seen[number] = true;
        }
    }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), true), 20'000);
}

/// Fails, or asks for a stop, after some batches.
class EndingSource final : public ForwardingSource {
  public:
    EndingSource(std::unique_ptr<PointSource> source, std::function<Expected<void>()> end)
        : ForwardingSource(std::move(source)), end_(std::move(end)) {}
    Expected<bool> read(PointBatch& batch) override {
        if (++batches_ == 2)
            if (auto ok = end_(); !ok) return passOn(ok);
        return source().read(batch);
    }

  private:
    std::function<Expected<void>()> end_;
    int batches_ = 0;
};

TEST_F(Ingest, WhatFailsLeavesNothing) {
    auto failing = std::make_unique<EndingSource>(
        ground(200'000), []() -> Expected<void> { return fail(ErrorCode::Truncated, "it ends early"); });
    const auto failed = ingest(one(std::move(failing)), {.output = file("a.scan"), .shape = smallShape});
    ASSERT_FALSE(failed);
    EXPECT_EQ(failed.error().message, "it ends early");
    EXPECT_EQ(folder_.entries(), 0u);

    std::stop_source stop;
    auto stopping = std::make_unique<EndingSource>(ground(200'000), [&]() -> Expected<void> {
        stop.request_stop();
        return {};
    });
    const auto stopped = ingest(one(std::move(stopping)), {.output = file("a.scan"), .shape = smallShape}, {},
                                stop.get_token());
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().code, ErrorCode::Cancelled);
    EXPECT_EQ(folder_.entries(), 0u);
}

TEST_F(Ingest, StopsInEveryStage) {
    for (const std::string stage : {"reading", "sorting", "building", "finishing"}) {
        std::stop_source stop;
        const auto stopped = ingest(
            one(ground(test::sized(200'000, 50'000))), {.output = file("a.scan"), .shape = smallShape},
            [&](const Progress& p) {
                if (p.stage == stage) stop.request_stop();
            },
            stop.get_token());
        // The last report of the last stage comes when there is nothing left to stop.
        if (stage != "finishing") {
            EXPECT_FALSE(stopped) << stage;
        }
        EXPECT_EQ(folder_.entries(), stopped ? 1u : 0u) << stage;
        fs::remove(file("a.scan"));
    }
}

TEST_F(Ingest, RefusesWhatTheDiskCannotHold) {
    class Huge final : public PointSource {
      public:
        Huge() { header_.points = std::uint64_t(1) << 50; }
        const ScanHeader& header() const override { return header_; }
        Expected<bool> read(PointBatch&) override {
            ADD_FAILURE() << "nothing should be read";
            return false;
        }
        std::uint64_t droppedPoints() const override { return 0; }

      private:
        ScanHeader header_;
    };
    const auto refused = ingest(one(std::make_unique<Huge>()), {.output = file("a.scan")});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::ResourceLimit);
    EXPECT_NE(refused.error().message.find("are free"), std::string::npos) << refused.error().message;
    EXPECT_EQ(folder_.entries(), 0u);
}

TEST_F(Ingest, AMemoryLimitThatIsTooSmallIsRefused) {
    const auto refused = ingest(one(ground(10)), {.output = file("a.scan"), .memoryLimit = 1 << 20});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
    EXPECT_NE(refused.error().message.find("512M"), std::string::npos);
}

TEST_F(Ingest, NormalsAreCertainWhereNobodyGuessed) {
    for (const Orientation orientation : {Orientation::Up, Orientation::Scan}) {
        OctreeShape shape = smallShape;
        shape.orientation = orientation;
        ASSERT_TRUE(ingest(one(ground(3000)), {.output = file("a.scan"), .shape = shape}));
        const auto opened = CloudFile::open(file("a.scan")).value();
        EXPECT_EQ(opened->facts().oriented, orientation == Orientation::Up);
        for (const StoredNode& stored : opened->nodes())
            ASSERT_EQ(stored.node.confidence, opened->facts().oriented ? certainSide : 0);
    }
}

/// A floor, of which scanners above and below saw every other stretch of 20: batches are as large as stretches.
class SeenFromBothSides final : public PointSource {
  public:
    static glm::dvec3 scannerOf(double x) { return {100, 100, int(x / 20) % 2 == 0 ? 30 : -30}; }
    explicit SeenFromBothSides(bool allKnown) : allKnown_(allKnown) {
        header_.attributes.color = true;
        header_.gridStep = glm::dvec3(0.001);
    }
    const ScanHeader& header() const override { return header_; }
    Expected<bool> read(PointBatch& batch) override {
        batch.clear();
        if (stretch_ == 10) return false;
        for (int i = 0; i < 3000; ++i) {
            const auto number = std::uint64_t(stretch_ * 3000 + i);
            const double x = 20 * stretch_ + 20 * test::uniform(number, 1),
                         y = 200 * test::uniform(number, 2);
            batch.position.emplace_back(std::floor(x * 1000) / 1000, std::floor(y * 1000) / 1000,
                                        0.001 * int(5 * test::uniform(number, 3)));
            batch.color.push_back({200, 200, 200});
        }
        if (allKnown_ || stretch_ != 4) batch.scanner = scannerOf(20 * stretch_ + 1);
        ++stretch_;
        return true;
    }
    std::uint64_t droppedPoints() const override { return 0; }
    std::vector<Station> stations() const override {
        return {{.name = "above", .position = scannerOf(0)}, {.name = "below", .position = scannerOf(20)}};
    }

  private:
    ScanHeader header_;
    const bool allKnown_;
    int stretch_ = 0;
};

// Right because a point that was seen from above has a normal that points upwards.
TEST_F(Ingest, NormalsPointToWhoeverSawEachPoint) {
    SeenFromBothSides source(true);
    const auto built = buildCloud(source, {.title = "floor", .shape = smallShape});
    ASSERT_TRUE(built) << built.error().message;
    const Cloud& cloud = **built;
    EXPECT_TRUE(cloud.oriented);
    ASSERT_TRUE(cloud.sides);
    EXPECT_EQ(cloud.sides->by, KnownSides::By::Scanner);
    EXPECT_EQ(cloud.scanner, std::nullopt) << "it stood at two places";
    EXPECT_EQ(cloud.stations, source.stations());
    std::size_t samples = 0;
    const auto nodes = cloud.octree.nodes();
    for (std::uint32_t n = 0; n < nodes.size(); ++n) {
        if (!nodes[n].isLeaf()) continue;
        const auto run = cloud.octree.run(n);
        ASSERT_TRUE(run);
        for (const Sample& sample : run->samples) {
            const glm::dvec3 at = cloud.origin + position(nodes[n], sample);
            const double off = std::abs(std::remainder(at.x, 20));
            if (off < 0.01 || off > 9.99) continue;  // quantised across the seam
            const double towards = SeenFromBothSides::scannerOf(at.x).z;
            ASSERT_GT(decodeNormal(sample.normal).z * towards, 0) << at.x;
            ++samples;
        }
    }
    EXPECT_GT(samples, 29'000u);

    SeenFromBothSides partly(false);
    const auto guessed = buildCloud(partly, {.title = "floor", .shape = smallShape});
    ASSERT_TRUE(guessed);
    EXPECT_FALSE((*guessed)->oriented) << "of one stretch nobody knows it";
    EXPECT_EQ((*guessed)->sides->by, KnownSides::By::Neighbours);
}

// What shows through where normals are the scan's own, or nobody estimates any.
TEST_F(Ingest, WithoutEstimatedNormalsScannersLeaveNoTrace) {
    OctreeShape plain = smallShape;
    plain.surfels = false;
    SeenFromBothSides source(true);
    const auto built = buildCloud(source, {.title = "floor", .shape = plain});
    ASSERT_TRUE(built);
    for (std::uint32_t n = 0; n < (*built)->octree.nodes().size(); ++n) {
        const auto run = (*built)->octree.run(n);
        ASSERT_TRUE(run);
        for (const Sample& sample : run->samples) ASSERT_EQ(sample.normal, noNormal);
    }
}

TEST_F(Ingest, CarriesMirrors) {
    Mirror mirror;
    mirror.normal = {0, 1, 0};
    mirror.up = {0, 0, 1};
    mirror.width = 2;
    mirror.height = 3;
    ASSERT_TRUE(ingest(one(ground(1000)), {.output = file("a.scan"), .mirrors = {mirror}}));
    const auto opened = CloudFile::open(file("a.scan"));
    ASSERT_TRUE(opened);
    ASSERT_EQ((*opened)->facts().mirrors.size(), 1u);
    EXPECT_EQ((*opened)->facts().mirrors[0].height, 3);
}

}  // namespace
}  // namespace scancast
