// EPT shown as it is: what a COPC file of the same points in the same voxels shows, node by node, bit for bit, whatever its tiles are; what is
// hostile or damaged is an error that says what, and a tile that is missing costs what is drawn of it.
#include <gmock/gmock.h>

#include "renderer/cloud/native/ept/ept_tree.hpp"
#include "tests/support/sized.hpp"
#include "tests/unit/native/ept_bytes.hpp"

namespace scancast::test {

using ::testing::Contains;
using ::testing::HasSubstr;

namespace {

using Kind = EptMaker::Kind;
using EptFile = Expected<std::shared_ptr<const CloudFile>>;

NativeCloudOptions optionsOf(bool surfels) {
    return {.name = "wavy/ept.json",
            .title = "wavy",
            .identity = {},
            .surfels = surfels,
            .upperPoints = 2000,
            .memory = std::make_shared<GatheredMemory>(64 << 20)};
}

EptFile openFolder(MemoryFolder folder, bool surfels = false, std::uint64_t upperPoints = 2000) {
    NativeCloudOptions options = optionsOf(surfels);
    options.upperPoints = upperPoints;
    return openEpt(std::make_shared<MemoryFolder>(std::move(folder)), std::make_shared<TileDecoders>(),
                   std::move(options));
}

EptFile openSame(const CopcBytes& copc, bool surfels) {
    return openCopc(readerOf(copc.file), std::make_shared<RawChunks>(), optionsOf(surfels));
}

template <class Change>
void changeJson(MemoryFolder& folder, const std::string& name, Change change) {
    const Bytes& bytes = folder.files.at(name);
    auto json = nlohmann::json::parse(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    change(json);
    folder.write(name, json.dump());
}

class EptCloud : public ::testing::TestWithParam<Kind> {
  protected:
    static void SetUpTestSuite() {
        copc_ = new CopcBytes(CopcMaker::make(wavyPoints(sized(40000, 6000)), 500));
    }
    static void TearDownTestSuite() { delete copc_; }
    static const CopcBytes& copc() { return *copc_; }

  private:
    static inline const CopcBytes* copc_ = nullptr;
};

std::string nameOfKind(const ::testing::TestParamInfo<Kind>& one) {
    return one.param == Kind::Floats ? "Floats" : EptMaker::dataType(one.param);
}

}  // namespace

TEST_P(EptCloud, ShowsWhatCopcOfTheSameVoxelsDoes) {
    const auto ept = openFolder(EptMaker::make(copc(), GetParam()), true), same = openSame(copc(), true);
    ASSERT_TRUE(ept) << ept.error().message;
    ASSERT_TRUE(same) << same.error().message;
    const bool hasGrid = GetParam() != Kind::Floats;
    EXPECT_EQ((*ept)->facts().format, std::string("EPT 1.1.0, ") + EptMaker::dataType(GetParam()));
    EXPECT_EQ((*ept)->facts().points, copc().points.size());
    EXPECT_EQ((*ept)->facts().attributes, (*same)->facts().attributes);
    EXPECT_EQ((*ept)->facts().grid.has_value(), hasGrid);
    EXPECT_TRUE((*ept)->isNative());
    ASSERT_EQ((*ept)->nodes().size(), (*same)->nodes().size());
    for (std::uint32_t i = 0; i < (*ept)->nodes().size(); ++i) {
        const auto a = (*ept)->samples(i), b = (*same)->samples(i);
        ASSERT_TRUE(a) << a.error().message;
        ASSERT_TRUE(b) << b.error().message;
        ASSERT_EQ(a->size(), b->size());
        if (hasGrid) {
            EXPECT_EQ(std::memcmp(a->data(), b->data(), a->size() * sizeof(Sample)), 0) << i;
            if (i % 16 != 0 || !(*ept)->nodes()[i].node.isLeaf() || a->empty()) continue;
            const auto point = (*ept)->point(i, *a, a->size() / 2),
                       its = (*same)->point(i, *b, a->size() / 2);
            ASSERT_TRUE(point) << point.error().message;
            ASSERT_TRUE(its) << its.error().message;
            EXPECT_EQ(point->position, its->position);
            EXPECT_EQ(point->precision, its->precision);
            if (GetParam() != Kind::Laszip) continue;
            EXPECT_EQ(point->columns, its->columns);
            EXPECT_EQ(point->row, its->row);
            continue;
        }
        // Their own grid is finer: brought to the other one they are the same.
        const auto onGrid = [&](const CloudFile& file, std::span<const Sample> samples) {
            std::vector<PointValue> values;
            for (const Sample& s : samples) {
                const ScanGrid& grid = *(*same)->facts().grid;
                const glm::dvec3 at =
                    (position(file.nodes()[i].node, s) + file.facts().origin - grid.origin) / grid.step;
                values.emplace_back(std::llround(at.x), std::llround(at.y), std::llround(at.z), s.intensity,
                                    s.r, s.g, s.b, s.classification);
            }
            std::ranges::sort(values);
            return values;
        };
        EXPECT_EQ(onGrid(**ept, *a), onGrid(**same, *b)) << i;
    }
}

TEST_P(EptCloud, AMissingTileCostsWhatIsDrawnOfIt) {
    auto folder = EptMaker::make(copc(), GetParam());
    const VoxelKey lost = copc().voxels.rbegin()->first;  // a leaf of the deepest level
    ASSERT_EQ(folder.files.erase(EptMaker::tileName(lost, GetParam())), 1U);
    const auto file = openFolder(std::move(folder));
    ASSERT_TRUE(file) << file.error().message;
    std::size_t damaged = 0;
    for (std::uint32_t i = 0; i < (*file)->nodes().size(); ++i)
        if (const auto samples = (*file)->samples(i); !samples) {
            ++damaged;
            EXPECT_EQ(samples.error().code, ErrorCode::NotFound);
            EXPECT_EQ(samples.error().message, "wavy/ept.json, voxel " + text(lost) + ": its file " +
                                                   EptMaker::tileName(lost, GetParam()) + " is missing");
        }
    EXPECT_EQ(damaged, 1U);
}

TEST_P(EptCloud, ATileOfTheUpperLevelsIsToldOfAndTheRootIsNeeded) {
    auto folder = EptMaker::make(copc(), GetParam());
    const VoxelKey upper = std::next(copc().voxels.begin())->first;
    ASSERT_EQ(upper.level, 1);
    folder.files.at(EptMaker::tileName(upper, GetParam())).resize(100);
    // More than the root has.
    auto file = openFolder(folder, false, copc().points.size() / 4 + 1);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_THAT((*file)->facts().notes,
                Contains(HasSubstr("1 voxel of its upper levels cannot be read, and are left out")));
    folder.files.erase(EptMaker::tileName({}, GetParam()));
    file = openFolder(folder);
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().code, ErrorCode::NotFound);
    EXPECT_THAT(file.error().message, HasSubstr("wavy/ept.json: its file ept-data/0-0-0-0."));
}

TEST_P(EptCloud, ATileWithOthersThanItsHierarchySaysIsDamaged) {
    auto folder = EptMaker::make(copc(), GetParam());
    const VoxelKey leaf = copc().voxels.rbegin()->first;
    VoxelKey root = leaf;
    while (root.level > 2) root = root.parent();
    for (const int more : {1, -1}) {
        auto changed = folder;
        changeJson(changed, "ept-hierarchy/" + text(root) + ".json",
                   [&](nlohmann::json& page) { page[text(leaf)] = page[text(leaf)].get<int>() + more; });
        changed.isFar = true;
        const auto files = std::make_shared<MemoryFolder>(std::move(changed));
        const auto file = openEpt(files, std::make_shared<TileDecoders>(), optionsOf(false));
        ASSERT_TRUE(file) << file.error().message;
        EXPECT_THAT((*file)->facts().notes, Contains(HasSubstr("ept.json promises")));
        std::size_t damaged = 0;
        for (std::uint32_t i = 0; i < (*file)->nodes().size(); ++i)
            if (const auto samples = (*file)->samples(i); !samples) {
                ++damaged;
                EXPECT_THAT(samples.error().message,
                            HasSubstr("voxel " + text(leaf) + ": its file ept-data/"));
            }
        EXPECT_EQ(damaged, 1U);
        // Over a network, what is damaged may be sound the second time.
        EXPECT_EQ(files->asked.count(EptMaker::tileName(leaf, GetParam())), 2U);
    }
}

/// Pages are cut where they have named nodes and other pages already.
TEST_P(EptCloud, WhatIsDamagedAtHandIsReadAgainWhenItIsOpened) {
    auto folder = EptMaker::make(copc(), GetParam());
    const auto sound = openFolder(folder);
    ASSERT_TRUE(sound) << sound.error().message;
    folder.isFar = true;
    for (const auto& [name, bytes] : folder.files)
        if (name.starts_with("ept-hierarchy/") || name == EptMaker::tileName({}, GetParam()))
            folder.atHand[name].assign(bytes.begin(), bytes.begin() + std::ptrdiff_t(bytes.size() - 1));
    if (GetParam() == Kind::Laszip) folder.atHand.at(EptMaker::tileName({}, GetParam())).resize(100);
    const auto file = openFolder(std::move(folder));
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ((*file)->facts().revision, (*sound)->facts().revision);
    EXPECT_EQ((*file)->facts().notes, (*sound)->facts().notes);
    EXPECT_EQ((*file)->nodes().size(), (*sound)->nodes().size());
}

INSTANTIATE_TEST_SUITE_P(All, EptCloud, ::testing::ValuesIn(EptMaker::kinds), nameOfKind);

/// They can be unpacked, and are no places.
TEST(EptTiles, WithPointsNowhereAreToldOfAndLeftOut) {
    const CopcBytes copc = CopcMaker::make(wavyPoints(3000), 300);
    auto folder = EptMaker::make(copc, Kind::Floats);
    const auto breakTile = [&](const VoxelKey& key, double x) {
        storeLe(folder.files.at(EptMaker::tileName(key, Kind::Floats)).data(), x);
    };
    breakTile(std::next(copc.voxels.begin())->first, std::nan(""));
    const auto file = openFolder(folder, false, copc.points.size() / 4 + 1);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_THAT((*file)->facts().notes,
                Contains(HasSubstr("1 voxel of its upper levels cannot be read, and are left out")));
    breakTile({}, 1e300);
    const auto none = openFolder(folder);
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, ErrorCode::Malformed);
}

