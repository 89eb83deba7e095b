// Faults while scans are read: by the program's own readers, and by an importer - which must not outlive them.
#include <sys/wait.h>

#include <cerrno>
#include <sstream>

#include "renderer/cloud/import/open_scan.hpp"
#include "renderer/cloud/import/stream/importer_source.hpp"
#include "tests/faults/fault_trials.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

using test::Call;
using test::Fault;
using test::Scene;

class ScanFaults : public test::FaultTrials {
  protected:
    void SetUp() override {
        std::ostringstream text, grid;
        for (int i = 0; i < 300; ++i) text << i << ' ' << 2 * i << " 0.5 10 20 30\n";
        folder_.write("points.xyz", text.str());
        grid << "20\n20\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
        for (int i = 0; i < 400; ++i) grid << i % 20 + 1 << ' ' << i / 20 << " 1 0.5\n";
        folder_.write("grid.ptx", grid.str());
        folder_.write("fake.pcd", "good");
        folder_.write("late.pcd", "late");
    }

    static Expected<std::string> all(Expected<std::unique_ptr<PointSource>> source) {
        if (!source) return passOn(source);
        std::string points;
        PointBatch batch;
        for (;;) {
            const auto more = (*source)->read(batch);
            if (!more) return passOn(more);
            if (!*more) return points;
            points.append(reinterpret_cast<const char*>(batch.position.doubles().data()),
                          batch.position.size() * sizeof(batch.position[0]));
        }
    }
    Expected<std::string> readFile(const char* name) { return all(openScan(folder_ / name)); }
    Expected<std::string> readByImporter(const char* name) {
        const auto input = ScanInput::open(folder_ / name);
        if (!input) return passOn(input);
        const ImportOptions options{.importerDirectory = SCANCAST_FAKE_IMPORTERS,
                                    .importerSilenceSeconds = 1};
        auto source = ImporterSource::create({.name = "fake-importer"}, *input, options);
        if (!source) return passOn(source);
        return all(std::unique_ptr<PointSource>(std::move(*source)));
    }

    const test::TemporaryFolder folder_;
    const Scene text_{.run = [this] { return readFile("points.xyz"); }};
    const Scene grid_{.run = [this] { return readFile("grid.ptx"); }};
    static void expectNoImporter(const std::vector<Fault>&, const Expected<std::string>&) {
        EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "an importer is left";
    }
    const Scene importer_{.run = [this] { return readByImporter("fake.pcd"); }, .after = expectNoImporter};
    const Scene lateImporter_{.run = [this] { return readByImporter("late.pcd"); },
                              .after = expectNoImporter};
};

TEST_F(ScanFaults, EveryCallOfATextReader) {
    for (const Scene* scene : {&text_, &grid_}) {
        failEach(*scene, Call::Read, {EIO}, true, true);
        failEach(*scene, Call::Open, {EMFILE, EACCES}, true);
        failEach(*scene, Call::Status, {EIO});
    }
}
TEST_F(ScanFaults, EveryAllocationOfATextReader) {
    for (const Scene* scene : {&text_, &grid_}) failAllocations(*scene);
}
TEST_F(ScanFaults, EveryCallThatStartsAnImporterOrHearsIt) {
    failEach(importer_, Call::Pipe, {EMFILE});
    failEach(importer_, Call::Duplicate, {EMFILE});
    failEach(importer_, Call::Spawn, {EAGAIN, ENOMEM});
    failEach(importer_, Call::Read, {EIO}, true, true, 20);
    failEach(lateImporter_, Call::Poll, {ENOMEM}, true, false, 6);
    failEach(importer_, Call::Open, {EMFILE}, true);
}

}  // namespace
}  // namespace scancast
