// Potree octrees: what was written here, after the published descriptions of the formats, is what is read, point for point;
// damage is told, and what hierarchy and files say differently, too.
#include <gmock/gmock.h>

#include <functional>

#include "importers/octree/potree/node_names.hpp"
#include "tests/unit/octree/ept_folder.hpp"
#include "tests/unit/octree/potree_folder.hpp"

namespace scancast::test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

namespace {

struct PotreeDamage {
    const char* name;
    std::function<void(MemoryFiles&)> act;
    const char* words;
};
std::string nameOfDamage(const ::testing::TestParamInfo<PotreeDamage>& one) {
    return one.param.name;
}

auto inMetadata(std::function<void(nlohmann::json&)> change) {
    return [change](MemoryFiles& files) { changeJson(files, "metadata.json", change); };
}
auto inCloud(std::function<void(nlohmann::json&)> change) {
    return [change](MemoryFiles& files) { changeJson(files, "cloud.js", change); };
}
/// Little-endian bytes of a number, put into a file.
template <class T>
auto patched(const char* file, std::size_t at, T value) {
    return [=](MemoryFiles& files) { std::memcpy(files.files[file].data() + at, &value, sizeof value); };
}
auto shortened(const char* file, std::size_t bytes) {
    return [=](MemoryFiles& files) { files.files[file].resize(bytes); };
}
auto without(const char* file) {
    return [=](MemoryFiles& files) { files.files.erase(file); };
}

const PotreeDamage damages2[] = {
    {"NoPoints", without("octree.bin"), "its file octree.bin is missing"},
    {"NoHierarchy", without("hierarchy.bin"), "its file hierarchy.bin is missing"},
    {"ShortPoints", shortened("octree.bin", 100), "of octree.bin, which has 100"},
    {"ShortHierarchy", shortened("hierarchy.bin", 100),
     "the chunk of the node r is said to have 110 bytes at byte 0; the file has 100"},
    {"Kind", patched("hierarchy.bin", 0, std::uint8_t(9)), "the node r is of kind 9"},
    {"Count", patched("hierarchy.bin", 2, std::uint32_t(12345)),
     "the node r has 41 bytes; its 12,345 points need"},
    {"Circle", patched("hierarchy.bin", 3 * 22 + 6, std::uint64_t(0)), "share the chunk there: a circle"},
    {"ProxyOfProxy", patched("hierarchy.bin", 0, std::uint8_t(2)), "starts with another reference: a circle"},
    {"FarAway", patched("hierarchy.bin", 6, ~std::uint64_t(0) - 3), "of octree.bin, which has"},
    {"ChunkFarAway", patched("hierarchy.bin", 3 * 22 + 6, ~std::uint64_t(0) - 3),
     "the chunk of the node r03"},
    {"Encoding", inMetadata([](auto& m) { m["encoding"] = "ZIP"; }), "the encoding \"ZIP\" is not known"},
    {"Version", inMetadata([](auto& m) { m["version"] = "3.0"; }), "metadata.json has version \"3.0\""},
    {"ScaleTwo", inMetadata([](auto& m) { m["scale"] = {1, 2}; }), "\"scale\" must be three numbers"},
    {"ScaleNegative", inMetadata([](auto& m) { m["scale"] = {1, -2, 1}; }), "the scale must be positive"},
    {"ScaleNaN", inMetadata([](auto& m) { m["scale"] = {1, nullptr, 1}; }),
     "\"scale\"[1] is undefined; it must be a number"},
    {"ScaleFar", inMetadata([](auto& m) { m["scale"] = {1, 1e300, 1}; }), "near enough to be numbers"},
    {"Size", inMetadata([](auto& m) { m["attributes"][1]["size"] = 1000000000; }),
     "the size of the attribute \"intensity\" is 1000000000"},
    {"NoPosition", inMetadata([](auto& m) { m["attributes"].erase(0); }), "have no position"},
    {"NoChunkSize", inMetadata([](auto& m) { m["hierarchy"] = nullptr; }),
     "\"hierarchy.firstChunkSize\" is undefined"},
    {"NoJson", [](MemoryFiles& f) { f.write("metadata.json", "{\"version\": "); },
     "metadata.json is not valid JSON"},
};

const PotreeDamage damages1[] = {
    {"NodeMissing", without("data/r/03/r031.bin"), "its file data/r/03/r031.bin is missing"},
    {"HierarchyMissing", without("data/r/03/r03.hrc"), "its file data/r/03/r03.hrc is missing"},
    {"TwoMissing",
     [](MemoryFiles& f) {
         f.files.erase("data/r/r.bin");
         f.files.erase("data/r/r7.bin");
     },
     "its file data/r/r.bin is missing and so are 1 more"},
    {"NodeShort", shortened("data/r/r7.bin", 4),
     "data/r/r7.bin has 4 bytes, no whole number of points of 22 bytes"},
    {"HierarchyShort", shortened("data/r/r.hrc", 10), "r.hrc ends at byte 10, before the node"},
    {"HierarchyOdd", shortened("data/r/r.hrc", 7), "no multiple of 5"},
    {"HierarchyLong", patched("data/r/r.hrc", 0, std::uint8_t(0)), "its 1 nodes need less"},
    {"FolderNumber", inCloud([](auto& c) { c["octreeDir"] = 7; }), "\"octreeDir\" must be a folder"},
    {"StepZero", inCloud([](auto& c) { c["hierarchyStepSize"] = 0; }), "\"hierarchyStepSize\" is 0"},
    {"NodeTwice", inCloud([](auto& c) { c["hierarchy"] = nlohmann::json::parse(R"([["r", 1], ["r", 1]])"); }),
     "the node r twice"},
    {"NodeIsAPath",
     inCloud([](auto& c) { c["hierarchy"] = nlohmann::json::parse(R"([["../../r", 1], ["r", 1]])"); }),
     "has no name like \"r042\""},
    {"Attribute", inCloud([](auto& c) { c["pointAttributes"] = {"POSITION_CARTESIAN", "TASTE"}; }),
     "attribute \"TASTE\" is not known"},
    {"ScaleText", inCloud([](auto& c) { c["scale"] = "big"; }), "\"scale\" is \"big\""},
    {"Version", inCloud([](auto& c) { c["version"] = "0.9"; }), "cloud.js has version \"0.9\""},
};

class Potree1Damage : public ::testing::TestWithParam<PotreeDamage> {};
class Potree2Damage : public ::testing::TestWithParam<PotreeDamage> {};

void expectTold(MemoryFiles files, const char* description, const PotreeDamage& damage) {
    damage.act(files);
    const auto scan = readOctree(files, description);
    ASSERT_FALSE(scan);
    EXPECT_THAT(scan.error().message, HasSubstr(damage.words));
}

std::size_t nodeOf(const std::string& name) {
    return static_cast<std::size_t>(std::find(potreeNames.begin(), potreeNames.end(), name) -
                                    potreeNames.begin());
}

bool isLeaf(const std::string& name) {
    return childMask(name) == 0;
}

}  // namespace

