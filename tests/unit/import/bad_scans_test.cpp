// What is not a cloud, damaged, or empty: an error that names the file and the reason. The files are real
// ones.
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include "renderer/cloud/import/open_scan.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/import/scan_summary.hpp"

namespace scancast::test {

using ::testing::HasSubstr;

namespace {

ImportOptions badScanOptions() {
    return {.importerDirectory = SCANCAST_BIN_DIR};
}

void expectBadScan(const std::filesystem::path& file, ErrorCode code, const char* reason) {
    const auto scan = summarizeOpened(openScan(file, badScanOptions()));
    ASSERT_FALSE(scan) << file;
    EXPECT_EQ(name(scan.error().code), name(code)) << scan.error().message;
    EXPECT_THAT(scan.error().message, HasSubstr(file.string()));
    EXPECT_THAT(scan.error().message, HasSubstr(reason));
}

struct BadScan {
    const char* file;
    ErrorCode code;
    const char* reason;
};

void PrintTo(const BadScan& scan, std::ostream* out) {
    *out << scan.file;
}

const BadScan badScans[] = {
    {"bad/1.2-no-points.las", ErrorCode::Truncated,
     "ends at byte 229: its header promises 1,065 points, there are 0"},
    {"bad/garbage_nVariableLength.las", ErrorCode::Truncated, "promises 719 points, there are 718"},
    {"bad/no-points.las", ErrorCode::Empty, "without points"},
    {"bad/broken_coder.laz", ErrorCode::Unsupported, "LAZ coder 15 is not known"},
    {"bad/broken_size.laz", ErrorCode::Unsupported,
     "POINT10 version 6, GPSTIME11 version 6; versions 1 and 2 can"},
    {"bad/lfs-pointer.laz", ErrorCode::Unsupported, "a Git LFS pointer, not the scan itself"},
    {"bad/badheader.txt", ErrorCode::Malformed, "line 1: two columns are called \"X\""},
    {"bad/missingheader.pcd", ErrorCode::Unsupported, "text without a PCD header"},
    {"bad/no_vertex.ply", ErrorCode::Malformed, "declares no vertices"},
    {"bad/corrupt_crc.e57", ErrorCode::Malformed,
     "the page at byte 33,792 is damaged: its checksum is another"},
    {"bad/InvalidCVHeader.e57", ErrorCode::Malformed, "byte 48: its scan: its points should begin here"},
    {"bad/empty.e57", ErrorCode::Empty, "an E57 file without scans"},
    {"ply/pdal-sized_dims.ply", ErrorCode::Malformed, "no property \"z\""},
    {"ply/pdal-unsized_dims.ply", ErrorCode::Malformed, "no property \"z\""},
};

class BadScans : public ::testing::TestWithParam<BadScan> {};

}  // namespace

TEST_P(BadScans, AreRefusedByReason) {
    const auto& bad = GetParam();
    REQUIRE_TEST_DATA(bad.file);
    expectBadScan(testData(bad.file), bad.code, bad.reason);
}

INSTANTIATE_TEST_SUITE_P(All, BadScans, ::testing::ValuesIn(badScans), fileAsTestName<BadScan>);

// Damage beside the points costs no point: these three have sound records in the places that their headers
// give.
TEST(DamagedBesideThePoints, IsRead) {
    for (const auto& [file, points] : {std::pair("bad/bad_vlr_count.las", 10),
                                       {"bad/malformed_extrabytes.las", 10},
                                       {"bad/gps-time-nan.las", 1}}) {
        REQUIRE_TEST_DATA(file);
        const auto scan = summarizeOpened(openScan(testData(file), badScanOptions()));
        ASSERT_TRUE(scan) << scan.error().message;
        EXPECT_EQ(scan->points, static_cast<std::uint64_t>(points)) << file;
    }
}

TEST(NotAScan, MissingFile) {
    expectBadScan("/nowhere/scan.las", ErrorCode::NotFound, "no such file");
}

TEST(NotAScan, Directory) {
    const TemporaryFolder folder;
    expectBadScan(folder.path(), ErrorCode::Unsupported,
                  "is a directory without ept.json, metadata.json or cloud.js");
}

TEST(NotAScan, EmptyFile) {
    const TemporaryFolder folder;
    for (const char* name : {"a.las", "a.ply", "a"})
        expectBadScan(folder.write(name, ""), ErrorCode::Empty, "is an empty file (0 bytes)");
}

TEST(NotAScan, Devices) {
    expectBadScan("/dev/zero", ErrorCode::Unsupported, "is a device");
    expectBadScan("/dev/null", ErrorCode::Unsupported, "is a device");
}

// Opening a pipe that nobody writes to would wait for ever.
TEST(NotAScan, NamedPipe) {
    const TemporaryFolder folder;
    const auto pipe = folder.path() / "pipe.las";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    expectBadScan(pipe, ErrorCode::Unsupported, "a pipe");
}

TEST(NotAScan, LinkToItself) {
    const TemporaryFolder folder;
    std::filesystem::create_symlink("loop.las", folder / "loop.las");
    expectBadScan(folder / "loop.las", ErrorCode::Io, "cannot be opened");
}

// The description of an octree, and the mirrors beside a scan, are files like others.
TEST(NotAScan, PipesBesideAScan) {
    const TemporaryFolder folder;
    ASSERT_EQ(::mkfifo(folder.file("cloud.js").c_str(), 0600), 0);
    expectBadScan(folder / "cloud.js", ErrorCode::Unsupported, "cloud.js is a pipe, not a file");
    EXPECT_THAT(ScanInput::open(folder).error().message, HasSubstr("cloud.js is a pipe, not a file"));
    const auto scan = folder.write("a.xyz", "1 2 3\n");
    ASSERT_EQ(::mkfifo(folder.file("a.xyz.mirrors.json").c_str(), 0600), 0);
    const auto input = ScanInput::open(scan);
    ASSERT_TRUE(input) << input.error().message;
    EXPECT_THAT(input->mirrors().error().message, HasSubstr("a.xyz.mirrors.json is a pipe, not a file"));
}

// Whoever may write in the folder puts a pipe there after the scan was opened: nobody looks at it.
TEST(ScanInputs, AreReadAsOftenAsOneLikesAndNeverByName) {
    const TemporaryFolder folder;
    const auto scan = folder.write("a.xyz", "1 2 3\n4 5 6\n");
    const auto input = ScanInput::open(scan);
    ASSERT_TRUE(input) << input.error().message;
    std::filesystem::remove(scan);
    ASSERT_EQ(::mkfifo(scan.c_str(), 0600), 0);
    for (int i = 0; i < 2; ++i) {
        const auto read = summarizeOpened(openScan(*input, badScanOptions()));
        ASSERT_TRUE(read) << read.error().message;
        EXPECT_EQ(read->points, 2U);
    }
    EXPECT_TRUE(input->mirrors()->empty());
    EXPECT_EQ(input->bytes(), 12U);
}

TEST(ScanInputs, BeneathAFolderLeadNowhereElse) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder / "root" / "octree");
    folder.write("root/a.xyz", "1 2 3\n");
    folder.write("a.xyz.mirrors.json", R"({"mirrors": []})");
    std::filesystem::create_symlink("../a.xyz.mirrors.json", folder / "root" / "a.xyz.mirrors.json");
    folder.write("root/octree/cloud.js", "{}");
    const auto root = InputFolder::open(folder / "root");
    ASSERT_TRUE(root);
    const auto scan = ScanInput::openBeneath(*root, "a.xyz");
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_EQ(scan->path(), folder / "root" / "a.xyz");
    EXPECT_EQ(scan->mirrors().error().code, ErrorCode::InvalidArgument) << "its mirrors lie outside";
    for (const char* name : {"octree", "octree/cloud.js"}) {
        const auto octree = ScanInput::openBeneath(*root, name);
        ASSERT_TRUE(octree) << octree.error().message;
        ASSERT_TRUE(octree->octree());
        EXPECT_EQ(octree->file().text(10).value(), "{}");
    }
    EXPECT_EQ(ScanInput::openBeneath(*root, "../a.xyz.mirrors.json").error().code,
              ErrorCode::InvalidArgument);
}

