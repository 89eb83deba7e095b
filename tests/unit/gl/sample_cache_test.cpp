#include "renderer/device/gl/memory/sample_cache.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <utility>

#include "tests/support/pictures/gl_context_test.hpp"

namespace scancast::gl {
namespace {

constexpr const char* collector =
    "#version 450 core\n"
    "layout(local_size_x = 64) in;\n"
    "layout(binding = 0) uniform usamplerBuffer samples;\n"
    "layout(std430, binding = 1) buffer Seen { uvec4 seen[]; };\n"
    "layout(std430, binding = 2) buffer Times { uint times[]; };\n"
    "layout(std430, binding = 3) readonly buffer Extents { uvec4 extents[]; };  // to, count, at, "
    "curvatures\n"
    "layout(std430, binding = 4) buffer Curvatures { uint curvatures[]; };\n"
    "layout(location = 0) uniform uint extent;\n"
    "void main() {\n"
    "    uvec4 e = extents[extent];\n"
    "    for (uint i = gl_LocalInvocationID.x; i < e.y; i += 64u) {\n"
    "        seen[e.x + i] = texelFetch(samples, int(e.z + i));\n"
    "        atomicAdd(times[e.x + i], 1u);\n"
    "        uint word = e.w + i;\n"
    "        curvatures[e.x + i] = e.w == 0u ? 0u : texelFetch(samples, int(word >> 2))[word & 3u];\n"
    "    }\n"
    "}\n";

/// Nodes of one octree, or a cut made by hand.
struct TestCut {
    std::vector<std::vector<Sample>> samples;
    std::vector<std::vector<CurvatureCode>> curvatures;
    std::vector<Node> nodes;
    Cut cut;

    TestCut(std::uint64_t source, std::uint32_t runs, std::uint32_t most, std::uint32_t seed) {
        std::mt19937 random(seed);
        for (std::uint32_t i = 0; i < runs; ++i) samples.emplace_back(1 + random() % most);
        fill(seed);
        nodes.resize(runs);
        cut.source = source;
        for (std::uint32_t i = 0; i < runs; ++i) {
            nodes[i].sampleCount = static_cast<std::uint32_t>(samples[i].size());
            cut.runs.push_back({.node = &nodes[i],
                                .nodeIndex = 3 * i,
                                .samples = samples[i],
                                .firstOrdinal = static_cast<std::uint32_t>(cut.samples)});
            cut.samples += samples[i].size();
        }
    }
    TestCut(const TestCut&) = delete;

    /// The same nodes, by somebody who asks how they bend; or no longer.
    void ask(bool asks) {
        curvatures.resize(samples.size());
        for (std::size_t i = 0; i < samples.size(); ++i) {
            curvatures[i].resize(samples[i].size());
            for (std::size_t s = 0; s < samples[i].size(); ++s)
                curvatures[i][s] = CurvatureCode(1 + 7919 * i + s);
            cut.runs[i].beside =
                asks ? std::span<const CurvatureCode>(curvatures[i]) : std::span<const CurvatureCode>();
        }
    }

    void fill(std::uint32_t seed) {
        std::mt19937 random(seed);
        for (auto& run : samples)
            for (Sample& sample : run) {
                const std::uint32_t words[4] = {std::uint32_t(random()), std::uint32_t(random()), 7, seed};
                std::memcpy(&sample, words, sizeof(Sample));
            }
    }
    std::vector<std::uint32_t> everyRun() const {
        std::vector<std::uint32_t> all;
        for (std::uint32_t i = 0; i < cut.runs.size(); ++i) all.push_back(i);
        return all;
    }
};

class SampleCacheTest : public WithContext {
  protected:
    void SetUp() override {
        WithContext::SetUp();
        if (!context_) return;
        auto program = Program::compile(gl(), "collector", collector);
        ASSERT_TRUE(program) << program.error().message;
        program_.emplace(std::move(*program));
    }
    void TearDown() override {
        program_.reset();
        WithContext::TearDown();
    }

