#include <gtest/gtest.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "simulator/scene.hpp"
#include "simulator/write/point_writer.hpp"
#include "tests/support/clouds/read_all.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/simulator/scan_file_checker.hpp"

namespace scancast {
namespace {

std::string write(const SceneOptions& options, WrittenFormat format, const std::string& name) {
    auto source = simulate(options).value();
    auto writer = createPointWriter(format, OutputFile::create(name).value(), source->header()).value();
    PointBatch batch;
    while (source->read(batch).value()) EXPECT_TRUE(writer->write(batch));
    EXPECT_TRUE(writer->finish());
    const std::string content = test::contentOf(name);
    EXPECT_EQ(writer->bytesWritten(), content.size());
    return content;
}

void expectSame(const PointBatch& read, const PointBatch& truth, double tolerance) {
    ASSERT_EQ(read.size(), truth.size());
    for (std::size_t i = 0; i < read.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            ASSERT_NEAR(read.position[i][axis], truth.position[i][axis], tolerance) << i;
    EXPECT_EQ(read.color, truth.color);
    EXPECT_EQ(read.intensity, truth.intensity);
    EXPECT_EQ(read.classification, truth.classification);
}

// What is written must be what the source yields, to half a step of the file's grid; sizes exact for odd
// numbers.
TEST(LasWriter, RoundTrip) {
    const test::TemporaryFolder folder;
    for (const WrittenFormat format : {WrittenFormat::Las12, WrittenFormat::Las14}) {
        for (const std::uint64_t points : {1u, 7u, test::sized(100003u, 5003u)}) {
            SceneOptions options{.scene = "town", .points = points};
            const auto file = test::parseLas(write(options, format, folder.file("a.las")));
            ASSERT_EQ(file.problem, "");
            EXPECT_EQ(file.minor, format == WrittenFormat::Las14 ? 4 : 2);
            EXPECT_EQ(file.format, format == WrittenFormat::Las14 ? 7 : 2);
            EXPECT_EQ(file.declared, points);
            const PointBatch truth = test::readAll(*simulate(options).value()).value();
            expectSame(file.points, truth, file.step.x / 2 + 1e-6);
            glm::dvec3 low(1e300), high(-1e300);
            for (const glm::dvec3& at : file.points.position) {
                low = glm::min(low, at);
                high = glm::max(high, at);
            }
            EXPECT_LT(glm::length(low - file.bounds[0]) + glm::length(high - file.bounds[1]), 1e-6);
        }
    }
}

TEST(PlyWriter, RoundTripWithFloatsAtHomeAndDoublesInUtm) {
    const test::TemporaryFolder folder;
    for (const bool utm : {false, true}) {
        SceneOptions options{.scene = "room", .points = 20011};
        if (utm) options.origin = glm::dvec3(389500.123, 5819800.456, 34);
        const auto file = test::parsePly(write(options, WrittenFormat::Ply, folder.file("a.ply")));
        ASSERT_EQ(file.problem, "");
        EXPECT_EQ(file.properties.front(), utm ? "double x" : "float x");
        const PointBatch truth = test::readAll(*simulate(options).value()).value();
        expectSame(file.points, truth, utm ? 0 : 1e-6);
        EXPECT_EQ(file.points.normal, truth.normal);
    }
}

TEST(LasWriter, RefusesMorePointsThanLas12Counts) {
    const test::TemporaryFolder folder;
    ScanHeader header;
    header.points = std::uint64_t(1) << 32;
    header.bounds = {{glm::dvec3(0), glm::dvec3(1)}};
    const auto writer =
        createPointWriter(WrittenFormat::Las12, OutputFile::create(folder.file("a.las")).value(), header);
    ASSERT_FALSE(writer);
    EXPECT_EQ(writer.error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(ScanFormatName, IsToldByTheEnding) {
    EXPECT_EQ(formatOfName("a/b.LAS"), WrittenFormat::Las12);
    EXPECT_EQ(formatOfName("x.ply"), WrittenFormat::Ply);
    EXPECT_EQ(formatOfName(".ply"), std::nullopt);
    EXPECT_EQ(formatOfName("ply"), std::nullopt);
    EXPECT_EQ(formatOfName("a.laz"), std::nullopt);
}

}  // namespace
}  // namespace scancast