TEST_P(Potree1Damage, IsTold) {
    expectTold(potree1Folder(), "cloud.js", GetParam());
}
INSTANTIATE_TEST_SUITE_P(All, Potree1Damage, ::testing::ValuesIn(damages1), nameOfDamage);

TEST_P(Potree2Damage, IsTold) {
    expectTold(potree2Folder(), "metadata.json", GetParam());
}
INSTANTIATE_TEST_SUITE_P(All, Potree2Damage, ::testing::ValuesIn(damages2), nameOfDamage);

TEST(Potree2, EncodingsGiveWhatWasWritten) {
    for (const char* encoding : {"DEFAULT", "UNCOMPRESSED", "BROTLI"})
        for (const int mostColor : {255, 65535}) {
            const auto scan = readOctree(potree2Folder(encoding, mostColor), "metadata.json", true);
            ASSERT_TRUE(scan) << scan.error().message;
            EXPECT_EQ(scan->header.format, std::string("Potree 2.0, ") + encoding);
            EXPECT_EQ(scan->header.points, std::uint64_t(potreePointsInAll));
            EXPECT_EQ(scan->header.attributes, (Attributes{true, true, true, true}));
            EXPECT_EQ(scan->header.crsEpsg, 25832);
            EXPECT_EQ(scan->header.gridStep, glm::dvec3(0.001, 0.002, 0.25));
            EXPECT_EQ(scan->header.gridOrigin, glm::dvec3(1000, -2000, 0.5));
            EXPECT_THAT(scan->notes, IsEmpty());
            ASSERT_EQ(scan->header.columns.size(), 1U);
            EXPECT_EQ(scan->header.columns[0].name, "gps_time");
            ASSERT_EQ(scan->points.size(), std::size_t(potreePointsInAll));
            // Chunks of the hierarchy come after each other.
            std::size_t at = 0;
            for (const std::string name : {"r", "r0", "r7", "r75", "r03", "r031", "r0312"})
                for (int i = 0; i < potreePoints(nodeOf(name)); ++i, ++at) {
                    const auto p = potreePoint(nodeOf(name), i, mostColor);
                    EXPECT_EQ(
                        scan->points.position[at],
                        glm::dvec3(1000 + p.xyz[0] * 0.001, -2000 + p.xyz[1] * 0.002, 0.5 + p.xyz[2] * 0.25));
                    for (std::size_t k = 0; k < 3; ++k)
                        EXPECT_EQ(scan->points.color[at][k], mostColor > 255 ? p.rgb[k] >> 8 : p.rgb[k]);
                    EXPECT_EQ(scan->points.intensity[at], p.intensity);
                    EXPECT_EQ(scan->points.classification[at], p.classification);
                    EXPECT_NEAR(scan->points.normal[at].y, p.normal[1], 1e-6);
                    double time = 0;
                    std::memcpy(&time, scan->points.rows.data() + 8 * at, 8);
                    EXPECT_EQ(time, p.time);
                }
        }
}