/// Each page and each tile is read once, and nothing else is.
TEST(EptPages, AreReadOnceAndNamedByKeysAlone) {
    const CopcBytes copc = CopcMaker::make(wavyPoints(3000), 300);
    const auto files = std::make_shared<MemoryFolder>(EptMaker::make(copc, Kind::Binary));
    const auto file = openEpt(files, std::make_shared<TileDecoders>(), optionsOf(false));
    ASSERT_TRUE(file) << file.error().message;
    for (std::uint32_t i = 0; i < (*file)->nodes().size(); ++i) ASSERT_TRUE((*file)->samples(i));
    for (const auto& [name, bytes] : files->files) EXPECT_EQ(files->asked.count(name), 1U) << name;
    EXPECT_EQ(files->asked.size(), files->files.size());
}

namespace {

/// One thing changed in a set that is sound otherwise.
struct HostileSet {
    const char* name;
    const char* file;
    std::function<void(nlohmann::json&)> change;
    ErrorCode code;
    const char* says;
};

void PrintTo(const HostileSet& hostile, std::ostream* out) {
    *out << hostile.name;
}

class HostileEpt : public ::testing::TestWithParam<HostileSet> {};

constexpr const char* rootPage = "ept-hierarchy/0-0-0-0.json";

HostileSet described(const char* name, const char* key, nlohmann::json value, ErrorCode code,
                     const char* says) {
    return {name, "ept.json", [=](nlohmann::json& json) { json[key] = value; }, code, says};
}
HostileSet node(const char* name, const char* key, nlohmann::json value, ErrorCode code, const char* says) {
    return {name, rootPage, [=](nlohmann::json& json) { json[key] = value; }, code, says};
}

}  // namespace

