// The folder of an octree on disk: nothing outside of it is read, whatever leads there; and the program itself, shut in as
// Scancast starts it, gives the points of a folder that was written here.
#include <gmock/gmock.h>

#include <filesystem>

#include "importers/octree/tree/tree_files.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "tests/support/clouds/read_all.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/octree/ept_folder.hpp"
#include "tests/unit/octree/potree_folder.hpp"

namespace scancast::test {

using import_octree::FolderFiles;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

namespace {

void writeAll(const MemoryFiles& files, const std::filesystem::path& folder) {
    for (const auto& [name, bytes] : files.files) {
        std::filesystem::create_directories((folder / name).parent_path());
        std::ofstream(folder / name, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
}

std::string told(const FolderFiles& files, const std::string& name) {
    const auto bytes = files.readAll(name, 100);
    return bytes ? std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size())
                 : bytes.error().message;
}

}  // namespace

TEST(OctreeFolder, NothingOutsideIsRead) {
    const TemporaryFolder place;
    const auto octree = place / "octree";
    std::filesystem::create_directories(octree / "data");
    std::ofstream(octree / "data" / "r.bin") << "inside";
    std::ofstream(place / "secret") << "outside";
    std::filesystem::create_symlink("../secret", octree / "link");
    std::filesystem::create_symlink("..", octree / "up");
    std::filesystem::create_symlink("data/r.bin", octree / "within");
    const FolderFiles files(InputFolder::open(octree).value());
    for (const char* name : {"link", "../secret", "up/secret", "data/../../secret", "/etc/hostname"})
        EXPECT_THAT(told(files, name), HasSubstr("is outside its folder")) << name;
    EXPECT_EQ(told(files, "none"), "its file none is missing");
    EXPECT_EQ(told(files, "data"), "its file data is no file");
    EXPECT_EQ(told(files, "data/r.bin"), "inside");
    EXPECT_EQ(told(files, "within"), "inside");
    std::ofstream(octree / "long") << std::string(101, 'x');
    EXPECT_THAT(told(files, "long"), HasSubstr("has 101 bytes; 100 at most are read"));
    std::vector<std::string> names;
    const auto entries = files.list(".").value();
    for (const auto& entry : entries) names.push_back(entry.name + (entry.isFolder ? "/" : ""));
    EXPECT_THAT(names, UnorderedElementsAre("data/", "link", "up", "within", "long"));
    EXPECT_THAT(files.list("up").error().message, HasSubstr("is outside its folder"));
    // What was opened counts, not what has its name by now.
    std::filesystem::rename(octree, place / "moved");
    std::filesystem::create_directories(octree / "data");
    std::ofstream(octree / "data" / "r.bin") << "another";
    EXPECT_EQ(told(files, "data/r.bin"), "inside");
}

TEST(OctreeFolder, IsReadByTheProgram) {
    const ImportOptions options{.importerDirectory = SCANCAST_BIN_DIR, .keepAttributes = true};
    const auto expectWhole = [&](const MemoryFiles& files, const char* description, std::size_t points) {
        const TemporaryFolder folder;
        writeAll(files, folder.path());
        for (const auto& path : {folder.path(), folder / description}) {
            auto source = openScan(path, options);
            ASSERT_TRUE(source) << source.error().message;
            const auto scan = test::readAll(**source);
            ASSERT_TRUE(scan) << scan.error().message;
            EXPECT_EQ(scan->size(), points);
            EXPECT_FALSE((*source)->header().columns.empty());
        }
    };
    expectWhole(eptFolder("zstandard"), "ept.json", eptPointsInAll);
    expectWhole(potree2Folder("BROTLI"), "metadata.json", potreePointsInAll);
    expectWhole(potree1Folder(), "cloud.js", potreePointsInAll);
}

TEST(OctreeFolder, IsToldOfByTheProgram) {
    const TemporaryFolder folder;
    auto files = eptFolder();
    files.files.erase("ept-data/1-0-0-0.bin");
    writeAll(files, folder.path());
    const auto source = openScan(folder.path(), {.importerDirectory = SCANCAST_BIN_DIR});
    ASSERT_FALSE(source);
    EXPECT_EQ(source.error().message, folder.path().string() + ": its file ept-data/1-0-0-0.bin is missing");
}

}  // namespace scancast::test
