// Programs that decode chunks: they answer, also after a chunk that is damaged; one that crashes, lies or hangs costs an error, and the
// next is asked instead of it.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/stat.h>

#include <fstream>
#include <thread>

#include "importers/laz/decoder/laz_file.hpp"
#include "renderer/cloud/import/stream/chunk_messages.hpp"
#include "renderer/cloud/native/chunk_decoders.hpp"
#include "renderer/cloud/native/copc/copc_cloud.hpp"
#include "renderer/cloud/native/copc/copc_head.hpp"
#include "renderer/cloud/native/copc/copc_hierarchy.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/native/ept_bytes.hpp"

namespace scancast::test {

using ::testing::HasSubstr;

namespace {

constexpr const char* realFile = "copc/ellipsoid.copc.laz";

ImportOptions realProgram() {
    return {.importerDirectory = SCANCAST_BIN_DIR, .importerSilenceSeconds = 20};
}

struct RealChunks {
    std::unique_ptr<RandomReader> reader;
    ChunkShape shape;
    VoxelTree hierarchy;

    std::vector<std::byte> chunk(std::size_t voxel) const {
        std::vector<std::byte> bytes(hierarchy.voxels[voxel].bytes);
        EXPECT_TRUE(reader->readAt(hierarchy.voxels[voxel].offset, bytes));
        return bytes;
    }
};

RealChunks realChunks() {
    RealChunks real;
    real.reader = readerOf(std::move(*InputFile::open(testData(realFile))));
    const auto head = readCopcHead(*real.reader);
    EXPECT_TRUE(head);
    real.shape = head->shape;
    real.hierarchy = std::move(*readCopcHierarchy(*real.reader, head->info));
    return real;
}

/// A program that is none, where decoders are looked for.
class FakeDecoder : public ::testing::Test {
  protected:
    FakeDecoder() { ::signal(SIGPIPE, SIG_IGN); }  // as programs do

    Error errorOf(const std::string& script, int silence = 20) {
        const auto path = folder_.write("scancast-import-laz", "#!/bin/sh\n" + script + "\n");
        ::chmod(path.c_str(), 0755);
        ImportOptions options{.importerDirectory = path.parent_path(), .importerSilenceSeconds = silence};
        options.importerSandbox = ImporterSandbox::Off;
        const auto decoders = ChunkDecoders::create(options, 1);
        const auto records = decoders->decode({7, 36, {}, 1}, 2, std::vector<std::byte>(50));
        EXPECT_FALSE(records);
        return records ? Error() : records.error();
    }
    TemporaryFolder folder_;
};

}  // namespace

TEST(ChunkProgram, DecodesManyAtOnceAndGoesOnAfterADamagedOne) {
    REQUIRE_TEST_DATA(realFile);
    const RealChunks real = realChunks();
    const auto decoders = ChunkDecoders::create(realProgram(), 2);
    const auto& voxels = real.hierarchy.voxels;
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (std::size_t v = std::size_t(t); v < voxels.size(); v += 4) {
                auto chunk = real.chunk(v);
                if (v % 3 == 1) {
                    std::ranges::fill(chunk, std::byte{0xff});
                    const auto bad = decoders->decode(real.shape, voxels[v].points, chunk);
                    ASSERT_FALSE(bad);
                    EXPECT_EQ(bad.error().code, ErrorCode::Malformed) << bad.error().message;
                    chunk = real.chunk(v);
                }
                const auto records = decoders->decode(real.shape, voxels[v].points, chunk);
                ASSERT_TRUE(records) << records.error().message;
                EXPECT_EQ(records->size(), std::size_t(voxels[v].points) * real.shape.recordBytes);
            }
        });
}