TEST_P(HostileEpt, IsAnErrorThatSaysWhat) {
    for (const Kind kind : {Kind::Laszip, Kind::Binary}) {
        auto folder = EptMaker::make(CopcMaker::make(wavyPoints(1000), 300), kind);
        changeJson(folder, GetParam().file, GetParam().change);
        const auto file = openFolder(std::move(folder));
        ASSERT_FALSE(file);
        EXPECT_EQ(name(file.error().code), name(GetParam().code)) << file.error().message;
        EXPECT_THAT(file.error().message, HasSubstr("wavy/ept.json: "));
        EXPECT_THAT(file.error().message, HasSubstr(GetParam().says));
    }
}

INSTANTIATE_TEST_SUITE_P(All, HostileEpt,
                         ::
                             testing::
                                 Values(node("a page of itself", "0-0-0-0", -1, ErrorCode::Malformed,
                                             "a circle"),
                                        node("a page that is not there", "1-0-0-0", -1, ErrorCode::NotFound,
                                             "ept-hierarchy/1-0-0-0.json"),
                                        node("2^40 points", "1-0-0-0", 1ULL << 40, ErrorCode::ResourceLimit,
                                             "ingest it"),
                                        node("2^63 points", "1-0-0-0", 1ULL << 63, ErrorCode::Malformed,
                                             "more than any real one"),
                                        node("negative points", "1-0-0-0", -2, ErrorCode::Malformed,
                                             rootPage),
                                        node("half a point", "1-0-0-0", 0.5, ErrorCode::Malformed, rootPage),
                                        node("a list", "1-0-0-0", {1, 2}, ErrorCode::Malformed, rootPage),
                                        node("outside", "1-2-0-0", 5, ErrorCode::Malformed, "1-2-0-0"),
                                        node("too deep", "31-0-0-0", 5, ErrorCode::Malformed, "too deep"),
                                        node("deeper than any", "32-0-0-0", 5, ErrorCode::Malformed,
                                             "32-0-0-0"),
                                        node("no parent", "7-5-5-5", 5, ErrorCode::Malformed, "no parent"),
                                        node("a path", "../../../etc/passwd", 5, ErrorCode::Malformed,
                                             "is no node"),
                                        node("a path behind a node", "0-0-0-0/../x", 5, ErrorCode::Malformed,
                                             "is no node"),
                                        HostileSet{
                                            "no nodes", rootPage,
                                            [](nlohmann::json& page) { page = nlohmann::json::object(); },
                                            ErrorCode::Empty, "no points"},
                                        HostileSet{"a page of text", rootPage,
                                                   [](nlohmann::json& page) { page = "0-0-0-0"; },
                                                   ErrorCode::Malformed, rootPage},
                                        described("bounds of five", "bounds", {0, 0, 0, 1, 1},
                                                  ErrorCode::Malformed, "bounds"),
                                        described("bounds of text", "bounds", "0,0,0,1,1,1",
                                                  ErrorCode::Malformed, "bounds"),
                                        described("no cube", "bounds", {0, 0, 0, 64, 64, 65},
                                                  ErrorCode::Malformed, "no cube"),
                                        described("a cube of nothing", "bounds", {5, 5, 5, 5, 5, 5},
                                                  ErrorCode::Malformed, "no cube"),
                                        described("an endless cube", "bounds",
                                                  {-1e308, -1e308, -1e308, 1e308, 1e308, 1e308},
                                                  ErrorCode::Malformed, "no cube"),
                                        described(
                                            "a cube elsewhere", "bounds", {1e8, 0, 0, 1e8 + 64, 64, 64},
                                            ErrorCode::Malformed, "outside"),
                                        described("another version",
                                                  "version", "2.0", ErrorCode::Unsupported, "version"),
                                        described("other tiles",
                                                  "dataType", "../laszip", ErrorCode::Unsupported, "laszip"),
                                        described(
                                            "another hierarchy", "hierarchyType",
                                            "gzip", ErrorCode::Unsupported, "hierarchy"),
                                        described("no schema", "schema", nullptr,
                                                  ErrorCode::Malformed, "schema"),
                                        described("half a point promised", "points", 0.5,
                                                  ErrorCode::Malformed, "number of points"),
                                        HostileSet{"a description that is none", "ept.json",
                                                   [](nlohmann::json& json) { json = 5; },
                                                   ErrorCode::Malformed, "not valid JSON"},
                                        HostileSet{"a deep description", "ept.json",
                                                   [](nlohmann::json& json) {
                                                       nlohmann::json deep;
                                                       for (int i = 0; i < 100; ++i)
                                                           deep = nlohmann::json::array({deep});
                                                       json["deep"] = deep;
                                                   },
                                                   ErrorCode::Malformed, "deeper"}),
                         [](const auto& one) {
                             std::string name = one.param.name;
                             for (char& c : name)
                                 if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                             return name;
                         });

