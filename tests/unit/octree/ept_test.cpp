// EPT folders: what was written here, after the published description of the format, is what is read, point for point;
// damage and lies are told, and name the file.
#include <gmock/gmock.h>

#include <functional>

#include "importers/octree/ept/ept_hierarchy.hpp"
#include "tests/support/sized.hpp"
#include "tests/unit/octree/ept_folder.hpp"

namespace scancast::test {

using import_octree::parseVoxelKey;
using import_octree::VoxelKey;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

void expectEptPoints(const ReadScan& scan, int mostColor) {
    ASSERT_EQ(scan.points.size(), std::size_t(eptPointsInAll));
    const int shift = mostColor > 255 ? 8 : 0;
    std::size_t at = 0;
    for (int node = 0; node < 5; ++node)
        for (int i = 0; i < eptPoints(node); ++i, ++at) {
            const auto p = eptPoint(node, i, mostColor);
            EXPECT_EQ(scan.points.position[at],
                      glm::dvec3(1000 + p.x * 0.01, -2000 + p.y * 0.02, p.z * 0.25));
            EXPECT_EQ(scan.points.intensity[at], p.intensity);
            EXPECT_EQ(scan.points.classification[at], p.classification);
            for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(scan.points.color[at][k], p.rgb[k] >> shift);
        }
}

/// A sound folder, something done to it, and the words that there are for that.
struct Damage {
    const char* name;
    std::function<void(MemoryFiles&)> act;
    const char* words;
};

auto inEpt(std::function<void(nlohmann::json&)> change) {
    return [change](MemoryFiles& files) { changeJson(files, "ept.json", change); };
}
auto page(const char* text) {
    return [text](MemoryFiles& files) { files.write("ept-hierarchy/0-0-0-0.json", text); };
}
auto inSchema(const char* key, nlohmann::json value) {
    return inEpt([=](nlohmann::json& ept) { ept["schema"][0][key] = value; });
}

const Damage damages[] = {
    {"TileMissing", [](MemoryFiles& f) { f.files.erase("ept-data/2-3-1-2.bin"); },
     "its file ept-data/2-3-1-2.bin is missing"},
    {"TileShort", [](MemoryFiles& f) { f.files["ept-data/1-0-0-0.bin"].pop_back(); },
     "its file ept-data/1-0-0-0.bin has 144 bytes; its 5 points of 29 bytes need 145"},
    {"TileLong", [](MemoryFiles& f) { f.files["ept-data/1-0-0-0.bin"].push_back({}); },
     "has 146 bytes; its 5 points of 29"},
    {"PageMissing", [](MemoryFiles& f) { f.files.erase("ept-hierarchy/1-1-0-1.json"); },
     "its file ept-hierarchy/1-1-0-1.json is missing"},
    {"PageNoJson", page("{\"0-0-0-0\": 3"), "ept-hierarchy/0-0-0-0.json: it is not valid JSON at byte"},
    {"PageNoObject", page("[1, 2]"), "it is no object"},
    {"PageNumber", page("7"), "it is no object"},
    {"PageNested", page(R"({"0-0-0-0": {"0-0-0-0": 1}})"), "an object within an object"},
    {"PageText", page(R"({"0-0-0-0": "many"})"), "the node 0-0-0-0 has no number"},
    {"PageFraction", page(R"({"0-0-0-0": 1.5})"), "the node 0-0-0-0 has 1.5 points"},
    {"PageNegative", page(R"({"0-0-0-0": -2})"), "the node 0-0-0-0 has -2 points"},
    {"PageHuge", page(R"({"0-0-0-0": 18446744073709551615})"), "more than any real one"},
    {"PageCircle", page(R"({"0-0-0-0": -1})"), "refers to this page itself: a circle"},
    {"PageEmpty", [](MemoryFiles& f) { f.write("ept-hierarchy/1-1-0-1.json", "{}"); },
     "ept-hierarchy/1-1-0-1.json has no number for the node 1-1-0-1"},
    {"PageOfAnother",
     [](MemoryFiles& f) { f.write("ept-hierarchy/1-1-0-1.json", R"({"1-1-0-1": 7, "2-0-0-0": 9})"); },
     "the node 2-0-0-0 does not lie in 1-1-0-1"},
    {"PageTwice", page(R"({"0-0-0-0": 3, "1-1-0-1": -1, "1-1-0-1": -1})"),
     "the page of 1-1-0-1 is referred to twice"},
    {"NodeTwice", page(R"({"0-0-0-0": 3, "0-0-0-0": 3})"), "its hierarchy has the node 0-0-0-0 twice"},
    {"KeyIsAPath", page(R"({"0-0-0-0": 3, "../../1-0-0-0": -1})"), "is no node such as"},
    {"KeyOutOfRange", page(R"({"0-0-0-0": 3, "1-2-0-0": 1})"), "is no node such as"},
    {"KeyDeep", page(R"({"0-0-0-0": 3, "32-0-0-0": 1})"), "is no node such as"},
    {"NoEptJson", [](MemoryFiles& f) { f.write("ept.json", "{\"version\": "); },
     "ept.json is not valid JSON"},
    {"Version", inEpt([](auto& e) { e["version"] = "2.0"; }), "ept.json has version \"2.0\""},
    {"DataType", inEpt([](auto& e) { e["dataType"] = "gzip"; }), "tiles of \"gzip\""},
    {"Hierarchy", inEpt([](auto& e) { e["hierarchyType"] = "xml"; }), "a hierarchy of \"xml\""},
    {"NoSchema", inEpt([](auto& e) { e.erase("schema"); }), "its schema is missing"},
    {"NoZ", inEpt([](auto& e) { e["schema"].erase(2); }), "ept.json: its points have no position"},
    {"TwoX", inSchema("name", "Y"), "stands twice in its schema"},
    {"SizeThree", inSchema("size", 3), "is \"signed\" of 3 bytes"},
    {"SizeHuge", inSchema("size", 1u << 30), "its size is 1073741824"},
    {"Type", inSchema("type", "complex"), "is \"complex\" of 4 bytes"},
    {"ScaleZero", inSchema("scale", 0), "its scale is 0; it must be a positive number"},
    {"ScaleText", inSchema("scale", "NaN"), "its scale is \"NaN\"; it must be a number"},
    {"OffsetText", inSchema("offset", "inf"), "its offset is \"inf\""},
    {"Points", inEpt([](auto& e) { e["points"] = -5; }), "the number of points is -5"},
};

class EptDamage : public ::testing::TestWithParam<Damage> {};

Bytes cut(Bytes bytes, std::size_t by) {
    bytes.resize(bytes.size() - by);
    return bytes;
}

}  // namespace