    /// Oracle: what the GPU finds at the extents it was told of is what the host has, every sample once.
    /// Returns the number of batches.
    int expectEverySampleOnce(CutSamples& resident, const TestCut& test) {
        Buffer seen(gl(), "seen"), times(gl(), "times"), extents(gl(), "extents");
        Buffer curvatures(gl(), "curvatures");
        EXPECT_TRUE(curvatures.reserve(test.cut.samples * sizeof(CurvatureCode)));
        EXPECT_TRUE(seen.reserve(test.cut.samples * sizeof(Sample)));
        EXPECT_TRUE(times.reserve(test.cut.samples * 4));
        times.clear(test.cut.samples, 0);
        program_->use();
        int batches = 0;
        const auto drawn = resident.forEachBatch(
            [&](const SampleBatch& batch) -> Expected<void> {
                ++batches;
                EXPECT_GT(batch.version, 0u);
                for (const SampleBatch::Page& page : batch.pages) {
                    std::vector<glm::uvec4> told;
                    for (const Extent& e : page.extents)
                        told.emplace_back(test.cut.runs[e.run].firstOrdinal + e.first, e.count, e.at,
                                          e.beside);
                    EXPECT_TRUE(extents.write(std::as_bytes(std::span(told))));
                    page.texels->bind(0);
                    seen.bindStorage(1);
                    times.bindStorage(2);
                    extents.bindStorage(3);
                    curvatures.bindStorage(4);
                    for (std::uint32_t i = 0; i < told.size(); ++i) {
                        gl().Uniform1ui(0, i);
                        gl().DispatchCompute(1, 1, 1);
                    }
                }
                return {};
            },
            {});
        EXPECT_TRUE(drawn) << drawn.error().message;
        gl().MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        std::vector<Sample> found(test.cut.samples);
        std::vector<std::uint32_t> counts(test.cut.samples);
        std::vector<CurvatureCode> bent(test.cut.samples);
        seen.read(std::as_writable_bytes(std::span(found)));
        times.read(std::as_writable_bytes(std::span(counts)));
        curvatures.read(std::as_writable_bytes(std::span(bent)));
        EXPECT_TRUE(checkErrors(gl(), "testing"));
        for (const std::uint32_t count : counts)
            if (count != 1) {
                ADD_FAILURE() << "a sample was drawn " << count << " times";
                break;
            }
        for (const CutRun& run : test.cut.runs)
            if (std::memcmp(found.data() + run.firstOrdinal, run.samples.data(), run.samples.size_bytes()) !=
                0) {
                ADD_FAILURE() << "the samples of run " << (&run - test.cut.runs.data()) << " are others";
                break;
            }
        for (const CutRun& run : test.cut.runs)
            if (std::memcmp(bent.data() + run.firstOrdinal, run.beside.data(), run.beside.size_bytes()) !=
                0) {
                ADD_FAILURE() << "the curvatures of run " << (&run - test.cut.runs.data()) << " are others";
                break;
            }
        return batches;
    }
    int drawOnce(SampleCache& cache, const TestCut& test) {
        CutSamples resident(cache, test.cut, test.everyRun());
        return expectEverySampleOnce(resident, test);
    }
    static std::uint64_t bytesOf(const TestCut& test) { return test.cut.samples * sizeof(Sample); }

