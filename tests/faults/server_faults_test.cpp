// Faults of the network, of memory and of a clock while a server answers: a real one, with a cloud file and the CPU device. A
// client gets the right picture, a status that says why not, or the end of its connection; the next one gets the picture.
#include <atomic>
#include <cerrno>
#include <memory>
#include <thread>
#include <utility>

#include "renderer/cloud/build/ingest.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "tests/faults/fault_trials.hpp"
#include "tests/integration/server_fixture.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/failing_allocation.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

using test::Call;
using test::Fault;
using test::Scene;
using test::Whose;

/// That device, lost at the picture at which `left` comes to 0; another of its kind takes over.
OpenPainter losing(const OpenPainter& open, std::atomic<int>& left) {
    return [open, &left]() -> Expected<Painter> {
        auto painter = open();
        if (!painter) return painter;
        painter->begin = [begin = painter->begin, &left](
                             const PictureOrder& order, const PreparedPicture& prepared, std::stop_token stop,
                             const Pause& pause) -> Expected<std::unique_ptr<PendingFrame>> {
            if (--left == 0) return fail(ErrorCode::DeviceLost, "It was lost while testing.");
            return begin(order, prepared, std::move(stop), pause);
        };
        painter->instead = losing(open, left);
        return painter;
    };
}

class ServerFaults : public test::FaultTrials {
  protected:
    ServerFaults() {
        std::vector<std::unique_ptr<PointSource>> sources;
        sources.push_back(
            std::make_unique<test::SyntheticSource>(2000, test::ground, Attributes{.color = true}));
        OctreeShape shape;
        shape.leafPoints = 256;
        shape.chunkPoints = 1024;
        shape.surfels = false;
        const auto made =
            ingest(std::move(sources), {.output = folder_ / "ground.scan", .threads = 1, .shape = shape});
        EXPECT_TRUE(made) << made.error().message;
    }
    void SetUp() override {
        start();
        askOnce();
        server_.reset();  // what libraries keep for good has been allocated
        before_ = test::liveAllocations();
        descriptors_ = test::openDescriptors();
        start();
    }
    /// Nothing that a fault left is left after the server, either.
    void TearDown() override {
        server_.reset();
        EXPECT_LE(test::liveAllocations(), before_ + slack) << "blocks of memory are lost";
        EXPECT_LE(test::openDescriptors(), descriptors_);
    }

    void start() {
        ServerOptions options;
        options.port = 0;
        options.netThreads = 1;
        options.limits.quiet = std::chrono::milliseconds(10);
        BlockCacheOptions blocks;
        blocks.memoryLimit = std::uint64_t(64) << 20;
        blocks.threads = 1;
        options.cache = BlockCache::create(blocks);
        DeviceOptions device;
        device.backend = "cpu";
        device.threads = 1;
        auto created = ScancastServer::create(options, losing(devicePainter(device), left_));
        ASSERT_TRUE(created) << created.error().message;
        server_ = std::move(*created);
        const auto cloud = openCloud(folder_ / "ground.scan", options.cache);
        ASSERT_TRUE(cloud) << cloud.error().message;
        server_->catalog().setReady(server_->catalog().add("ground"), *cloud);
        server_->scheduler().waitForDevice(test::netPatience);
    }
    void askOnce() {
        EXPECT_TRUE(snapshot());
        EXPECT_TRUE(stream());
    }

    Expected<std::string> snapshot() {
        const auto reply =
            test::request(server_->port(), "/api/v1/clouds/ground/snapshot.png?width=24&height=16&samples=1",
                          {"Connection: close"});
        if (reply.status == 200) return reply.body;
        EXPECT_TRUE(reply.status == 0 || reply.status == 413 || reply.status == 500 || reply.status == 503)
            << reply.status;
        return fail(ErrorCode::Io, "There was no picture.");
    }
    Expected<std::string> stream() {
        test::StreamClient client(server_->port());
        if (client.greet({{"width", 24}, {"height", 16}}).is_null())
            return fail(ErrorCode::Io, "There was no welcome.");
        client.view(1, 3);
        const auto still = client.finalFrame(1);
        if (!still) return fail(ErrorCode::Io, "There was no still.");
        return std::string(still->picture.begin(), still->picture.end());
    }
    void expectQuiet() const {
        EXPECT_TRUE(soon([this] { return server_->connections() == 0 && server_->drained(); }))
            << "somebody is left";
        EXPECT_EQ(test::request(server_->port(), "/readyz", {"Connection: close"}).status, 200);
        EXPECT_TRUE(soon([this] { return server_->connections() == 0; }));
    }
    template <class Condition>
    static bool soon(Condition condition) {
        const auto end = std::chrono::steady_clock::now() + test::netPatience;
        while (!condition()) {
            if (std::chrono::steady_clock::now() > end) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return true;
    }
    Scene sceneOf(std::function<Expected<std::string>()> ask) {
        return {.run = std::move(ask),
                .before =
                    [this] {
                        soon([this] { return server_->connections() == 0; });
                        left_ = std::exchange(nextLoss_, 0);
                    },
                .after = [this](const auto&, const auto&) { expectQuiet(); },
                .whose = Whose::OtherThreads,
                .leastAllocation = 1100,
                .livesOn = true};
    }

    /// What the log of faults and threads of libraries keep for good.
    static constexpr std::int64_t slack = 40;
    const Scene snapshot_ = sceneOf([this] { return snapshot(); });
    const Scene stream_ = sceneOf([this] { return stream(); });
    const test::TemporaryFolder folder_;
    std::atomic<int> left_{0};  // pictures until the device is lost
    int nextLoss_ = 0;          // that, for the next run
    std::unique_ptr<ScancastServer> server_;
    std::int64_t before_ = 0;
    std::size_t descriptors_ = 0;
};

TEST_F(ServerFaults, EveryCallOfASnapshot) {
    failEach(snapshot_, Call::Accept, {EMFILE, ECONNABORTED, ENOBUFS}, true);
    failEach(snapshot_, Call::Receive, {ECONNRESET, ENOMEM}, true, true);
    failEach(snapshot_, Call::Send, {EPIPE, ECONNRESET, ENOBUFS}, true, true);
}
TEST_F(ServerFaults, EveryCallOfAStream) {
    failEach(stream_, Call::Receive, {ECONNRESET}, true, true, 12);
    failEach(stream_, Call::Send, {EPIPE, ENOBUFS}, true, true, 12);
}
TEST_F(ServerFaults, EveryAllocation) {
    failAllocations(snapshot_, 60);
    failAllocations(stream_, 30);
}
TEST_F(ServerFaults, SomeTogether) {
    failTogether(snapshot_, {Call::Receive, Call::Send, Call::Accept, Call::Allocate}, 30);
}
TEST_F(ServerFaults, TheDeviceIsLostAtEveryPicture) {
    prepare(stream_);
    for (int repeat = 0; repeat < 5; ++repeat)
        for (const int nth : {1, 2}) {  // the still is one of those at least
            nextLoss_ = nth;
            EXPECT_TRUE(tryOne(stream_, {}));
        }
    prepare(snapshot_);
    for (int repeat = 0; repeat < 5; ++repeat) {
        nextLoss_ = 1;
        EXPECT_TRUE(tryOne(snapshot_, {}));
    }
}
TEST_F(ServerFaults, TheClockJumps) {
    for (const int days : {-20 * 365, -1, 1, 20 * 365})
        for (const std::uint64_t nth : {1, 3})
            tryOne(stream_,
                   {{.call = Call::Receive, .nth = nth, .effect = Fault::Effect::Jumps, .error = days}});
}

}  // namespace
}  // namespace scancast