/// The same node in two pages: the second page's root is in the first as a number, too.
TEST(EptPages, ThatNameANodeTwiceAreRefused) {
    auto folder = EptMaker::make(CopcMaker::make(wavyPoints(3000), 300), Kind::Binary);
    folder.write("ept-hierarchy/1-0-0-0.json", R"({"1-0-0-0": 7})");
    const Bytes& bytes = folder.files.at(rootPage);
    std::string page(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    page.insert(1, R"("1-0-0-0": -1, )");
    folder.write(rootPage, page);
    const auto file = openFolder(std::move(folder));
    ASSERT_FALSE(file);
    EXPECT_THAT(file.error().message, HasSubstr("1-0-0-0 is in its octree twice"));
}

/// Each within its limits, together beyond all: refused before anything is kept of them.
TEST(EptPages, ThatReferToTooManyAreRefused) {
    MemoryFolder folder;
    folder.write("ept-hierarchy/0-0-0-0.json",
                 R"({"0-0-0-0": 5, "1-0-0-0": -1, "1-1-0-0": -1, "1-0-1-0": -1})");
    auto limits = VoxelLimits();
    limits.pages = 3;
    const auto pages = readEptTree(folder, limits);
    ASSERT_FALSE(pages);
    EXPECT_EQ(pages.error().code, ErrorCode::ResourceLimit);
    EXPECT_EQ(folder.asked.size(), 1U);
    folder.write("ept-hierarchy/0-0-0-0.json", R"({"0-0-0-0": 5, "1-0-0-0": 1, "1-1-0-0": 1})");
    limits.entries = 2;
    const auto nodes = readEptTree(folder, limits);
    ASSERT_FALSE(nodes);
    EXPECT_EQ(nodes.error().code, ErrorCode::ResourceLimit);
    EXPECT_THAT(nodes.error().message, HasSubstr("ingest it"));
}

/// A tile on another grid, or with other records, is damaged: its points would be elsewhere.
TEST(EptTiles, OnAnotherGridAreDamaged) {
    const CopcBytes copc = CopcMaker::make(wavyPoints(3000), 300);
    auto folder = EptMaker::make(copc, Kind::Laszip);
    const VoxelKey leaf = copc.voxels.rbegin()->first;
    storeLe(folder.files.at(EptMaker::tileName(leaf, Kind::Laszip)).data() + 155, 1001.0);
    const auto file = openFolder(std::move(folder));
    ASSERT_TRUE(file) << file.error().message;
    std::size_t damaged = 0;
    for (std::uint32_t i = 0; i < (*file)->nodes().size(); ++i)
        if (const auto samples = (*file)->samples(i); !samples) {
            ++damaged;
            EXPECT_THAT(samples.error().message, HasSubstr("others than those of other tiles"));
        }
    EXPECT_EQ(damaged, 1U);
}

}  // namespace scancast::test
