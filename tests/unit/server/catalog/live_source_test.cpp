// A live source at the end of a named pipe: what a writer writes is what the catalog has.
#include "server/catalog/live_source.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <condition_variable>
#include <mutex>

#include "renderer/cloud/import/stream/point_stream_writer.hpp"
#include "tests/support/serving/fake_painter.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

using namespace std::chrono_literals;

class LiveSourceTest : public ::testing::Test {
  protected:
    LiveSourceTest() : fifo(folder / "frames.fifo") {
        EXPECT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
        options.cache = BlockCache::create({.memoryLimit = std::uint64_t(256) << 20, .onDamaged = {}});
        options.metrics = &metrics;
        options.onNote = [this](const std::string& line) { keep(notes, line); };
        options.onFailure = [this](const std::string& line) { keep(failures, line); };
    }
    ~LiveSourceTest() override { closePipe(); }

    void start() {
        source.emplace(LiveInput{"depth", fifo}, catalog, options);
        openPipe();
    }
    void openPipe() { pipe = ::open(fifo.c_str(), O_WRONLY | O_CLOEXEC); }
    void closePipe() {
        if (pipe >= 0) ::close(pipe);
        pipe = -1;
    }
    void keep(std::vector<std::string>& lines, const std::string& line) {
        const std::lock_guard lock(mutex);
        lines.push_back(line);
    }
    std::vector<std::string> linesOf(const std::vector<std::string>& lines) {
        const std::lock_guard lock(mutex);
        return lines;
    }
    /// A patch of points whose corner is at x.
    void write(double x, std::size_t points = 100) const {
        PointStreamWriter writer(PointStreamWriter::toDescriptor(pipe));
        ScanHeader header;
        header.format = "test camera";
        header.attributes.color = true;
        PointBatch batch;
        for (std::size_t i = 0; i < points; ++i) {
            batch.position.emplace_back(x + double(i % 10), double(i / 10), 0.1 * double(i % 3));
            batch.color.push_back({std::uint8_t(i), 100, 50});
        }
        EXPECT_TRUE(writer.writeHeader(header) && writer.writeChunk(batch) && writer.finish(0));
    }
    LiveStatus status() const { return catalog.find("depth")->live.value_or(LiveStatus()); }
    bool shows(std::uint64_t count) const {
        return test::soon([&] { return status().shown >= count; });
    }
    bool is(LiveStatus::State state) const {
        return test::soon([&] { return status().state == state; });
    }
    std::shared_ptr<const Cloud> cloud() const { return catalog.cloud("depth").value_or(nullptr); }

    const test::TemporaryFolder folder;
    const std::filesystem::path fifo;
    std::mutex mutex;
    std::vector<std::string> notes, failures;
    Metrics metrics{"test"};
    Catalog catalog;
    LiveOptions options;
    std::optional<LiveSource> source;
    int pipe = -1;
};

TEST(LiveInput, IsANameAndAPath) {
    EXPECT_EQ(parseLiveInput("a=b=c")->path, "b=c");
    EXPECT_FALSE(parseLiveInput("a"));
}

TEST_F(LiveSourceTest, EachFrameTakesThePlaceOfTheOneBefore) {
    start();
    EXPECT_FALSE(cloud());
    EXPECT_EQ(catalog.find("depth")->state, CloudState::Loading);
    write(0);
    ASSERT_TRUE(shows(1));
    const auto first = cloud();
    EXPECT_EQ(first->points, 100U);
    EXPECT_EQ(first->title, "depth");
    EXPECT_EQ(catalog.find("depth")->state, CloudState::Ready);
    write(3, 120);
    ASSERT_TRUE(shows(2));
    const auto second = cloud();
    EXPECT_EQ(second->points, 120U);
    EXPECT_NE(pictureRevision(*second), pictureRevision(*first));
    ASSERT_TRUE(first->look);
    EXPECT_EQ(second->look, first->look) << "the camera does not jump";
    EXPECT_EQ(second->origin, first->origin);
    EXPECT_THAT(metrics.text(), testing::HasSubstr("scancast_live_frames_total{outcome=\"shown\"} 2"));
}

TEST_F(LiveSourceTest, TheSameFrameAgainIsTheSameRevision) {
    start();
    write(0);
    ASSERT_TRUE(shows(1));
    const auto first = cloud();
    write(0);
    ASSERT_TRUE(shows(2));
    EXPECT_EQ(pictureRevision(*cloud()), pictureRevision(*first));
}

// The builder waits at a gate while frames come: of those only the last is built, and the others are counted.
TEST_F(LiveSourceTest, TheLatestFrameWins) {
    std::mutex gate;
    options.onChanged = [&] { const std::lock_guard wait(gate); };
    gate.lock();
    start();
    write(0);
    ASSERT_TRUE(test::soon([&] { return cloud() != nullptr; }));
    for (int n = 1; n <= 5; ++n) write(n, 100 + std::size_t(n));
    ASSERT_TRUE(test::soon([&] {
        return metrics.text().find("scancast_live_frames_total{outcome=\"skipped\"} 4") != std::string::npos;
    }));
    gate.unlock();
    ASSERT_TRUE(shows(2));
    EXPECT_EQ(cloud()->points, 105U);
    EXPECT_EQ(status().skipped, 4U);
    closePipe();
    ASSERT_TRUE(is(LiveStatus::State::Ended));
    ASSERT_TRUE(test::soon([&] { return linesOf(notes).size() >= 2; }));
    EXPECT_THAT(linesOf(notes).front(), testing::HasSubstr("skipped"));
    source.reset();  // before the gate goes
}