/// The importer of octrees, as a program: what its code gives in this process.
TEST(TileProgram, DecodesTilesOfEveryKindAndGoesOnAfterADamagedOne) {
    const CopcBytes copc = CopcMaker::make(wavyPoints(3000), 300);
    const auto decoders = ChunkDecoders::create(realProgram(), 2);
    for (const auto kind : {EptMaker::Kind::Laszip, EptMaker::Kind::Zstandard}) {
        auto folder = EptMaker::make(copc, kind);
        const VoxelKey leaf = copc.voxels.rbegin()->first;
        Bytes& damaged = folder.files.at(EptMaker::tileName(leaf, kind));
        std::fill(damaged.begin() + std::ptrdiff_t(damaged.size() / 2), damaged.end(), std::byte{0xff});
        damaged.resize(damaged.size() - 9);
        const auto open = [&](std::shared_ptr<ChunkDecoders> by) {
            return openEpt(
                std::make_shared<MemoryFolder>(folder), std::move(by),
                {.name = "it", .title = "it", .identity = {}, .surfels = false, .upperPoints = 500});
        };
        const auto file = open(decoders), same = open(std::make_shared<TileDecoders>());
        ASSERT_TRUE(file) << file.error().message;
        ASSERT_TRUE(same) << same.error().message;
        std::size_t bad = 0;
        for (std::uint32_t i = 0; i < (*file)->nodes().size(); ++i) {
            const auto a = (*file)->samples(i), b = (*same)->samples(i);
            ASSERT_EQ(a.has_value(), b.has_value());
            bad += a ? 0 : 1;
            if (a)
                EXPECT_EQ(valuesOf(**file, i, *a), valuesOf(**same, i, *b));
            else
                EXPECT_EQ(a.error().message, b.error().message);
        }
        EXPECT_EQ(bad, 1U);
    }
}

TEST(ChunkProgram, IsNotAskedForMoreThanItMayAnswer) {
    const auto decoders = ChunkDecoders::create(realProgram(), 1);
    const auto records = decoders->decode({7, 36, {}, 1}, std::uint64_t(1) << 40, {});
    ASSERT_FALSE(records);
    EXPECT_EQ(records.error().code, ErrorCode::ResourceLimit);
}

TEST_F(FakeDecoder, ThatEndsIsAnError) {
    const Error error = errorOf("echo out of paper >&2; exit 3");
    EXPECT_EQ(error.code, ErrorCode::Importer);
    EXPECT_THAT(error.message, HasSubstr("exit status 3: out of paper"));
}

TEST_F(FakeDecoder, ThatCrashesIsAnError) {
    EXPECT_THAT(errorOf("ulimit -c 0; kill -SEGV $$").message, HasSubstr("crashed (signal 11"));
}

TEST_F(FakeDecoder, ThatHangsIsAnError) {
    EXPECT_THAT(errorOf("read line; while :; do :; done", 1).message, HasSubstr("hangs"));
}

TEST_F(FakeDecoder, ThatLiesIsAnError) {
    // Once all has been asked: 40 bytes, and the chunk's 50.
    EXPECT_THAT(errorOf("head -c 90 >/dev/null; echo nonsense that is no answer at all").message,
                HasSubstr("its answer is none"));
}

TEST(ChunkMessages, ReadBackAsTheyWereWritten) {
    using namespace chunk_messages;
    const RequestHead request{Packing::LazFile, 7, 36, 52, 1000, 5000};
    const auto read = parseRequest(encode(request));
    ASSERT_TRUE(read);
    EXPECT_EQ(*read, request);
    const AnswerHead good{{}, 36000}, bad{ErrorCode::Truncated, 20};
    EXPECT_EQ(*parseAnswer(encode(good), request), good);
    EXPECT_EQ(*parseAnswer(encode(bad), request), bad);
    EXPECT_FALSE(parseAnswer(encode(AnswerHead{{}, 35999}), request));
    EXPECT_FALSE(parseRequest(encode(RequestHead{Packing::LazChunk, 11, 36, 52, 1000, 5000})));
    EXPECT_FALSE(parseRequest(encode(RequestHead{Packing::LazChunk, 7, 36, 52, 1 << 30, 5000})));
    EXPECT_FALSE(parseRequest(encode(RequestHead{Packing::LazChunk, 7, 0, 52, 1, 5000})));
}

}  // namespace scancast::test
