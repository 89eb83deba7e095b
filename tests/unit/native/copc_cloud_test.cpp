// COPC shown as it is: at every level the whole scan, each point once; its leaves are all points, bit for bit; what is hostile or damaged is
// an error that says what. What is right is what the file was made of, or what reading it from front to back gives.
#include <gmock/gmock.h>

#include "importers/laz/decoder/laz_file.hpp"
#include "importers/laz/laz_chunk.hpp"
#include "renderer/cloud/import/las/las_decode.hpp"
#include "renderer/cloud/native/copc/copc_hierarchy.hpp"
#include "renderer/cloud/native/upper_levels.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "renderer/residency/provide.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/native/copc_bytes.hpp"

namespace scancast::test {

using ::testing::HasSubstr;

namespace {

using File = Expected<std::shared_ptr<const CloudFile>>;

File openBytes(std::span<const std::byte> bytes, std::uint64_t memory = 64 << 20, bool surfels = false) {
    return openCopc(readerOf(bytes), std::make_shared<RawChunks>(),
                    {.name = "wavy.copc.laz",
                     .title = "wavy",
                     .identity = {},
                     .surfels = surfels,
                     .upperPoints = 2000,
                     .memory = std::make_shared<GatheredMemory>(memory)});
}

std::vector<PointValue> sorted(std::vector<PointValue> values) {
    std::ranges::sort(values);
    return values;
}

template <class Wanted>
std::vector<PointValue> valuesOfNodes(const CloudFile& file, Wanted wanted) {
    std::vector<PointValue> all;
    for (std::uint32_t node = 0; node < file.nodes().size(); ++node) {
        if (!wanted(file.nodes()[node].node)) continue;
        const auto samples = file.samples(node);
        EXPECT_TRUE(samples) << samples.error().message;
        if (!samples) return {};
        const auto values = valuesOf(file, node, *samples);
        all.insert(all.end(), values.begin(), values.end());
    }
    return sorted(std::move(all));
}

class CopcCloud : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        made_ = new CopcBytes(CopcMaker::make(wavyPoints(sized(40000, 6000)), 500));
    }
    static void TearDownTestSuite() { delete made_; }
    static const CopcBytes& made() { return *made_; }

  private:
    static inline const CopcBytes* made_ = nullptr;
};

}  // namespace

TEST_F(CopcCloud, LeavesAreAllPoints) {
    const auto file = openBytes(made().file);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_TRUE((*file)->isNative());
    std::vector<PointValue> all;
    for (const CopcPoint& p : made().points) all.push_back(p.value());
    EXPECT_EQ(valuesOfNodes(**file, [](const Node& n) { return n.isLeaf(); }), sorted(all));
    EXPECT_EQ((*file)->facts().points, made().points.size());
}

TEST_F(CopcCloud, EveryLevelShowsWhatIsAboveItOnce) {
    const auto file = openBytes(made().file);
    ASSERT_TRUE(file) << file.error().message;
    int deepest = 0;
    for (const auto& [key, own] : made().voxels) deepest = std::max(deepest, key.level);
    ASSERT_GE(deepest, 3);
    for (int level = 0; level <= deepest; ++level) {
        std::vector<PointValue> above;
        for (const auto& [key, own] : made().voxels)
            if (key.level <= level)
                for (const CopcPoint& p : own) above.push_back(p.value());
        const auto shown = valuesOfNodes(
            **file, [&](const Node& n) { return n.level == level || (n.level < level && n.isLeaf()); });
        EXPECT_EQ(shown, sorted(above)) << level;
    }
}

