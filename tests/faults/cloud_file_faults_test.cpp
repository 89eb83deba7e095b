// Faults while a cloud file is opened and drawn: a picture is right, says what it lacks, or there is none. And while one is
// made of points: it is complete, or not there, and what was there before stays.
#include <cerrno>
#include <memory>

#include "renderer/cloud/build/cloud_builder.hpp"
#include "renderer/cloud/build/ingest.hpp"
#include "renderer/cloud/build/revision.hpp"
#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/render.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "tests/faults/fault_trials.hpp"
#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/clouds/write_cloud.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

using test::Call;
using test::Fault;
using test::Scene;

OctreeShape smallShape() {
    OctreeShape shape;
    shape.leafPoints = 128;
    shape.chunkPoints = 1024;
    shape.surfels = false;
    return shape;
}

class CloudFileFaults : public test::FaultTrials {
  protected:
    void SetUp() override {
        auto source = std::make_unique<test::SyntheticSource>(2000, test::ground, Attributes{.color = true});
        std::vector<std::unique_ptr<PointSource>> sources;
        sources.push_back(std::move(source));
        const auto made = ingest(std::move(sources), {.output = file_, .threads = 1, .shape = smallShape()});
        ASSERT_TRUE(made) << made.error().message;
        device_ = std::move(*createCpuDevice(1));
    }

    /// The picture's pixels; an error where it says that something is missing.
    Expected<std::string> draw() {
        BlockCacheOptions options;
        options.memoryLimit = std::uint64_t(64) << 20;
        options.threads = 1;
        const auto cache = BlockCache::create(options);
        const auto cloud = openCloud(file_, cache);
        if (!cloud) return passOn(cloud);
        View view = defaultView(**cloud, 24, 16);
        view.quality.samples = 1;
        auto frame = render(*device_, **cloud, view);
        if (!frame) return passOn(frame);
        if (frame->stats.nodesDamaged > 0)
            return fail(ErrorCode::Io, "The picture says that it lacks what cannot be read.");
        return std::string(reinterpret_cast<const char*>(frame->rgba.data()), frame->rgba.size());
    }

    const test::TemporaryFolder folder_;
    const std::filesystem::path file_ = folder_ / "ground.scan";
    std::unique_ptr<Device> device_;
    const Scene scene_{.run = [this] { return draw(); }};
};

TEST_F(CloudFileFaults, EveryRead) {
    failEach(scene_, Call::Read, {EIO}, true, true);
}
TEST_F(CloudFileFaults, EveryOpen) {
    failEach(scene_, Call::Open, {EIO, EMFILE, EACCES}, true);
}
TEST_F(CloudFileFaults, EveryLookAtAFile) {
    failEach(scene_, Call::Status, {EIO});
}
TEST_F(CloudFileFaults, EveryAllocation) {
    failAllocations(scene_);
}
TEST_F(CloudFileFaults, SomeTogether) {
    failTogether(scene_, {Call::Read, Call::Open, Call::Status}, 40);
}

/// Over a file that is there already, or not; from memory, or through a temporary file.
class IngestFaults : public test::FaultTrials {
  protected:
    static constexpr std::string_view before = "what was there before";

    Expected<std::string> make() {
        test::SyntheticSource source(1500, test::ground, Attributes{.color = true});
        auto writer = CloudFileWriter::create(file_);
        if (!writer) return passOn(writer);
        Workspace workspace(memory_, folder_.path());
        auto built = buildFrom(source, smallShape(), {workspace, writer->get(), 1, 1}, {}, {});
        if (!built) return passOn(built);
        built->facts.title = "ground";
        built->facts.revision = revisionOf(built->facts, built->octree);
        if (auto ok = (*writer)->finish(built->facts, built->octree.nodes, built->octree.planes); !ok)
            return passOn(ok);
        return test::contentOf(file_);
    }
    Expected<std::string> ingestIt() {
        std::vector<std::unique_ptr<PointSource>> sources;
        sources.push_back(
            std::make_unique<test::SyntheticSource>(1500, test::ground, Attributes{.color = true}));
        const auto made = ingest(std::move(sources), {.output = file_, .threads = 1, .shape = smallShape()});
        if (!made) return passOn(made);
        return test::contentOf(file_);
    }
    void lookAtFiles(const std::vector<Fault>& faults, const Expected<std::string>& result) const {
        const bool killed = faults[0].effect == Fault::Effect::Kills;
        const std::string now = test::contentOf(file_);
        if (now != before) {
            const auto opened = CloudFile::open(file_);
            EXPECT_TRUE(opened) << "a half file has the name: " << opened.error().message;
        } else {
            EXPECT_FALSE(result);
        }
        if (killed) return;
        EXPECT_EQ(folder_.entries(), 1U) << "a temporary file is left";
    }

    const test::TemporaryFolder folder_;
    const std::filesystem::path file_ = folder_ / "ground.scan";
    std::uint64_t memory_ = Workspace::unlimited;
    const std::function<void(const std::vector<Fault>&, const Expected<std::string>&)> look_ =
        [this](const auto& faults, const auto& result) { lookAtFiles(faults, result); };
    const std::function<void()> old_ = [this] { folder_.write("ground.scan", before); };
    const Scene scene_{.run = [this] { return make(); }, .before = old_, .after = look_};
    // JSON values of the library end the program when they find no memory while they go: the reserve is for these.
    const Scene whole_{
        .run = [this] { return ingestIt(); }, .before = old_, .after = look_, .leastAllocation = 4200};
};

TEST_F(IngestFaults, EveryWrite) {
    failEach(scene_, Call::Write, {EIO, ENOSPC}, true, true);
}
TEST_F(IngestFaults, EveryWriteOfTemporaryFiles) {
    memory_ = 0;
    failEach(scene_, Call::Write, {ENOSPC}, true, true);
    failEach(scene_, Call::Read, {EIO}, true, true);
    failEach(scene_, Call::Open, {EMFILE, ENOSPC}, true);
}
TEST_F(IngestFaults, EverySync) {
    failEach(scene_, Call::Sync, {EIO, ENOSPC}, true);
}
TEST_F(IngestFaults, EveryOpenLockAndName) {
    failEach(scene_, Call::Open, {EIO, EMFILE, ENOSPC}, true);
    failEach(scene_, Call::Lock, {ENOLCK}, true);
    failEach(scene_, Call::Truncate, {EIO}, true);
    failEach(scene_, Call::Rename, {EIO, ENOSPC});
    failEach(scene_, Call::Status, {EIO});
}
TEST_F(IngestFaults, EveryPageThatIsMapped) {
    failEach(scene_, Call::Map, {ENOMEM});
}
TEST_F(IngestFaults, KilledAtEveryWrite) {
    killEach(scene_);
}
TEST_F(IngestFaults, EveryAllocation) {
    failAllocations(whole_);
}
TEST_F(IngestFaults, SomeTogether) {
    failTogether(whole_, {Call::Write, Call::Open, Call::Sync, Call::Allocate}, 40);
}

}  // namespace
}  // namespace scancast