TEST_F(LiveSourceTest, TheLastFrameStaysAndAnotherWriterGoesOn) {
    start();
    write(0);
    ASSERT_TRUE(shows(1));
    closePipe();
    ASSERT_TRUE(is(LiveStatus::State::Ended));
    EXPECT_EQ(cloud()->points, 100U);
    EXPECT_FALSE(source->finished()) << "a pipe outlives its writers";
    openPipe();
    write(1, 150);
    ASSERT_TRUE(shows(2));
    EXPECT_EQ(status().state, LiveStatus::State::Running);
    EXPECT_EQ(cloud()->points, 150U);
}

TEST_F(LiveSourceTest, AFrameThatItsSenderGaveUpIsToldAndTheNextIsShown) {
    start();
    write(0);
    ASSERT_TRUE(shows(1));
    PointStreamWriter writer(PointStreamWriter::toDescriptor(pipe));
    ASSERT_TRUE(writer.writeFailure({ErrorCode::Io, "the camera is too hot", {}}));
    ASSERT_TRUE(test::soon([&] { return status().failed == 1; }));
    EXPECT_EQ(status().state, LiveStatus::State::Running);
    EXPECT_THAT(status().error, testing::HasSubstr("too hot"));
    EXPECT_EQ(cloud()->points, 100U);
    EXPECT_THAT(linesOf(failures).at(0), testing::HasSubstr("depth: "));
    write(1, 150);
    ASSERT_TRUE(shows(2));
    EXPECT_EQ(status().error, "");
}

TEST_F(LiveSourceTest, AStreamThatBreaksItsRulesIsReadNoFurther) {
    start();
    write(0);
    ASSERT_TRUE(shows(1));
    const std::string nonsense(300, 'x');
    ASSERT_EQ(::write(pipe, nonsense.data(), nonsense.size()), ssize_t(nonsense.size()));
    ASSERT_TRUE(is(LiveStatus::State::Broken));
    EXPECT_EQ(cloud()->points, 100U) << "the last sound one stays";
    EXPECT_NE(status().error, "");
    EXPECT_EQ(status().failed, 1U);
    write(1, 150);  // of the same writer: nobody knows where it begins
    closePipe();
    ASSERT_TRUE(test::soon([&] { return linesOf(failures).size() == 2; }));
    EXPECT_EQ(status().shown, 1U);
    source.reset();
    EXPECT_EQ(cloud()->points, 100U);
}

TEST_F(LiveSourceTest, AFrameThatWouldNotFitIsRefused) {
    options.cache = BlockCache::create({.memoryLimit = std::uint64_t(1) << 20, .onDamaged = {}});
    start();
    ASSERT_LT(mostFramePoints(1 << 20), 5000U);
    std::thread writer([&] {
        PointStreamWriter stream([&](std::span<const std::byte> bytes) {
            return ::write(pipe, bytes.data(), bytes.size()) == ssize_t(bytes.size());
        });
        ScanHeader header;
        header.points = 1'000'000'000'000;
        EXPECT_TRUE(stream.writeHeader(header));
        EXPECT_TRUE(stream.finish(0));
    });
    writer.join();
    ASSERT_TRUE(is(LiveStatus::State::Broken));
    EXPECT_THAT(status().error, testing::HasSubstr("memory limit"));
}

TEST_F(LiveSourceTest, AFileOfFramesIsPlayedOnce) {
    const auto path = folder / "frames.bin";
    pipe = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    write(0);
    closePipe();
    source.emplace(LiveInput{"depth", path}, catalog, options);
    ASSERT_TRUE(test::soon([&] { return source->finished(); }));
    EXPECT_EQ(cloud()->points, 100U);
    EXPECT_FALSE(source->failed());
}

TEST_F(LiveSourceTest, WithoutAFrameItHasFailed) {
    for (const char* name : {"nothing", "none", "empty"}) {
        if (std::string(name) == "empty") folder.write(name, "");
        const LiveSource none({name, folder / name}, catalog, options);
        ASSERT_TRUE(test::soon([&] { return catalog.find(name)->state == CloudState::Failed; })) << name;
        EXPECT_TRUE(none.failed());
        EXPECT_EQ(catalog.cloud(name).error().status, 404);
    }
}

TEST_F(LiveSourceTest, ItStopsWhileItWaits) {
    source.emplace(LiveInput{"depth", fifo}, catalog, options);  // no writer ever came
    source.reset();
    EXPECT_EQ(catalog.find("depth")->state, CloudState::Loading);
}

}  // namespace
}  // namespace scancast