TEST_F(CopcCloud, SamplesLieInTheirNodesAndNodesInTheirParents) {
    const auto file = openBytes(made().file);
    ASSERT_TRUE(file) << file.error().message;
    const auto nodes = (*file)->nodes();
    std::uint32_t next = 1;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        const Node& n = nodes[i].node;
        if (!n.isLeaf()) {
            ASSERT_EQ(n.firstChild, next);
            next += n.childCount;
        }
        if (n.parent != noNode) {
            EXPECT_LE(n.spacing, nodes[n.parent].node.spacing);
            EXPECT_LE(n.meanSpacing, nodes[n.parent].node.meanSpacing);
        }
        EXPECT_LE(n.meanSpacing, n.spacing);
        const auto samples = (*file)->samples(i);
        ASSERT_TRUE(samples) << samples.error().message;
        for (const Sample& s : *samples) {
            const glm::dvec3 at = position(n, s);
            for (int a = 0; a < 3; ++a) {
                ASSERT_GE(at[a], n.boxMin[a]);
                ASSERT_LE(at[a], n.boxMax[a] + 1e-9);
            }
        }
    }
    EXPECT_EQ(next, nodes.size());
}

TEST_F(CopcCloud, SaysOfTheScanWhatItsUpperLevelsSay) {
    const auto file = openBytes(made().file);
    ASSERT_TRUE(file) << file.error().message;
    const CloudFacts& facts = (*file)->facts();
    EXPECT_TRUE(facts.attributes.color && facts.attributes.intensity && facts.attributes.classification);
    EXPECT_FALSE(facts.attributes.normal);
    EXPECT_EQ(facts.format, "COPC 1.0, LAS 1.4, point format 7");
    EXPECT_NEAR(facts.bounds[0].x, 1000, 0.5);
    EXPECT_TRUE(facts.usual);
    EXPECT_EQ(facts.revision.size(), 32U);
}

/// Whatever is kept, in whatever order it is asked for.
TEST_F(CopcCloud, SamplesAreTheSameBytesHoweverTheyAreRead) {
    const auto one = openBytes(made().file, 64 << 20, true), other = openBytes(made().file, 0, true);
    ASSERT_TRUE(one && other);
    EXPECT_EQ((*one)->facts().revision, (*other)->facts().revision);
    const auto count = std::uint32_t((*one)->nodes().size());
    std::size_t withNormal = 0;
    for (std::uint32_t i = 0; i < count; i += 3) {
        const auto a = (*one)->samples(i), b = (*other)->samples(count - 1 - i),
                   c = (*one)->samples(count - 1 - i);
        ASSERT_TRUE(a && b && c);
        ASSERT_EQ(b->size(), c->size());
        EXPECT_EQ(std::memcmp(b->data(), c->data(), b->size() * sizeof(Sample)), 0);
        for (const Sample& s : *a) withNormal += s.normal != noNormal;
    }
    EXPECT_GT(withNormal, 1000U);
}

TEST_F(CopcCloud, BlocksCountWhatIsReallyInThem) {
    BlockCacheOptions options;
    options.memoryLimit = 256 << 20;
    const auto cache = BlockCache::create(options);
    {
        const auto file = openBytes(made().file);
        ASSERT_TRUE(file);
        const auto cloud = openCloud(*file, cache);
        ASSERT_TRUE(cloud) << cloud.error().message;
        const auto before = cache->stats().bytes;
        EXPECT_GE(before, (*file)->ownMemory());
        std::uint64_t samples = 0;
        for (std::uint32_t i = 0; i < (*cloud)->octree.nodes().size(); ++i) {
            const auto run = (*cloud)->octree.run(i);
            ASSERT_TRUE(run) << run.error().message;
            samples += run->samples.size();
        }
        EXPECT_GT(samples, made().points.size());
        EXPECT_GE(cache->stats().bytes, (*file)->ownMemory() + samples * sizeof(Sample));
    }
    EXPECT_EQ(cache->stats().bytes, 0U);
}

TEST_F(CopcCloud, BoundsThatCannotBeMeantAreNotBelieved) {
    for (const double lie : {std::nan(""), 1e300, -1e300, 0.0}) {
        Bytes bytes = made().file;
        for (std::size_t at = 179; at < 227; at += 8) storeLe(bytes.data() + at, lie);
        const auto file = openBytes(bytes);
        ASSERT_TRUE(file) << lie << file.error().message;
        EXPECT_EQ((*file)->facts().bounds[0], glm::dvec3(1000, 2000, 0));
        EXPECT_EQ((*file)->facts().bounds[1], glm::dvec3(1064, 2064, 64));
        EXPECT_TRUE((*file)->samples(std::uint32_t((*file)->nodes().size() - 1)));
    }
}

