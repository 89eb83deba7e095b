// Faults while the loader builds a scan and keeps it, or opens what is kept: the cloud is shown, whole, or has failed with a
// sentence; what is kept is whole; the next start has it.
#include <cerrno>
#include <fstream>
#include <thread>

#include "server/catalog/loader.hpp"
#include "tests/faults/fault_trials.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using test::Call;
using test::Fault;
using test::Scene;

class LoaderFaults : public test::FaultTrials {
  protected:
    void SetUp() override {
        fs::create_directories(folder_ / "cache");
        std::ofstream text(folder_ / "ground.xyz");
        for (std::uint64_t i = 0; i < 1000; ++i) {
            const auto p = test::ground(i, 1000).position;
            text << p.x << ' ' << p.y << ' ' << p.z << '\n';
        }
    }

    /// Which cloud the catalog shows in the end.
    Expected<std::string> load() {
        BlockCacheOptions blocks;
        blocks.memoryLimit = std::uint64_t(256) << 20;
        blocks.threads = 1;
        LoaderOptions options;
        options.threads = 1;
        options.importers = 1;
        options.shape.surfels = false;
        options.cache = BlockCache::create(blocks);
        options.version = "1";
        options.watchInterval = 1h;
        options.kept = std::make_shared<KeptClouds>(KeptCloudsOptions{.folder = folder_ / "cache"});
        Catalog catalog;
        {
            Loader loader({folder_ / "ground.xyz"}, catalog, options);
            const auto end = std::chrono::steady_clock::now() + 20s;
            while (!loader.finished() && std::chrono::steady_clock::now() < end)
                std::this_thread::sleep_for(1ms);
        }
        const auto entry = catalog.list().at(0);
        if (entry.state != CloudState::Ready) return fail(ErrorCode::Io, entry.error);
        return std::to_string(entry.cloud->points) + entry.cloud->revision;
    }
    void empty() const {
        for (const auto& entry : fs::directory_iterator(folder_ / "cache")) fs::remove(entry.path());
    }
    void lookAtFiles(const std::vector<Fault>& faults) const {
        const bool killed = !faults.empty() && faults[0].effect == Fault::Effect::Kills;
        for (const auto& entry : fs::directory_iterator(folder_ / "cache")) {
            const std::string name = entry.path().filename().string();
            if (killed && name.ends_with(".partial")) continue;  // the next start sweeps it
            EXPECT_TRUE(isKeptName(name)) << name << " is left";
            const auto opened = CloudFile::open(entry.path());
            EXPECT_TRUE(opened) << "a half file has the name: " << opened.error().message;
        }
    }

    const test::TemporaryFolder folder_;
    const std::function<void(const std::vector<Fault>&, const Expected<std::string>&)> look_ =
        [this](const auto& faults, const auto&) { lookAtFiles(faults); };
    // Of JSON, what has to go finds what the reserve holds (tests/faults/README.md).
    const Scene build_{.run = [this] { return load(); },
                       .before = [this] { empty(); },
                       .after = look_,
                       .leastAllocation = 4200};
    const Scene open_{.run = [this] { return load(); }, .after = look_, .leastAllocation = 4200};
};

TEST_F(LoaderFaults, EveryCallWhileItIsBuilt) {
    const std::uint64_t atMost = test::sized<std::uint64_t>(6, 3);
    failEach(build_, Call::Write, {ENOSPC}, false, true, atMost);
    failEach(build_, Call::Read, {EIO}, true, true, atMost);
    failEach(build_, Call::Open, {EMFILE}, true, false, atMost);
    failEach(build_, Call::Sync, {EIO}, false, false, 4);
    failEach(build_, Call::Rename, {EIO, ENOSPC});
}
TEST_F(LoaderFaults, KilledAtEveryWrite) {
    killEach(build_, 12);
}
TEST_F(LoaderFaults, EveryCallWhileWhatIsKeptIsOpened) {
    failEach(open_, Call::Read, {EIO}, true, true, 16);
    failEach(open_, Call::Open, {EMFILE, EACCES}, true, false, 16);
    failEach(open_, Call::Status, {EIO}, false, false, 16);
}
TEST_F(LoaderFaults, EveryAllocation) {
    failAllocations(open_, 40);
}
TEST_F(LoaderFaults, SomeTogether) {
    failTogether(build_, {Call::Write, Call::Read, Call::Open, Call::Sync}, 8);
}

}  // namespace
}  // namespace scancast