TEST_P(EptDamage, IsTold) {
    auto files = eptFolder();
    GetParam().act(files);
    const auto scan = readOctree(files, "ept.json");
    ASSERT_FALSE(scan);
    EXPECT_THAT(scan.error().message, HasSubstr(GetParam().words));
}
INSTANTIATE_TEST_SUITE_P(All, EptDamage, ::testing::ValuesIn(damages),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(Ept, BinaryAndZstandardGiveWhatWasWritten) {
    for (const char* type : {"binary", "zstandard"})
        for (const int mostColor : {255, 65535}) {
            const auto scan = readOctree(eptFolder(type, mostColor), "ept.json");
            ASSERT_TRUE(scan) << scan.error().message;
            EXPECT_EQ(scan->header.format, std::string("EPT 1.0.0, ") + type);
            EXPECT_EQ(scan->header.points, std::uint64_t(eptPointsInAll));
            EXPECT_EQ(scan->header.attributes, (Attributes{true, true, true, false}));
            EXPECT_EQ(scan->header.crsEpsg, 26912);
            EXPECT_EQ(scan->header.crsWkt, R"(PROJCS["here",UNIT["metre",1]])");
            EXPECT_EQ(scan->header.gridStep, glm::dvec3(0.01, 0.02, 0.25));
            EXPECT_EQ(scan->header.gridOrigin, glm::dvec3(1000, -2000, 0));
            EXPECT_EQ((*scan->header.bounds)[1], glm::dvec3(4, 5, 6));
            EXPECT_THAT(scan->notes, ElementsAre());
            expectEptPoints(*scan, mostColor);
        }
}

TEST(Ept, FurtherDimensionsAreKeptOnDemand) {
    const auto scan = readOctree(eptFolder(), "ept.json", true).value();
    ASSERT_EQ(scan.header.columns.size(), 1U);
    EXPECT_EQ(scan.header.columns[0].name, "gps_time");
    ASSERT_EQ(scan.points.rows.size(), 8U * eptPointsInAll);
    double last = 0;
    std::memcpy(&last, scan.points.rows.data() + 8 * (eptPointsInAll - 1), 8);
    EXPECT_EQ(last, eptPoint(4, 10).time);
}

TEST(Ept, DimensionsOfAnyTypeInAnyOrder) {
    MemoryFiles files;
    files.write("ept.json", R"({"version": "1.1.0", "dataType": "binary", "schema": [
        {"name": "Label", "type": "signed", "size": 8}, {"name": "Z", "type": "float", "size": 8},
        {"name": "NormalY", "type": "float", "size": 4}, {"name": "Classification", "type": "unsigned", "size": 2},
        {"name": "X", "type": "unsigned", "size": 2, "scale": 0.5}, {"name": "NormalX", "type": "float", "size": 8},
        {"name": "Intensity", "type": "signed", "size": 4}, {"name": "Y", "type": "float", "size": 4},
        {"name": "NormalZ", "type": "signed", "size": 1}, {"name": "Blue", "type": "unsigned", "size": 1}]})");
    files.write("ept-hierarchy/0-0-0-0.json", R"({"0-0-0-0": 3})");
    BytesWriter tile;
    const auto point = [&](double z, std::uint16_t label, std::int32_t intensity) {
        tile.add(std::int64_t(-5)).add(z).add(3.0F).add(label).add(std::uint16_t(9)).add(0.0).add(intensity);
        tile.add(1.25F).add(std::int8_t(4)).add(std::uint8_t(77));
    };
    point(2.5, 6, 40000);
    point(std::nan(""), 6, 1);
    point(-1, 300, 70000);
    files.files["ept-data/0-0-0-0.bin"] = tile.bytes;
    const auto scan = readOctree(files, "ept.json", true).value();
    EXPECT_EQ(scan.header.points, std::nullopt);
    EXPECT_EQ(scan.header.gridStep, glm::dvec3(0));
    EXPECT_EQ(scan.dropped, 1U);
    ASSERT_EQ(scan.points.size(), 2U);
    EXPECT_EQ(scan.points.position[0], glm::dvec3(4.5, 1.25, 2.5));
    EXPECT_THAT(scan.points.intensity, ElementsAre(40000, 65535));
    EXPECT_THAT(scan.points.classification, ElementsAre(6, 0));
    EXPECT_NEAR(scan.points.normal[0].y, 0.6, 1e-6);
    EXPECT_NEAR(scan.points.normal[0].z, 0.8, 1e-6);
    // What a sample has no room for is told, and whole in its column; a colour that lacks two parts is a column, too.
    EXPECT_THAT(scan.notes, ElementsAre(HasSubstr("2 of its numbers are outside")));
    std::vector<std::string> names;
    for (const auto& column : scan.header.columns) names.push_back(column.name);
    EXPECT_THAT(names, ElementsAre("label", "classification", "intensity", "blue"));
}