TEST(NotAScan, UnreadableFile) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.las", "LASF");
    ::chmod(file.c_str(), 0);
    // The administrator may read everything: be nobody for a moment.
    const auto user = ::geteuid();
    constexpr uid_t nobody = 65534;
    if (user == 0) {
        ASSERT_EQ(::seteuid(nobody), 0);
    }
    expectBadScan(file, ErrorCode::Io, "cannot be opened: Permission denied");
    ASSERT_EQ(::seteuid(user), 0);
}

TEST(NotAScan, OtherThings) {
    const TemporaryFolder folder;
    using namespace std::string_literals;
    for (const auto& [content, reason] :
         {std::pair("\x89PNG\r\n\x1a\n"s, "a picture (JPEG, PNG"),
          {"\x1f\x8b\x08\x00"s, "gunzip"},
          {"PK\x03\x04 "s, "a ZIP archive"},
          {"<!DOCTYPE html>"s, "a web page"},
          {"\x01\x02\x03"s, "starts with the bytes 01 02 03"},
          {"ply"s, "Scancast reads"},
          {"{\n  \"points\": [1, 2, 3]\n}\n"s, "it is JSON text"},
          {"Dear all,\n\nthe 3 scans of 2024 are 12 GB.\n"s, "Scancast reads"},
          {std::string(5000, '\0'), "starts with the bytes 00 00 00 00"}})
        expectBadScan(folder.write("scan.las", content), ErrorCode::Unsupported, reason);
}

// The name says nothing: a LAS file called .ply is a LAS file.
TEST(Formats, GoByContent) {
    REQUIRE_TEST_DATA("las/las11-pdrf1.las");
    REQUIRE_TEST_DATA("ply/pdal-simple_text.ply");
    const TemporaryFolder folder;
    for (const auto& [from, to] : {std::pair("las/las11-pdrf1.las", "a.ply"),
                                   {"ply/pdal-simple_text.ply", "a.las"},
                                   {"pcd/bun0.pcd", "no extension"}}) {
        std::filesystem::copy_file(testData(from), folder.path() / to);
        std::filesystem::permissions(folder.path() / to, std::filesystem::perms::owner_all);
        const auto scan = summarizeOpened(openScan(folder.path() / to, badScanOptions()));
        EXPECT_TRUE(scan) << scan.error().message;
    }
}

}  // namespace scancast::test