TEST(Potree2, DamagedBrotliIsTold) {
    const auto told = [](const std::function<void(Bytes&)>& change) {
        auto files = potree2Folder("BROTLI");
        change(files.files["octree.bin"]);
        const auto scan = readOctree(files, "metadata.json");
        return scan ? std::string() : scan.error().message;
    };
    EXPECT_THAT(told([](Bytes& b) { std::fill(b.begin(), b.begin() + 16, std::byte(0xff)); }),
                HasSubstr("the node r"));
    // A bomb in the place of the first node: no more comes out of it than its point needs.
    const auto bomb = brotliOf(Bytes(1 << 20));
    ASSERT_LT(bomb.size(), 40U);
    EXPECT_THAT(told([&](Bytes& b) { std::copy(bomb.begin(), bomb.end(), b.begin()); }),
                HasSubstr("the node r has more bytes than its points need"));
}

TEST(Potree2, PointsThatItDoesNotHoldAreTold) {
    auto files = potree2Folder();
    changeJson(files, "metadata.json", [](auto& m) { m["points"] = 29; });
    const auto scan = readOctree(files, "metadata.json").value();
    EXPECT_EQ(scan.header.points, std::nullopt);
    EXPECT_THAT(scan.notes,
                ElementsAre("metadata.json says 29 points, the octree's files hold 28; these were read"));
}

TEST(Potree1, BinGivesWhatWasWritten) {
    // The cube of "r75" is the half, then the quarter, that its digits say: x is bit 2, y bit 1, z bit 0.
    const std::map<std::string, glm::dvec3> corners{
        {"r", {10, 20, 30}},    {"r0", {10, 20, 30}},      {"r7", {14, 24, 34}}, {"r03", {10, 22, 32}},
        {"r031", {10, 22, 33}}, {"r0312", {10, 22.5, 33}}, {"r75", {16, 24, 36}}};
    for (const char* normal : {"NORMAL_OCT16", "NORMAL_SPHEREMAPPED", "NORMAL"}) {
        const auto scan = readOctree(potree1Folder({.normal = normal}), "cloud.js", true);
        ASSERT_TRUE(scan) << scan.error().message;
        EXPECT_EQ(scan->header.format, "Potree 1.7, BIN");
        EXPECT_EQ(scan->header.points, std::nullopt);  // a sum of nodes is nothing that it declares
        EXPECT_EQ(scan->header.columns.size(), 1U);
        EXPECT_EQ(scan->header.columns[0].name, "return_number");
        EXPECT_THAT(scan->notes, IsEmpty());
        ASSERT_EQ(scan->points.size(), std::size_t(potreePointsInAll));
        std::size_t at = 0;
        for (const std::string name : {"r", "r0", "r7", "r03", "r75", "r031", "r0312"})
            for (int i = 0; i < potreePoints(nodeOf(name)); ++i, ++at) {
                const auto corner = corners.at(name);
                EXPECT_EQ(scan->points.position[at],
                          glm::dvec3(corner.x + (100 * i - 20) * 0.01, corner.y + i * 0.01,
                                     corner.z + -3 * i * 0.01));
                EXPECT_EQ(scan->points.color[at][0], nodeOf(name));
                EXPECT_EQ(scan->points.color[at][2], 200);
                EXPECT_EQ(scan->points.intensity[at], 60000 + i);
                EXPECT_EQ(scan->points.classification[at], i + 1);
                // The finest step of two bytes on a sphere.
                const glm::dvec3 direction = name == "r" ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
                for (int k = 0; k < 3; ++k)
                    EXPECT_NEAR(scan->points.normal[at][k], direction[k], 0.02) << normal;
            }
    }
}