TEST(Ept, NumbersOfPointsThatDifferAreTold) {
    auto files = eptFolder();
    changeJson(files, "ept.json", [](auto& ept) { ept["points"] = 36; });
    const auto scan = readOctree(files, "ept.json").value();
    EXPECT_EQ(scan.header.points, std::nullopt);
    EXPECT_THAT(scan.notes,
                ElementsAre("ept.json says 36 points, the octree's files hold 35; these were read"));
    expectEptPoints(scan, 65535);
}

TEST(Ept, OldVersionsAndRootsWithoutPointsAreRead) {
    auto files = eptFolder();
    changeJson(files, "ept.json", [](auto& ept) { ept["version"] = "0.0.0"; });
    files.write("ept-hierarchy/0-0-0-0.json", R"({"1-0-0-0": 5})");
    const auto scan = readOctree(files, "ept.json").value();
    EXPECT_EQ(scan.header.format, "EPT 0.0.0, binary");
    EXPECT_EQ(scan.points.size(), 5U);
}

TEST(Ept, WithoutPointsIsEmpty) {
    auto files = eptFolder();
    files.write("ept-hierarchy/0-0-0-0.json", R"({"0-0-0-0": 0})");
    const auto scan = readOctree(files, "ept.json");
    ASSERT_FALSE(scan);
    EXPECT_EQ(scan.error().code, ErrorCode::Empty);
}

TEST(Ept, ZstandardTilesHoldWhatTheirPointsNeedAndNothingElse) {
    const std::string tile = "ept-data/1-0-0-0.zst";
    const auto told = [&](const Bytes& bytes) {
        auto files = eptFolder("zstandard");
        files.files[tile] = bytes;
        const auto scan = readOctree(files, "ept.json");
        return scan ? std::string() : scan.error().message;
    };
    const auto records = eptRecords(1);
    const auto whole = zstdOf(records);
    EXPECT_THAT(told(cut(whole, 3)), HasSubstr("1-0-0-0.zst ends early"));
    EXPECT_THAT(told({}), HasSubstr("1-0-0-0.zst ends early, after 0 bytes; its 5 points need 145"));
    EXPECT_THAT(told(records), HasSubstr("1-0-0-0.zst cannot be decompressed"));
    EXPECT_THAT(told(zstdOf(cut(records, 1))), HasSubstr("holds only 144 bytes; its 5 points need 145"));
    // A bomb: what a few bytes hold is not asked for beyond what its points need.
    EXPECT_THAT(told(zstdOf(Bytes(std::size_t(test::sized(64, 8)) << 20))),
                HasSubstr("holds more bytes than its 5 points need"));
    // Frames may follow each other.
    BytesWriter two;
    two.add(zstdOf(Bytes(records.begin(), records.begin() + 50)))
        .add(zstdOf(Bytes(records.begin() + 50, records.end())));
    EXPECT_EQ(told(two.bytes), "");
}

TEST(Ept, KeysOfVoxels) {
    EXPECT_EQ(parseVoxelKey("0-0-0-0"), VoxelKey());
    EXPECT_EQ(parseVoxelKey("3-7-2-5"), (VoxelKey{3, 7, 2, 5}));
    EXPECT_EQ(parseVoxelKey("31-2147483647-0-1"), (VoxelKey{31, 2147483647, 0, 1}));
    for (const char* text :
         {"", "0", "0-0-0", "0-0-0-0-0", "0-0-0-0 ", " 0-0-0-0", "1-2-0-0", "01-0-0-0", "1-00-0-0",
          "1--1-0-0", "1-+1-0-0", "32-0-0-0", "1-0-0-a", "99999999999-0-0-0", "0-0-0-", "-0-0-0"})
        EXPECT_FALSE(parseVoxelKey(text)) << text;
}

}  // namespace scancast::test