/// Of a node with more samples than it was said to have, and those that follow.
TEST_F(CopcCloud, RunsHaveOrdinalsOfTheirOwnHoweverManySamplesCame) {
    BlockCacheOptions options;
    options.memoryLimit = 256 << 20;
    const auto file = openBytes(made().file);
    ASSERT_TRUE(file);
    const auto cloud = openCloud(*file, BlockCache::create(options));
    ASSERT_TRUE(cloud);
    Cut wanted;
    for (std::uint32_t i = 0; i < (*cloud)->octree.nodes().size(); ++i)
        if (const Node& node = (*cloud)->octree.node(i); node.isLeaf())
            wanted.runs.push_back({.node = &node, .nodeIndex = i, .samples = {}});
    number(wanted);
    const auto cut = provide((*cloud)->octree, std::move(wanted));
    ASSERT_TRUE(cut) << cut.error().message;
    std::uint64_t end = 0;
    std::size_t more = 0, all = 0;
    for (const CutRun& run : cut->runs) {
        EXPECT_GE(run.firstOrdinal, end);
        end = run.firstOrdinal + run.samples.size();
        more += run.samples.size() > run.node->sampleCount;
        all += run.samples.size();
    }
    EXPECT_GT(more, 0U);
    EXPECT_EQ(all, made().points.size());
}

TEST_F(CopcCloud, ADamagedChunkCostsWhatLiesBelowIt) {
    Bytes bytes = made().file;
    // The last entry: a leaf of the deepest level, which says that it has fewer bytes than points.
    const std::uint64_t at = made().pageAt + (made().entries - 1) * copcEntryBytes;
    storeLe(bytes.data() + at + 24, loadLe<std::int32_t>(bytes.data() + at + 24) - 1);
    const auto file = openBytes(bytes);
    ASSERT_TRUE(file) << file.error().message;
    std::size_t damaged = 0;
    for (std::uint32_t i = 0; i < (*file)->nodes().size(); ++i)
        if (const auto samples = (*file)->samples(i); !samples) {
            ++damaged;
            EXPECT_EQ(samples.error().code, ErrorCode::Malformed);
            EXPECT_THAT(samples.error().message, HasSubstr("wavy.copc.laz, voxel"));
        }
    EXPECT_EQ(damaged, 1U);
}

