// Octrees whose nodes are files of LAS: tiles of EPT, nodes of Potree 1. That LAZ gives the same records is proved where it is
// decoded; here it is what becomes of them, and of files that do not fit together.
#include <gmock/gmock.h>

#include "tests/unit/import/las_bytes.hpp"
#include "tests/unit/octree/ept_folder.hpp"

namespace scancast::test {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

namespace {

LasFile lasNode(int node, int mostColor = 65535) {
    LasFile file;
    file.scale = 0.5;
    file.offset = -100;
    for (int i = 0; i < eptPoints(node); ++i) {
        const auto p = eptPoint(node, i, mostColor);
        file.points.push_back({p.x, p.y, p.z, p.intensity, p.classification, p.rgb[0], p.rgb[1], p.rgb[2]});
    }
    return file;
}

void expectNode(const ReadScan& scan, std::size_t at, int node, int shift) {
    for (int i = 0; i < eptPoints(node); ++i, ++at) {
        const auto p = eptPoint(node, i, shift == 0 ? 255 : 65535);
        EXPECT_EQ(scan.points.position[at], glm::dvec3(-100 + p.x * 0.5, -100 + p.y * 0.5, -100 + p.z * 0.5));
        EXPECT_EQ(scan.points.intensity[at], p.intensity);
        EXPECT_EQ(scan.points.classification[at], p.classification);
        EXPECT_EQ(scan.points.color[at][0], p.rgb[0] >> shift);
    }
}

MemoryFiles lasEpt(int mostColor = 65535) {
    auto files = eptFolder("laszip");
    for (int node = 0; node < 5; ++node)
        files.files[std::string("ept-data/") + eptNames[node] + ".laz"] = lasNode(node, mostColor).bytes();
    return files;
}

std::string toldOf(const MemoryFiles& files, const char* description, bool keepAttributes = false) {
    const auto scan = readOctree(files, description, keepAttributes);
    return scan ? std::string() : scan.error().message;
}

}  // namespace

TEST(LasNodes, OfEptGiveWhatWasWritten) {
    for (const int mostColor : {255, 65535}) {
        const auto scan = readOctree(lasEpt(mostColor), "ept.json");
        ASSERT_TRUE(scan) << scan.error().message;
        EXPECT_EQ(scan->header.format, "EPT 1.0.0, laszip");
        EXPECT_EQ(scan->header.points, std::uint64_t(eptPointsInAll));
        EXPECT_EQ(scan->header.attributes, (Attributes{true, true, true, false}));
        EXPECT_EQ(scan->header.gridStep, glm::dvec3(0.5));  // the files', not ept.json's
        EXPECT_EQ(scan->header.crsEpsg, 26912);
        EXPECT_THAT(scan->notes, IsEmpty());
        ASSERT_EQ(scan->points.size(), std::size_t(eptPointsInAll));
        std::size_t at = 0;
        for (int node = 0; node < 5; at += std::size_t(eptPoints(node++)))
            expectNode(*scan, at, node, mostColor > 255 ? 8 : 0);
    }
}

TEST(LasNodes, KeepWhatLasKnows) {
    const auto scan = readOctree(lasEpt(), "ept.json", true).value();
    ASSERT_FALSE(scan.header.columns.empty());
    EXPECT_EQ(scan.header.columns.front().name, "return_number");
    EXPECT_EQ(scan.header.columns.back().name, "gps_time");
    EXPECT_EQ(scan.points.rows.size(), eptPointsInAll * 17);
}

TEST(LasNodes, OfPotreeWithGridsOfTheirOwn) {
    MemoryFiles files;
    files.write("cloud.js", R"({"version": "1.4", "octreeDir": "data", "pointAttributes": "LAS", "points": 11,
        "boundingBox": {"lx": 1, "ly": 2, "lz": 3, "ux": 9, "uy": 10, "uz": 11}, "hierarchy": [["r", 3], ["r4", 5], ["r5", 0]]})");
    auto other = lasNode(1);
    other.scale = 0.25;
    files.files["data/r.las"] = lasNode(0).bytes();
    files.files["data/r4.las"] = other.bytes();
    files.files["data/r5.las"] = LasFile{}.bytes();  // without a point
    const auto scan = readOctree(files, "cloud.js").value();
    EXPECT_EQ(scan.header.format, "Potree 1.4, LAS");
    EXPECT_EQ(scan.header.gridStep, glm::dvec3(0));
    EXPECT_EQ(scan.header.points, std::nullopt);
    ASSERT_EQ(scan.notes.size(), 1U);
    EXPECT_EQ(scan.notes[0], "cloud.js says 11 points, the octree's files hold 8; these were read");
    ASSERT_EQ(scan.points.size(), 8U);
    expectNode(scan, 0, 0, 8);
    EXPECT_EQ(scan.points.position[3].x, -100 + eptPoint(1, 0).x * 0.25);
}

TEST(LasNodes, ThatDoNotFitAreTold) {
    const std::string tile = "ept-data/1-0-0-0.laz";
    auto files = lasEpt();
    files.files[tile] = lasNode(2).bytes();
    EXPECT_EQ(toldOf(files, "ept.json"),
              "its file ept-data/1-0-0-0.laz holds 7 points; its hierarchy says 5");
    files.files[tile].resize(400);
    EXPECT_THAT(toldOf(files, "ept.json"), HasSubstr("its file ept-data/1-0-0-0.laz: "));
    files.files[tile] = LasFile{}.bytes();
    EXPECT_EQ(toldOf(files, "ept.json"),
              "its file ept-data/1-0-0-0.laz holds 0 points; its hierarchy says 5");
    files.write(tile, "no LAS");
    EXPECT_THAT(toldOf(files, "ept.json"), HasSubstr("its file ept-data/1-0-0-0.laz: "));
    auto colorless = lasNode(1);
    colorless.format = 1;
    files.files[tile] = colorless.bytes();
    EXPECT_EQ(toldOf(files, "ept.json"),
              "some of its files have colours and some have none (ept-data/1-0-0-0.laz)");
    auto richer = lasNode(1);
    richer.extraBytes = 3;
    files.files[tile] = richer.bytes();
    EXPECT_EQ(toldOf(files, "ept.json"), "");
    EXPECT_EQ(toldOf(files, "ept.json", true),
              "its files differ in what is to be kept of their points (ept-data/1-0-0-0.laz)");
    files.files.erase(tile);
    EXPECT_EQ(toldOf(files, "ept.json"), "its file ept-data/1-0-0-0.laz is missing");
}

}  // namespace scancast::test