TEST(Potree1, PositionsOfOldVersionsAreFloats) {
    MemoryFiles files;
    files.write("cloud.js",
                R"({"version": "1.3", "octreeDir": "data", "pointAttributes": ["POSITION_CARTESIAN"],
        "boundingBox": {"lx": 1, "ly": 2, "lz": 3, "ux": 9, "uy": 10, "uz": 11}, "hierarchy": [["r", 2], ["r4", 1]]})");
    files.files["data/r.bin"] =
        BytesWriter().add(0.5F).add(1.5F).add(2.5F).add(1.0F).add(std::nanf("")).add(1.0F).bytes;
    files.files["data/r4.bin"] = BytesWriter().add(0.25F).add(0.0F).add(-1.0F).bytes;
    const auto scan = readOctree(files, "cloud.js").value();
    EXPECT_EQ(scan.dropped, 1U);
    ASSERT_EQ(scan.points.size(), 2U);
    EXPECT_EQ(scan.points.position[0], glm::dvec3(1.5, 3.5, 5.5));
    EXPECT_EQ(scan.points.position[1], glm::dvec3(5.25, 2, 2));
}

TEST(Potree1, WhatItsConverterLeavesBehindIsReadWhole) {
    Potree1 zeros, flushed, later;
    zeros.counted = [](const std::string& name, std::uint32_t n) { return isLeaf(name) ? 0 : n; };
    flushed.counted = [](const std::string&, std::uint32_t n) { return n / 2; };
    later.masked = [](const std::string& root, const std::string& name) {
        return name == root || name.size() - root.size() < 2;
    };
    for (const auto& how : {zeros, flushed, later}) {
        const auto scan = readOctree(potree1Folder(how), "cloud.js");
        ASSERT_TRUE(scan) << scan.error().message;
        EXPECT_EQ(scan->points.size(), std::size_t(potreePointsInAll));
        EXPECT_THAT(scan->notes, IsEmpty());
    }
}

TEST(Potree1, WhatHierarchyAndFilesSayDifferentlyIsTold) {
    Potree1 more;
    more.counted = [](const std::string& name, std::uint32_t n) { return name == "r03" ? 9 : n; };
    EXPECT_THAT(
        readOctree(potree1Folder(more), "cloud.js").value().notes,
        ElementsAre(
            "1 of its files hold fewer points than its hierarchy says (data/r/03/r03.bin 4 of 9); what they "
            "hold was read"));
    auto files = potree1Folder();
    files.files["data/r/r5.bin"] = files.files["data/r/r7.bin"];
    const auto scan = readOctree(files, "cloud.js").value();
    EXPECT_EQ(scan.points.size(), std::size_t(potreePointsInAll + 3));
    EXPECT_THAT(
        scan.notes,
        ElementsAre("1 of its files (3 points; one is data/r/r5.bin) are not in its hierarchy; they were "
                    "read, too"));
    auto said = potree1Folder();
    changeJson(said, "cloud.js", [](auto& c) { c["points"] = 1000000000; });
    EXPECT_THAT(
        readOctree(said, "cloud.js").value().notes,
        ElementsAre("cloud.js says 1,000,000,000 points, the octree's files hold 28; these were read"));
}

TEST(Potree1, ANodeOfNoPointsMayLackItsFile) {
    const auto pointsOf = [](Potree1 how) -> Expected<std::size_t> {
        const auto counted = how.counted;
        how.counted = [=](const std::string& name, std::uint32_t n) {
            return counted(name, name == "r75" ? 0 : n);
        };
        auto files = potree1Folder(how);
        files.files.erase("data/r/75/r75.bin");
        const auto scan = readOctree(files, "cloud.js");
        if (!scan) return passOn(scan);
        return scan->points.size();
    };
    EXPECT_EQ(pointsOf({}).value(), std::size_t(potreePointsInAll - 7));
    // Unless its hierarchy counts 0 where points are.
    Potree1 lying;
    lying.counted = [](const std::string&, std::uint32_t) { return 0; };
    const auto refused = pointsOf(lying);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("data/r/75/r75.bin is missing"));
}

}  // namespace scancast::test