    std::optional<Program> program_;
};
INSTANTIATE_TEST_SUITE_P(Gl, SampleCacheTest, testing::Values("egl"),
                         [](const testing::TestParamInfo<std::string>& c) { return c.param; });

constexpr std::uint64_t mib = 1 << 20;

TEST_P(SampleCacheTest, WhatWasDrawnBeforeIsNotUploadedAgain) {
    SampleCache cache(gl(), {.memoryLimit = 64 * mib, .firstPage = mib});
    const TestCut test(newSource(), 60, 9000, 1);
    EXPECT_EQ(drawOnce(cache, test), 1);
    EXPECT_EQ(cache.bytesUploaded(), bytesOf(test));
    EXPECT_LT(cache.bytes(), 16 * mib) << "pages come as they are needed";
    CutSamples resident(cache, test.cut, test.everyRun());
    for (int i = 0; i < 3; ++i) EXPECT_EQ(expectEverySampleOnce(resident, test), 1);
    EXPECT_EQ(cache.bytesUploaded(), bytesOf(test));
}

TEST_P(SampleCacheTest, ABatchThatIsStillThereKeepsItsVersion) {
    SampleCache cache(gl(), {.memoryLimit = mib, .firstPage = mib});
    const TestCut test(newSource(), 20, 5000, 1), other(newSource(), 20, 5000, 2);
    ASSERT_LT(bytesOf(test), mib);
    ASSERT_GT(bytesOf(test) + bytesOf(other), mib);
    CutSamples resident(cache, test.cut, test.everyRun());
    const auto versionOf = [&] {
        std::uint64_t version = 0;
        EXPECT_TRUE(resident.forEachBatch(
            [&](const SampleBatch& batch) -> Expected<void> {
                version = batch.version;
                return {};
            },
            {}));
        return version;
    };
    const std::uint64_t first = versionOf();
    EXPECT_EQ(versionOf(), first);
    drawOnce(cache, other);
    EXPECT_NE(versionOf(), first) << "what evicted some of it may have moved it";
}

TEST_P(SampleCacheTest, ACutThatDoesNotFitIsDrawnInBatches) {
    for (const std::uint64_t limit : {4096ull, 65536ull, 300'000ull, 1'000'000ull}) {
        SCOPED_TRACE(limit);
        SampleCache cache(gl(), {.memoryLimit = limit, .firstPage = 16384});
        const TestCut test(newSource(), 40, 4000, 3);
        CutSamples resident(cache, test.cut, test.everyRun());
        const int least = int((bytesOf(test) + limit - 1) / limit);
        for (int i = 0; i < 3; ++i) EXPECT_GE(expectEverySampleOnce(resident, test), least);
        EXPECT_LE(cache.bytes(), limit);
        // The second and third round began with what the one before had left.
        EXPECT_LT(cache.bytesUploaded(), 3 * bytesOf(test));
    }
}

TEST_P(SampleCacheTest, CloudsTakeTurnsWhereThereIsRoomForOne) {
    SampleCache cache(gl(), {.memoryLimit = 2 * mib, .firstPage = 2 * mib});
    const TestCut one(newSource(), 30, 7000, 4), two(newSource(), 30, 7000, 5);
    ASSERT_LT(bytesOf(one), 2 * mib);
    ASSERT_GT(bytesOf(one) + bytesOf(two), 2 * mib);
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(drawOnce(cache, one), 1);
        EXPECT_EQ(drawOnce(cache, two), 1);
    }
}

TEST_P(SampleCacheTest, LayersOfOnePictureMayDriveEachOtherOut) {
    SampleCache cache(gl(), {.memoryLimit = 2 * mib, .firstPage = mib});
    const TestCut one(newSource(), 30, 7000, 6), two(newSource(), 30, 7000, 7);
    ASSERT_GT(bytesOf(one) + bytesOf(two), 2 * mib);
    CutSamples first(cache, one.cut, one.everyRun()), second(cache, two.cut, two.everyRun());
    for (int i = 0; i < 4; ++i) {
        expectEverySampleOnce(first, one);
        expectEverySampleOnce(second, two);
    }
}

TEST_P(SampleCacheTest, OctreesOfTheSameShapeAreToldApart) {
    SampleCache cache(gl(), {.memoryLimit = 16 * mib, .firstPage = mib});
    const TestCut one(newSource(), 10, 3000, 8);
    TestCut two(newSource(), 10, 3000, 8);
    two.fill(9);
    drawOnce(cache, one);
    drawOnce(cache, two);
    drawOnce(cache, one);
    EXPECT_EQ(cache.bytesUploaded(), bytesOf(one) + bytesOf(two));
}

TEST_P(SampleCacheTest, CutsMadeByHandAreUploadedForThemselvesAlone) {
    SampleCache cache(gl(), {.memoryLimit = 4 * mib, .firstPage = mib});
    TestCut test(0, 30, 7000, 10);
    for (std::uint32_t i = 0; i < 6; ++i) {
        CutSamples resident(cache, test.cut, test.everyRun());
        expectEverySampleOnce(resident, test);
        expectEverySampleOnce(resident, test);
        EXPECT_EQ(cache.bytesUploaded(), (i + 1) * bytesOf(test));
        test.fill(11 + i);  // the same memory, other samples
    }
    EXPECT_LE(cache.bytes(), 4 * mib) << "each left its room to the next";
}

TEST_P(SampleCacheTest, OnlyTheRunsThatAreAskedForAreThere) {
    SampleCache cache(gl(), {.memoryLimit = 4 * mib, .firstPage = mib});
    const TestCut test(newSource(), 12, 2000, 12);
    const std::vector<std::uint32_t> wanted{7, 2, 11};
    CutSamples resident(cache, test.cut, wanted);
    std::vector<std::uint32_t> got;
    ASSERT_TRUE(resident.forEachBatch(
        [&](const SampleBatch& batch) -> Expected<void> {
            for (const auto& page : batch.pages)
                for (const Extent& e : page.extents) got.push_back(e.run);
            return {};
        },
        {}));
    EXPECT_EQ(got, wanted) << "in the order asked for";
}

TEST_P(SampleCacheTest, WhatWasBroughtIsThere) {
    SampleCache cache(gl(), {.memoryLimit = 4 * mib, .firstPage = mib});
    const TestCut test(newSource(), 20, 5000, 13);
    const auto has = [&](std::uint32_t run) {
        return cache.has(test.cut.source, test.cut.runs[run].nodeIndex, test.nodes[run].sampleCount, false);
    };
    ASSERT_TRUE(cache.bring(test.cut.source, std::span(test.cut.runs).first(10), {}));
    for (std::uint32_t i = 0; i < 20; ++i) EXPECT_EQ(has(i), i < 10);
    drawOnce(cache, test);
    EXPECT_EQ(cache.bytesUploaded(), bytesOf(test));
    const auto hasBent = [&](std::uint32_t run) {
        return cache.has(test.cut.source, test.cut.runs[run].nodeIndex, test.nodes[run].sampleCount, true);
    };
    for (std::uint32_t i = 0; i < 20; ++i) EXPECT_FALSE(hasBent(i));
    TestCut asking(test.cut.source, 20, 5000, 13);
    asking.ask(true);
    ASSERT_TRUE(cache.bring(asking.cut.source, asking.cut.runs, {}));
    for (std::uint32_t i = 0; i < 20; ++i) EXPECT_TRUE(has(i) && hasBent(i));
}

TEST_P(SampleCacheTest, CurvaturesComeWithTheSamplesOfWhoAsksForThem) {
    for (const std::uint64_t limit : {4096ull, 300'000ull, 64ull * mib}) {
        SCOPED_TRACE(limit);
        SampleCache cache(gl(), {.memoryLimit = limit, .firstPage = 16384});
        TestCut test(newSource(), 40, 4000, 16);
        drawOnce(cache, test);
        const std::uint64_t plain = cache.bytesUploaded();
        test.ask(true);
        for (int i = 0; i < 2; ++i) drawOnce(cache, test);
        EXPECT_LE(cache.bytes(), std::max<std::uint64_t>(limit, 4096));
        const std::uint64_t both = cache.bytesUploaded();
        test.ask(false);
        drawOnce(cache, test);
        if (limit < 64 * mib) continue;
        EXPECT_EQ(plain, bytesOf(test));
        EXPECT_EQ(both, plain + bytesOf(test) / 4 * 5) << "uploaded once, with the samples once more";
        EXPECT_EQ(cache.bytesUploaded(), both) << "who does not ask is served by them, too";
    }
}

/// Of two layers, one asks: what the other had gathered is somewhere else.
TEST_P(SampleCacheTest, WhoAsksLaterMovesWhatOthersHadGathered) {
    SampleCache cache(gl(), {.memoryLimit = 16 * mib, .firstPage = mib});
    const std::uint64_t source = newSource();
    const TestCut plain(source, 30, 7000, 17);
    TestCut asking(source, 30, 7000, 17);
    asking.ask(true);
    CutSamples first(cache, plain.cut, plain.everyRun()), second(cache, asking.cut, asking.everyRun());
    for (int i = 0; i < 3; ++i) {
        expectEverySampleOnce(first, plain);
        expectEverySampleOnce(second, asking);
    }
}

TEST_P(SampleCacheTest, NodesLargerThanTheMemoryAreDealtOut) {
    SampleCache cache(gl(), {.memoryLimit = 100'000, .firstPage = 50'000});
    const TestCut test(newSource(), 3, 60'000, 14);
    EXPECT_GT(drawOnce(cache, test), 3);
    EXPECT_FALSE(cache.has(test.cut.source, 0, test.nodes[0].sampleCount, false));
}

/// The ring of staging memory (32 MiB) goes round more than once.
TEST_P(SampleCacheTest, MoreThanTheStagingMemoryIsUploaded) {
    SampleCache cache(gl(), {.memoryLimit = 256 * mib, .firstPage = 32 * mib});
    const TestCut test(newSource(), 40, 200'000, 15);
    ASSERT_GT(bytesOf(test), 40 * mib);
    EXPECT_EQ(drawOnce(cache, test), 1);
}

/// A driver that has no memory for pages after the first few: nothing else asks for buffers without access.
struct PoorDriver {
    static inline PFNGLNAMEDBUFFERSTORAGEPROC storage = nullptr;
    static inline PFNGLGETERRORPROC error = nullptr;
    static inline int buffersLeft = 0;
    static inline bool refused = false;

    static GlFunctions around(const GlFunctions& gl, int buffers) {
        storage = gl.NamedBufferStorage, error = gl.GetError;
        buffersLeft = buffers, refused = false;
        GlFunctions poor = gl;
        poor.NamedBufferStorage = [](GLuint name, GLsizeiptr bytes, const void* data, GLbitfield flags) {
            if (flags == 0 && buffersLeft-- <= 0)
                refused = true;
            else
                storage(name, bytes, data, flags);
        };
        poor.GetError = [] { return std::exchange(refused, false) ? GL_OUT_OF_MEMORY : error(); };
        return poor;
    }
};

TEST_P(SampleCacheTest, AGpuWithLessMemoryThanTheLimitSaysIsUsedAsFarAsItGoes) {
    const TestCut test(newSource(), 60, 9000, 17);
    ASSERT_GT(bytesOf(test), 3 * mib);
    for (const int pages : {2, 1}) {  // of 1, 2 and 4 MiB
        const GlFunctions poor = PoorDriver::around(gl(), pages);
        SampleCache cache(poor, {.memoryLimit = 7 * mib, .firstPage = mib});
        CutSamples resident(cache, test.cut, test.everyRun());
        for (int i = 0; i < 3; ++i) EXPECT_GT(expectEverySampleOnce(resident, test), 1);
        EXPECT_EQ(cache.bytes(), pages == 1 ? mib : 3 * mib);
    }
    const GlFunctions nothing = PoorDriver::around(gl(), 0);
    SampleCache cache(nothing, {.memoryLimit = mib, .firstPage = mib});
    CutSamples resident(cache, test.cut, test.everyRun());
    const auto drawn = resident.forEachBatch([](const SampleBatch&) -> Expected<void> { return {}; }, {});
    ASSERT_FALSE(drawn);
    EXPECT_EQ(drawn.error().code, ErrorCode::ResourceLimit);
    EXPECT_NE(drawn.error().message.find("--gpu-memory-limit"), std::string::npos);
}

TEST_P(SampleCacheTest, AnAbandonedUploadLeavesNothingWrong) {
    SampleCache cache(gl(), {.memoryLimit = 4 * mib, .firstPage = mib});
    const TestCut test(newSource(), 20, 5000, 16);
    CutSamples resident(cache, test.cut, test.everyRun());
    std::stop_source stop;
    stop.request_stop();
    const auto drawn =
        resident.forEachBatch([](const SampleBatch&) -> Expected<void> { return {}; }, stop.get_token());
    ASSERT_FALSE(drawn);
    EXPECT_EQ(drawn.error().code, ErrorCode::Cancelled);
    EXPECT_EQ(expectEverySampleOnce(resident, test), 1);
}

}  // namespace
}  // namespace scancast::gl