TEST(CopcUpperLevels, AreSomeVoxelsWhereTheLevelsAboveAreEmpty) {
    VoxelTree hierarchy;
    for (std::int32_t level = 0; level <= 3; ++level)
        for (std::int32_t at = 0; at < 1 << level; ++at) {
            Voxel& voxel = hierarchy.voxels.emplace_back();
            voxel.key = {level, {at, 0, 0}};
            voxel.points = level < 3 ? 0 : 100'000;
        }
    const auto upper = upperVoxels(hierarchy, 50'000);
    EXPECT_EQ(upper, (std::vector<std::uint32_t>{7, 12}));
}

/// Each may be a request.
TEST(CopcUpperLevels, AreNotMoreVoxelsThanAreFetchedAtOnce) {
    for (const std::uint32_t above : {0U, 1U}) {
        VoxelTree hierarchy;
        for (std::int32_t level = 0; level <= 14; ++level)
            for (std::int32_t at = 0; at < 1 << level; ++at) {
                Voxel& voxel = hierarchy.voxels.emplace_back();
                voxel.key = {level, {at, 0, 0}};
                voxel.points = level < 14 ? above : 1;
            }
        // Whole levels, of 1 + 2 + … + 256; or some of one.
        EXPECT_EQ(upperVoxels(hierarchy, 50'000).size(), above > 0 ? 511U : 512U);
    }
}

namespace {

/// One thing changed in a file that is sound otherwise.
struct Hostile {
    const char* name;
    std::function<void(Bytes&, const CopcBytes&)> change;
    ErrorCode code;
};

void PrintTo(const Hostile& hostile, std::ostream* out) {
    *out << hostile.name;
}

template <class T>
auto entry(std::uint64_t index, std::size_t at, T value) {
    return [=](Bytes& bytes, const CopcBytes& made) {
        storeLe(bytes.data() + made.pageAt + index * copcEntryBytes + at, value);
    };
}

template <class T>
auto byteAt(std::size_t at, T value) {
    return [=](Bytes& bytes, const CopcBytes&) { storeLe(bytes.data() + at, value); };
}

class HostileCopc : public ::testing::TestWithParam<Hostile> {};

}  // namespace

TEST_P(HostileCopc, IsAnErrorThatSaysWhat) {
    const CopcBytes made = CopcMaker::make(wavyPoints(3000), 300);
    Bytes bytes = made.file;
    GetParam().change(bytes, made);
    const auto file = openBytes(bytes);
    ASSERT_FALSE(file);
    EXPECT_EQ(name(file.error().code), name(GetParam().code)) << file.error().message;
    EXPECT_THAT(file.error().message, HasSubstr("wavy.copc.laz: "));
}

INSTANTIATE_TEST_SUITE_P(
    All, HostileCopc,
    ::testing::Values(
        Hostile{"page in a circle",
                [](Bytes& bytes, const CopcBytes& made) {
                    storeLe(bytes.data() + made.pageAt + 3 * copcEntryBytes + 16, made.pageAt);
                    storeLe(bytes.data() + made.pageAt + 3 * copcEntryBytes + 24,
                            std::int32_t(made.entries * copcEntryBytes));
                    storeLe(bytes.data() + made.pageAt + 3 * copcEntryBytes + 28, std::int32_t(-1));
                },
                ErrorCode::Malformed},
        Hostile{"page outside", byteAt(469, std::uint64_t(1) << 60), ErrorCode::Malformed},
        Hostile{"page around the end", byteAt(469, ~std::uint64_t(0) - 31), ErrorCode::Malformed},
        Hostile{"page of half an entry", byteAt(477, std::uint64_t(40)), ErrorCode::Malformed},
        Hostile{"no pages", byteAt(477, std::uint64_t(0)), ErrorCode::Malformed},
        Hostile{"2^31 - 1 points", entry(1, 28, INT32_MAX), ErrorCode::ResourceLimit},
        Hostile{"negative points", entry(1, 28, std::int32_t(-2)), ErrorCode::Malformed},
        Hostile{"chunk outside", entry(1, 16, std::uint64_t(1) << 62), ErrorCode::Malformed},
        Hostile{"negative bytes", entry(1, 24, std::int32_t(-5)), ErrorCode::Malformed},
        Hostile{"too deep", entry(1, 0, std::int32_t(31)), ErrorCode::Malformed},
        Hostile{"negative level", entry(1, 0, std::int32_t(-1)), ErrorCode::Malformed},
        Hostile{"outside the octree", entry(1, 4, std::int32_t(2)), ErrorCode::Malformed},
        Hostile{"no parent", entry(1, 0, std::int32_t(20)), ErrorCode::Malformed},
        Hostile{"twice",
                [](Bytes& bytes, const CopcBytes& made) {
                    std::memcpy(bytes.data() + made.pageAt + copcEntryBytes,
                                bytes.data() + made.pageAt + 2 * copcEntryBytes, 16);
                },
                ErrorCode::Malformed},
        Hostile{"the same points twice",
                [](Bytes& bytes, const CopcBytes& made) {
                    std::memcpy(bytes.data() + made.pageAt + copcEntryBytes + 16,
                                bytes.data() + made.pageAt + 2 * copcEntryBytes + 16, 16);
                },
                ErrorCode::Malformed},
        Hostile{"a cube of NaN", byteAt(453, std::nan("")), ErrorCode::Malformed},
        Hostile{"a cube of nothing", byteAt(453, 0.0), ErrorCode::Malformed},
        Hostile{"a cube beyond all grids", byteAt(453, 1e300), ErrorCode::Malformed},
        Hostile{"a cube elsewhere", byteAt(429, 1e9), ErrorCode::Malformed},
        Hostile{"not compressed", byteAt(104, std::uint8_t(7)), ErrorCode::Malformed},
        Hostile{"points before the head's end", byteAt(96, std::uint32_t(400)), ErrorCode::Malformed},
        Hostile{"points far behind", byteAt(96, std::uint32_t(1) << 30), ErrorCode::Malformed},
        Hostile{"no LASzip record", byteAt(429 + 160 + 18, std::uint16_t(1)), ErrorCode::Malformed},
        Hostile{"a record of another length", byteAt(395, std::uint16_t(159)), ErrorCode::Malformed}),
    [](const auto& one) {
        std::string name = one.param.name;
        for (char& c : name)
            if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
        return name;
    });

TEST(CopcCutAnywhere, IsAnErrorOrOpens) {
    const CopcBytes made = CopcMaker::make(wavyPoints(300), 100);
    for (std::size_t end = 0; end < made.file.size(); end += end < 700 ? 13 : 997) {
        const auto file = openBytes(std::span(made.file).first(end));
        EXPECT_FALSE(file) << end;
    }
}

namespace {

/// The program's code, in this process.
class LazChunks final : public ChunkDecoders {
  public:
    Expected<Bytes> decode(const ChunkShape& shape, std::uint64_t points,
                           std::span<const std::byte> chunk) override {
        return import_laz::decodeChunk({shape.packing, shape.pointFormat, shape.recordBytes,
                                        std::uint32_t(shape.laszip.size()), points, chunk.size()},
                                       shape.laszip, chunk);
    }
};

class RealCopc : public ::testing::TestWithParam<const char*> {};

}  // namespace

/// Each point as the file has it, read from front to back.
TEST_P(RealCopc, LeavesAreAllPoints) {
    REQUIRE_TEST_DATA(GetParam());
    auto input = InputFile::open(testData(GetParam()));
    ASSERT_TRUE(input);
    const auto laz = laz::LazFile::open(std::make_shared<laz::FileAccess>(std::move(*input)));
    ASSERT_TRUE(laz);
    const auto head = parseLasHeader(laz->head().first(lasHeaderBytes), "it");
    ASSERT_TRUE(head) << head.error().message;
    std::vector<PointValue> all;
    LasColorDepth depth = LasColorDepth::Unknown;
    std::vector<Bytes> chunks;
    for (const laz::Chunk& chunk : laz->chunks()) {
        Bytes& records = chunks.emplace_back(std::size_t(chunk.points) * head->recordBytes);
        ASSERT_TRUE(laz::decodeChunk(*laz, chunk, records));
        depth = std::max(depth, colorDepth(records, *head));
    }
    for (const Bytes& records : chunks) {
        PointBatch batch;
        decodeLasRecords(records, *head, depth, batch);
        const auto steps = batch.position.asSteps();
        for (std::size_t i = 0; i < steps.size(); ++i)
            all.emplace_back(steps[i][0], steps[i][1], steps[i][2], batch.intensity[i], batch.color[i][0],
                             batch.color[i][1], batch.color[i][2], batch.classification[i]);
    }
    auto again = InputFile::open(testData(GetParam()));
    ASSERT_TRUE(again);
    const auto file =
        openCopc(readerOf(std::move(*again)), std::make_shared<LazChunks>(),
                 {.name = GetParam(), .title = "it", .identity = {}, .surfels = false, .upperPoints = 2000});
    ASSERT_TRUE(file) << file.error().message;
    bool isExact = true;
    for (const StoredNode& stored : (*file)->nodes())
        for (int a = 0; a < 3; ++a)
            isExact =
                isExact && (!stored.node.isLeaf() || stored.node.step[a] == (*file)->facts().grid->step[a]);
    auto shown = valuesOfNodes(**file, [](const Node& n) { return n.isLeaf(); });
    if (isExact) {
        EXPECT_EQ(shown, sorted(all));
    } else {  // rounded to the samples' steps
        EXPECT_EQ(shown.size(), all.size());
    }
}

INSTANTIATE_TEST_SUITE_P(All, RealCopc,
                         ::testing::Values("copc/1.2-with-color.copc.laz", "copc/simple_with_page.copc.laz",
                                           "copc/ellipsoid.copc.laz", "copc/lion_takanawa.copc.laz"));

}  // namespace scancast::test
